"""The closed loop in flight."""

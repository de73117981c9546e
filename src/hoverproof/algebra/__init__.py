"""Exact mathematics that knows nothing of flight."""

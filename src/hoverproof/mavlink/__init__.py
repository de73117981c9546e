"""A mission flown on a vehicle that speaks MAVLink: its own autopilot keeps the body rates."""

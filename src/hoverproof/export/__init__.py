"""Firmware: the proved control law as C99."""

"""Firmware of a mission: certified and written as C99, and flown: that very C, in the loop."""

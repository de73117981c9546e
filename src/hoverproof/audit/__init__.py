"""Flights that happened: logs read, assumptions of a certificate judged, commands replayed."""

"""Reports: one file that tells all that is known of a mission."""

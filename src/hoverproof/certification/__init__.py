"""What is proved of gains, of boxes and of starts, and the certificates of it."""

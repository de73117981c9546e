"""What is proved about gains, and its certificates."""

"""What looks for gains: limits, searches, atlases. The theorems know nothing of it."""

"""The control laws, a file each."""

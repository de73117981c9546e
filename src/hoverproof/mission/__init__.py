"""What a user writes: one TOML file, read exactly, and written back."""

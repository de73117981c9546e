"""The version, in one place: what a module stamps on a file, without importing the package."""

__version__ = "0.2.0"

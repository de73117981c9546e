"""Exponential convergence from a set of starts, proved for every vehicle within tolerance."""

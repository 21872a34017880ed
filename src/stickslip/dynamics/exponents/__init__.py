"""Lyapunov exponents of machines, of maps and of flows."""

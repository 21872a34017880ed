"""Dynamics of non-smooth motion: periodic orbits, their stability, branches of them, exponents, and what attracts which start."""

"""Switching flows: passages, arcs, periodic orbits."""

"""Periodic motions: orbits of driven machines, limit cycles, and steady motions with their derivatives."""

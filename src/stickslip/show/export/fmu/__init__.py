"""Machines as FMI 3 units: C that steps by itself, its description, and a compiled library where there is a compiler."""

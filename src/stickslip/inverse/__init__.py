"""Inverse problems: parameters from measured records, and the best numbers of a machine."""

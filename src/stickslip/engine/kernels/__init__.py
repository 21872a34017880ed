"""Texts of the compiled kernels: read as text and loaded by `stickslip.engine.cache`, never imported."""

"""Derivatives of motions: small changes along a run, sensitivities, derivatives of plain Python."""

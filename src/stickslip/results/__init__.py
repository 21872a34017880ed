"""Runs: trajectories, their dense output, segments and events, steadiness, and their files."""

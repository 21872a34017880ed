"""Branches of periodic motions in one parameter, their special points, and curves of those in two."""

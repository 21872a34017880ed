"""Curves of special points in two parameters: their equations by kind, and how a curve is followed."""

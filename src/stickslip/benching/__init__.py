"""The bench: what a law does, alone."""

from stickslip.benching.records import Bench, Benches, Curve, Experiment, Quantity
from stickslip.benching.running import EXPERIMENTS, bench

__all__ = ["EXPERIMENTS", "Bench", "Benches", "Curve", "Experiment", "Quantity", "bench"]

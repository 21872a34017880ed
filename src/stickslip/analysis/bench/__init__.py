"""The bench: standard experiments on a friction law alone."""

from stickslip.analysis.bench.experiments_run import EXPERIMENTS, bench
from stickslip.analysis.bench.findings import Bench, Benches, Experiment, ExperimentCurve, Quantity

__all__ = ["EXPERIMENTS", "Bench", "Benches", "Experiment", "ExperimentCurve", "Quantity", "bench"]

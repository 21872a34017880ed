"""Figures of runs, records, benches, maps and continuations, drawn from results that were computed before."""

from stickslip.plot.atlas_figure import atlas
from stickslip.plot.attractors_along import attractors
from stickslip.plot.bench_figures import bench
from stickslip.plot.border_curves import special_curve
from stickslip.plot.chaos import chaos_map
from stickslip.plot.contacts import contacts, pattern
from stickslip.plot.continued_motions import continuation
from stickslip.plot.cuts import line_cut
from stickslip.plot.dynamics import basins, bifurcation, convergence, spectrum
from stickslip.plot.edge_figures import edge_state
from stickslip.plot.energy_balance import energy
from stickslip.plot.flow_runs import states
from stickslip.plot.influence import indices, sensitivity
from stickslip.plot.judged import check, design, ranking
from stickslip.plot.maps import motion_map, velocity_map
from stickslip.plot.optima import front, optimum
from stickslip.plot.records import autocorrelation, comparison, fitted, record_spectrum, residuals
from stickslip.plot.runs import forces, phase, velocity
from stickslip.plot.style import publication
from stickslip.plot.tornado_chart import tornado

__all__ = [
    "atlas", "attractors", "autocorrelation", "basins", "bench", "bifurcation", "chaos_map", "check", "comparison", "contacts",
    "continuation", "convergence", "design", "edge_state", "energy", "fitted", "forces", "front", "indices", "line_cut", "motion_map",
    "optimum", "pattern", "phase", "publication", "ranking", "record_spectrum", "residuals", "sensitivity", "special_curve",
    "spectrum", "states", "tornado", "velocity", "velocity_map",
]  # fmt: skip


def __dir__() -> list[str]:
    """List the figures only, not the modules that draw them."""
    return list(__all__)

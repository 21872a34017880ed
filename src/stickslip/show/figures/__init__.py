"""Figures of runs, records, benches, maps and continuations, drawn from results that were computed before."""

from stickslip.show.figures.atlas import atlas
from stickslip.show.figures.attractors import attractors
from stickslip.show.figures.bench import bench
from stickslip.show.figures.chaos_maps import chaos_map
from stickslip.show.figures.checks_and_designs import check, design, ranking
from stickslip.show.figures.contacts import contacts, pattern
from stickslip.show.figures.continuation import continuation
from stickslip.show.figures.dynamics import basins, bifurcation, convergence, spectrum
from stickslip.show.figures.edge_states import edge_state
from stickslip.show.figures.energy import energy
from stickslip.show.figures.flow_runs import states
from stickslip.show.figures.line_cuts import line_cut
from stickslip.show.figures.maps import motion_map, velocity_map
from stickslip.show.figures.optima import front, optimum
from stickslip.show.figures.records import autocorrelation, comparison, fitted, record_spectrum, residuals
from stickslip.show.figures.runs import forces, phase, velocity
from stickslip.show.figures.sensitivity import indices, sensitivity
from stickslip.show.figures.special_curves import special_curve
from stickslip.show.figures.style import publication
from stickslip.show.figures.tornado import tornado

__all__ = [
    "atlas", "attractors", "autocorrelation", "basins", "bench", "bifurcation", "chaos_map", "check", "comparison", "contacts",
    "continuation", "convergence", "design", "edge_state", "energy", "fitted", "forces", "front", "indices", "line_cut", "motion_map",
    "optimum", "pattern", "phase", "publication", "ranking", "record_spectrum", "residuals", "sensitivity", "special_curve",
    "spectrum", "states", "tornado", "velocity", "velocity_map",
]  # fmt: skip


def __dir__() -> list[str]:
    """List the figures only, not the modules that draw them."""
    return list(__all__)

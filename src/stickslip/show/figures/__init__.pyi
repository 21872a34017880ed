"""The figures as type checkers and editors know them; one that is not listed works, and its arguments are not completed."""

from collections.abc import Callable
from typing import Any

from .atlas import atlas as atlas
from .attractors import attractors as attractors
from .batches import batch as batch
from .bench import bench as bench
from .chaos_maps import chaos_map as chaos_map
from .checks_and_designs import check as check, design as design, ranking as ranking
from .contacts import contacts as contacts, pattern as pattern
from .continuation import continuation as continuation
from .dynamics import basins as basins, bifurcation as bifurcation, convergence as convergence, spectrum as spectrum
from .edge_states import edge_state as edge_state
from .energy import energy as energy
from .fits_over_motions import (
    friction_curve as friction_curve,
    over_time as over_time,
    residuals_over_velocity as residuals_over_velocity,
)
from .flow_runs import states as states
from .line_cuts import line_cut as line_cut
from .maps import motion_map as motion_map, velocity_map as velocity_map
from .optima import front as front, optimum as optimum
from .records import (
    autocorrelation as autocorrelation,
    comparison as comparison,
    fitted as fitted,
    record as record,
    record_spectrum as record_spectrum,
    residuals as residuals,
)
from .runs import forces as forces, phase as phase, velocity as velocity
from .sensitivity import indices as indices, sensitivity as sensitivity
from .special_curves import special_curve as special_curve
from .style import publication as publication
from .tornado import tornado as tornado

def __getattr__(name: str) -> Callable[..., Any]: ...

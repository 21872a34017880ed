"""The public names of `stickslip.analysis`: read by type checkers, and by `__init__.py`, which loads each when it is first used."""

from ..models.nondimensional import (
    DimensionlessRobot as DimensionlessRobot,
    dimensionless as dimensionless,
)
from ..models.observables import Observable as Observable
from .bench import (
    Bench as Bench,
    Benches as Benches,
)
from .motion import Motion as Motion
from .moving_tracks import (
    Hops as Hops,
    hops as hops,
    step_per_cycle as step_per_cycle,
    throw_index as throw_index,
)
from .steady import periodic_mean_velocity as periodic_mean_velocity

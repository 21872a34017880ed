"""The public names of `stickslip.dynamics`: read by type checkers, and by `__init__.py`, which loads each when it is first used."""

from ..analysis.coulomb_borders import coulomb_borders as coulomb_borders
from ..models.mirroring import mirrored as mirrored
from .atlas.atlas import (
    AtlasTime as AtlasTime,
    atlas_time as atlas_time,
)
from .atlas.atlas_result import Atlas as Atlas
from .attractors.basins import Basins as Basins
from .attractors.edge_states import (
    EdgeState as EdgeState,
    edge_state as edge_state,
)
from .attractors.period_maps import chaos_map as chaos_map
from .continuation.branches import Branch as Branch
from .continuation.two_parameters import (
    Curve as Curve,
    special_curve as special_curve,
)
from .derivatives.sensitivity import (
    Sensitivity as Sensitivity,
    sensitivity as sensitivity,
)
from .exponents.general_exponents import (
    Lyapunov as Lyapunov,
    lyapunov_of_flow as lyapunov_of_flow,
    lyapunov_of_map as lyapunov_of_map,
)
from .exponents.motion_exponents import largest_exponents as largest_exponents
from .exponents.motion_verdict import Verdict as Verdict
from .exponents.rotation import (
    Rotation as Rotation,
    rotation_number as rotation_number,
)
from .exponents.zero_one import (
    ZeroOne as ZeroOne,
    zero_one_test as zero_one_test,
)
from .flows.flow_orbits import (
    flow_orbit as flow_orbit,
    switching_flow as switching_flow,
)
from .flows.flow_stretches import passage as passage
from .periodic.ball_arithmetic import Enclosure as Enclosure
from .periodic.certify import (
    Certificate as Certificate,
    certify as certify,
)
from .periodic.closed_orbits import PeriodicOrbit as PeriodicOrbit
from .stroboscopic.sections import (
    poincare as poincare,
    spectrum as spectrum,
    strobe as strobe,
)

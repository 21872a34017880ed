"""The public names: read by type checkers, and by `__init__.py`, which loads each when it is first used."""

from . import analysis as analysis, dynamics as dynamics, studies as studies
from .analysis.bench import bench as bench
from .analysis.checking import check as check
from .analysis.energy import energy as energy
from .analysis.motion import motion as motion
from .analysis.steady import mean_velocity as mean_velocity
from .basics import maths as maths
from .basics.errors import (
    InputError as InputError,
    SolveError as SolveError,
    StickslipError as StickslipError,
)
from .dynamics.atlas.atlas import atlas as atlas
from .dynamics.attractors.attractor_continuation import attractors as attractors
from .dynamics.attractors.basins import basins as basins
from .dynamics.attractors.bifurcation_diagrams import bifurcation as bifurcation
from .dynamics.continuation.branches import continuation as continuation
from .dynamics.exponents.motion_exponents import lyapunov as lyapunov
from .dynamics.exponents.motion_verdict import verdict as verdict
from .dynamics.periodic.periodic_orbits import periodic_orbit as periodic_orbit
from .engine.latex import latex as latex
from .inverse import identification as identification, optimisation as optimisation
from .inverse.identification import (
    compare as compare,
    identify as identify,
    virtual_rig as virtual_rig,
)
from .inverse.logs import fit as fit
from .inverse.optimisation import optimise as optimise
from .models import drives as drives, friction as friction, machines as machines, presets as presets, tracks as tracks
from .models.drives import (
    Harmonic as Harmonic,
    HarmonicForce as HarmonicForce,
    MultiHarmonic as MultiHarmonic,
)
from .models.friction import (
    Coulomb as Coulomb,
    CoulombViscous as CoulombViscous,
    Dahl as Dahl,
    LuGre as LuGre,
    Stribeck as Stribeck,
    Viscous as Viscous,
)
from .models.machines import (
    BlockOnBelt as BlockOnBelt,
    Body as Body,
    Chain as Chain,
    Contact as Contact,
    ForcedOscillator as ForcedOscillator,
    Joint as Joint,
    Machine as Machine,
    MovingTrack as MovingTrack,
    PulledMass as PulledMass,
    Spring as Spring,
    Stop as Stop,
)
from .models.observables import observable as observable
from .models.robot import Robot as Robot
from .models.switching_flow import (
    Switch as Switch,
    SwitchingFlow as SwitchingFlow,
)
from .models.tracks import (
    Incline as Incline,
    Level as Level,
)
from .records import (
    Record as Record,
    read as read,
)
from .results.loading import load as load
from .show import figures as _figures
from .show.explorer.widget import widget as widget
from .show.export import export_law as export_law
from .solvers import solve as solve
from .solvers.simulation import simulation as simulation
from .studies import (
    map as map,
    open_study as open_study,
    sweep as sweep,
)

optimize = optimise
plot = _figures

__version__: str

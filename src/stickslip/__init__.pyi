"""The public names: read by type checkers, and by `__init__.py`, which loads each when it is first used."""

from .analysis.bench import (
    Bench as Bench,
    Benches as Benches,
    bench as bench,
)
from .analysis.checking import check as check
from .analysis.coulomb_borders import coulomb_borders as coulomb_borders
from .analysis.energy import energy as energy
from .analysis.motion import (
    Motion as Motion,
    motion as motion,
)
from .analysis.moving_tracks import (
    Hops as Hops,
    hops as hops,
    step_per_cycle as step_per_cycle,
    throw_index as throw_index,
)
from .analysis.steady import (
    mean_velocity as mean_velocity,
    periodic_mean_velocity as periodic_mean_velocity,
)
from .basics import maths as maths, variables as variables
from .basics.errors import (
    InputError as InputError,
    SolveError as SolveError,
    StickslipError as StickslipError,
)
from .basics.quantities import quantity as quantity
from .dynamics.atlas.atlas import (
    AtlasTime as AtlasTime,
    atlas as atlas,
    atlas_time as atlas_time,
)
from .dynamics.atlas.atlas_result import Atlas as Atlas
from .dynamics.attractors.attractor_continuation import attractors as attractors
from .dynamics.attractors.basins import (
    Basins as Basins,
    basins as basins,
)
from .dynamics.attractors.bifurcation_diagrams import bifurcation as bifurcation
from .dynamics.attractors.edge_states import (
    EdgeState as EdgeState,
    edge_state as edge_state,
)
from .dynamics.attractors.period_maps import chaos_map as chaos_map
from .dynamics.continuation.branches import (
    Branch as Branch,
    continuation as continuation,
)
from .dynamics.continuation.two_parameters import (
    Curve as Curve,
    special_curve as special_curve,
)
from .dynamics.derivatives.sensitivity import (
    Sensitivity as Sensitivity,
    sensitivity as sensitivity,
)
from .dynamics.exponents.general_exponents import (
    Lyapunov as Lyapunov,
    lyapunov_of_flow as lyapunov_of_flow,
    lyapunov_of_map as lyapunov_of_map,
)
from .dynamics.exponents.motion_exponents import (
    largest_exponents as largest_exponents,
    lyapunov as lyapunov,
)
from .dynamics.exponents.motion_verdict import (
    Verdict as Verdict,
    verdict as verdict,
)
from .dynamics.exponents.rotation import (
    Rotation as Rotation,
    rotation_number as rotation_number,
)
from .dynamics.exponents.zero_one import (
    ZeroOne as ZeroOne,
    zero_one_test as zero_one_test,
)
from .dynamics.flows.flow_orbits import (
    FlowOrbit as FlowOrbit,
    flow_orbit as flow_orbit,
    switching_flow as switching_flow,
)
from .dynamics.flows.flow_stretches import passage as passage
from .dynamics.periodic.ball_arithmetic import Enclosure as Enclosure
from .dynamics.periodic.certify import (
    Certificate as Certificate,
    certify as certify,
)
from .dynamics.periodic.periodic_orbits import (
    PeriodicOrbit as PeriodicOrbit,
    periodic_orbit as periodic_orbit,
)
from .dynamics.stroboscopic.sections import (
    poincare as poincare,
    spectrum as spectrum,
    strobe as strobe,
)
from .engine.latex import latex as latex
from .inverse.identification import (
    Fit as Fit,
    compare as compare,
    design as design,
    identify as identify,
    prediction_errors as prediction_errors,
    rank as rank,
    virtual_rig as virtual_rig,
)
from .inverse.optimisation import (
    Gradient as Gradient,
    Optimum as Optimum,
    Propagated as Propagated,
    Waveform as Waveform,
    derivative as derivative,
    gradient as gradient,
    optimise as optimise,
    pareto as pareto,
    propagate as propagate,
    waveform as waveform,
)
from .models import (
    drives as drives,
    friction as friction,
    presets as presets,
    tracks as tracks,
)
from .models.drives import (
    DRIVES as DRIVES,
    BangBang as BangBang,
    ForceSum as ForceSum,
    Harmonic as Harmonic,
    HarmonicForce as HarmonicForce,
    MultiHarmonic as MultiHarmonic,
    Pieces as Pieces,
    PiezoBeam as PiezoBeam,
    Pulses as Pulses,
    Recorded as Recorded,
    RecordedForce as RecordedForce,
    Reversed as Reversed,
    Sawtooth as Sawtooth,
    ThreePhase as ThreePhase,
    Trapezoid as Trapezoid,
    TwoPhase as TwoPhase,
    VerticalVibration as VerticalVibration,
    cantilever_eigenvalues as cantilever_eigenvalues,
)
from .models.flow_contacts import FlowContact as FlowContact
from .models.force_rig import ForceRig as ForceRig
from .models.friction import (
    GMS as GMS,
    LAWS as LAWS,
    Bristle as Bristle,
    Coulomb as Coulomb,
    CoulombViscous as CoulombViscous,
    Dahl as Dahl,
    DeadBand as DeadBand,
    ElastoPlastic as ElastoPlastic,
    Karnopp as Karnopp,
    LuGre as LuGre,
    RateState as RateState,
    ResetIntegrator as ResetIntegrator,
    Stribeck as Stribeck,
    Sum as Sum,
    Tabulated as Tabulated,
    TanhCoulomb as TanhCoulomb,
    Viscous as Viscous,
)
from .models.machines import (
    PID as PID,
    BlockOnBelt as BlockOnBelt,
    Bodies as Bodies,
    Body as Body,
    Chain as Chain,
    Contact as Contact,
    Forced as Forced,
    ForcedOscillator as ForcedOscillator,
    Gait as Gait,
    Joint as Joint,
    Link as Link,
    Machine as Machine,
    MovingTrack as MovingTrack,
    PulledMass as PulledMass,
    Rigid as Rigid,
    Spring as Spring,
    Stop as Stop,
)
from .models.mirroring import mirrored as mirrored
from .models.nondimensional import (
    DimensionlessRobot as DimensionlessRobot,
    dimensionless as dimensionless,
)
from .models.observables import (
    Observable as Observable,
    observable as observable,
)
from .models.robot import Robot as Robot
from .models.switching_flow import (
    Switch as Switch,
    SwitchingFlow as SwitchingFlow,
)
from .models.tracks import (
    Incline as Incline,
    Level as Level,
    VaryingFriction as VaryingFriction,
)
from .models.tracks.profiles import (
    FrictionPatches as FrictionPatches,
    FrictionProfile as FrictionProfile,
    FrictionWave as FrictionWave,
)
from .records import (
    Record as Record,
    read as read,
)
from .results.flow_run import FlowRun as FlowRun
from .results.loading import load as load
from .results.trajectory import Trajectory as Trajectory
from .show import paper as paper
from .show.explorer.widget import widget as widget
from .show.export import (
    ExportedLaw as ExportedLaw,
    export_law as export_law,
)
from .solvers import solve as solve
from .solvers.simulation import (
    Simulation as Simulation,
    simulation as simulation,
)
from .studies import (
    Progress as Progress,
    designs as designs,
    export as export,
    map as map,
    merge as merge,
    open_study as open_study,
    sweep as sweep,
)

__version__: str

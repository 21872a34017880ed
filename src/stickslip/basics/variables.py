"""Every column and every result once: name, symbol, unit, dimensions, meaning."""

from __future__ import annotations

from dataclasses import dataclass

from stickslip.basics.contracts import Model
from stickslip.basics.lazy_names import listing

__all__ = ["VARIABLES", "Variable", "about_an_axis", "in_units_of", "unit_of"]
__dir__ = listing(__all__)


@dataclass(frozen=True)
class Variable:
    """Meaning of a column, and the type in which a sweep stores it."""

    name: str
    symbol: str
    unit: str
    dims: tuple[str, ...]
    long_name: str
    kept: str = "f8"  # NumPy's word; a sweep keeps all but those over time


#: Of a machine of one body on one contact a column has neither the dimension "body" nor "contact".
_TIME: tuple[str, ...] = ("time",)
_BODY: tuple[str, ...] = ("time", "body")
_CONTACT: tuple[str, ...] = ("time", "contact")
_CASE: tuple[str, ...] = ()
#: Of a batch of machines that list their parts; of a machine of one body on one contact they have no dimension.
_EACH_BODY: tuple[str, ...] = ("body",)
_EACH_CONTACT: tuple[str, ...] = ("contact",)
_EACH_STOP: tuple[str, ...] = ("stop",)

VARIABLES: dict[str, Variable] = {
    v.name: v
    for v in (
        Variable("t", "t", "s", _TIME, "time"),
        Variable("x", "x", "m", _BODY, "position of the body"),
        Variable("v", "v", "m/s", _BODY, "velocity of the body"),
        Variable("z", "z", "m", (*_CONTACT, "inner_state"), "inner state of the friction law (mean bristle deflection)"),
        Variable("mode", "mode", "1", _CONTACT, "+1 forwards, 0 stuck, -1 backwards (dynamic laws: the sign of v at the contact)"),
        Variable("acceleration", "dv/dt", "m/s^2", _BODY, "acceleration of the body"),
        Variable("xi", "ξ", "m", _TIME, "position of the inner mass relative to the body"),
        Variable("xi_rate", "dξ/dt", "m/s", _TIME, "velocity of the inner mass relative to the body"),
        Variable("xi_acceleration", "d²ξ/dt²", "m/s^2", _TIME, "acceleration of the inner mass relative to the body"),
        Variable("friction_force", "R", "N", _CONTACT, "friction force on the body, positive against forward motion"),
        Variable("slip", "w", "m/s", _CONTACT, "slip velocity of the contact"),
        Variable("load", "N", "N", _CONTACT, "normal force that presses the contact"),
        Variable("drive_force", "−m d²ξ/dt²", "N", _TIME, "inertial drive force on the whole system"),
        Variable("actuator_force", "F", "N", _TIME, "force of the actuator on the body (Eq. 2.1)"),
        Variable("actuator_power", "−F dξ/dt", "W", _TIME, "mechanical power that the actuator delivers"),
        Variable("mean_velocity", "V", "m/s", _CASE, "mean steady velocity over the window after settling"),
        Variable(
            "motion_type",
            "type",
            "",
            _EACH_CONTACT,
            "motion type: rest, presliding, I, II, III, IV or other; "
            "without a drive stick-slip, slip, reversing, oscillation, steady or not settled",
            "U11",
        ),
        Variable(
            "pattern", "pattern", "", _EACH_CONTACT, "signs of the velocity over one motion period, + forward, 0 stuck, - backward", "U32"
        ),
        Variable("direction", "dir", "1", _EACH_CONTACT, "+1 for net motion forwards, -1 backwards, 0 at rest", "i1"),
        Variable("period", "p", "drive periods", _CASE, "period number of the motion; 0 where none was found", "i2"),
        Variable("duration", "T", "s", _CASE, "time until the motion of a machine without a period repeats; NaN where it does not"),
        Variable("body_amplitude", "a", "m", _EACH_BODY, "half of the way of a body in a cycle, less the mean motion"),
        Variable("margin", "margin", "1", _EACH_CONTACT, "distance to the nearest border of the motion type; 0 is on the border"),
        Variable("stick_fraction", "s", "1", _EACH_CONTACT, "fraction of the period at rest"),
        Variable("forward_fraction", "s+", "1", _EACH_CONTACT, "fraction of the period sliding forwards"),
        Variable("backward_fraction", "s-", "1", _EACH_CONTACT, "fraction of the period sliding backwards"),
        Variable(
            "velocity_max", "max v", "m/s", _EACH_BODY, "largest velocity over the last motion period; over the window where not steady"
        ),
        Variable(
            "velocity_min", "min v", "m/s", _EACH_BODY, "smallest velocity over the last motion period; over the window where not steady"
        ),
        Variable("body_velocity", "V_b", "m/s", _EACH_BODY, "mean velocity of a body over the window after settling"),
        Variable("body_displacement", "Δx_b", "m", _EACH_BODY, "displacement of a body over the window after settling"),
        Variable("slip_max", "max w", "m/s", _EACH_CONTACT, "largest slip velocity over the last motion period"),
        Variable("slip_min", "min w", "m/s", _EACH_CONTACT, "smallest slip velocity over the last motion period"),
        Variable("friction_power", "P_R", "W", _EACH_CONTACT, "mean power dissipated by friction over the last motion period"),
        Variable(
            "hits",
            "n_s",
            "1",
            _EACH_STOP,
            "how often a stop is hit, or begins to be pressed, in the last motion period; -1: not solved",
            "i4",
        ),
        Variable(
            "impulse_max", "max J", "N s", _EACH_STOP, "greatest impulse of a hit on a stop with restitution in the last motion period"
        ),
        Variable("stop_force_max", "max C", "N", _EACH_STOP, "greatest force of an elastic stop in the last motion period"),
        Variable("displacement", "Δx", "m", _CASE, "displacement over the window after settling"),
        Variable("drive_power", "P", "W", _CASE, "mean mechanical power that the actuator delivers over the motion period"),
        Variable("cost_of_transport", "P/((M+m)g|V|)", "1", _CASE, "cost of transport: mean power over weight times mean speed"),
        Variable("alpha_plus", "α+", "1", _CASE, "sliding friction forwards over drive force, of the robot with Coulomb friction"),
        Variable("alpha_minus", "α-", "1", _CASE, "sliding friction backwards over drive force, of the robot with Coulomb friction"),
        Variable(
            "steadiness", "steadiness", "", _CASE, "whether the mean velocity is that of a steady motion: a code with its words", "i1"
        ),
        Variable("settling_error", "|V − V∞|", "m/s", _CASE, "estimated distance of V from its steady value; NaN if unknown"),
        Variable("periods_run", "n", "drive periods", _CASE, "drive periods that were run", "i4"),
        Variable("status", "status", "", _CASE, "outcome of the case: a code with its sentence", "i1"),
    )
}

#: Units of ways and forces, and what stands for them about an axis.
_ABOUT_AN_AXIS = {
    "m": "rad", "m/s": "rad/s", "m/s^2": "rad/s^2", "N": "N m", "N s": "N m s", "N/m": "N m/rad", "N s/m": "N m s/rad",
    "N s^2/m^2": "N m s^2/rad^2",
}  # fmt: skip


def unit_of(name: str, model: Model) -> str:
    """Unit of a column of a machine: angles and torques for a rotary machine.

    Examples
    --------
    >>> import stickslip as ss
    >>> unit_of("v", ss.Chain.example()), unit_of("v", ss.Joint.example()), unit_of("friction_force", ss.Joint.example())
    ('m/s', 'rad/s', 'N m')
    """
    return in_units_of(model, VARIABLES[name].unit)


def in_units_of(model: Model, unit: str) -> str:
    """A unit of displacement or force for a machine, translational or rotary."""
    return about_an_axis(unit) if getattr(model, "rotary", False) else unit


def about_an_axis(unit: str) -> str:
    """What stands for a unit of ways or forces where something turns.

    Examples
    --------
    >>> about_an_axis("m/s"), about_an_axis("N"), about_an_axis("s")
    ('rad/s', 'N m', 's')
    """
    return _ABOUT_AN_AXIS.get(unit, unit)

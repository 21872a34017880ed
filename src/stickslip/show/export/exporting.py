"""Export a law: as source code in another language, as a table of a study file, or as attributes of a simulator's joint."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.contracts import Model
from stickslip.basics.errors import InputError, Problems, as_path, did_you_mean
from stickslip.basics.fields import checked_number
from stickslip.basics.quantities import at_least, positive
from stickslip.models.angular_coordinates import unit_of_part
from stickslip.models.friction import Coulomb, CoulombViscous, Stribeck
from stickslip.models.friction.law_adapter import is_law
from stickslip.models.machine_adapter import is_machine, machine_of
from stickslip.models.machines.servo_load import ServoLoad
from stickslip.show.export.names import prefix_of

#: Parts of a servo's load that grow with its torques.
_BY_TORQUE = ("motor", "external", "motor_stribeck", "external_stribeck", "motor_quad", "external_quad")


@dataclass(frozen=True)
class ExportedLaw:
    """A friction law as text; `print` shows it, `save` writes it.

    Parameters
    ----------
    language : str
    name : str
        Name of its functions.
    text : str
    numbers : dict
        For ``"mujoco"``: frictionloss, damping, armature, error (the largest of steady friction over the speeds), worst (the velocity where
        it is) and largest (the law's largest friction there). Empty for the others.
    notes : tuple of str
        Properties of the law that the text does not contain.

    Examples
    --------
    >>> import stickslip as ss
    >>> found = ss.export_law(ss.Coulomb(mu_plus=0.15, mu_minus=0.21), "matlab", name="foot")
    >>> found.file, str(found).splitlines()[0]
    ('foot.m', 'function law = foot()')
    """

    language: str
    name: str
    text: str
    numbers: Mapping[str, float] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        return self.text

    @property
    def file(self) -> str:
        """Suggested file name of the text: MATLAB requires the name of the function."""
        return f"{self.name}.{_ENDINGS[self.language]}"

    @explains_arguments
    def save(self, path: str | Path | None = None) -> Path:
        """Write the text to a file, or into a folder under the name `file`; by default into the current folder.

        Returns
        -------
        Path
            Where it was written. An existing file is replaced.
        """
        from stickslip.basics.whole_files import unwritable, write_whole

        target = Path(self.file) if path is None else as_path(path, "save", self.file)
        target = target / self.file if target.is_dir() else target
        return write_whole(target, self.text, unwritable("export_law"))


@explains_arguments
def export_law(
    law: Any,
    language: str,
    *,
    name: str | None = None,
    load: float | None = None,
    speeds: tuple[float, float] | None = None,
    armature: float = 0.0,
) -> ExportedLaw:
    """A friction law as code that does not need this package: C, MATLAB and Octave, TOML, or attributes of a MuJoCo joint.

    C and MATLAB code follows from the law's own equations, traced as for the solvers, so user-defined laws can be exported too.

    Parameters
    ----------
    law : law, robot, mechanism, Fit or LogFit
        A law; or a model with one contact or a fit, whose law is taken. Of a servo it is that of its load, whose coefficients are torques.
    language : {"c", "matlab", "octave", "toml", "mujoco"}
        C is one C99 file of static functions to include: ``NAME_fitted`` holds the numbers, ``NAME_start`` a fresh state, ``NAME_force``
        the friction force, ``NAME_rate`` the rates of the inner states and ``NAME_step`` advances them over a time step; its header
        explains the use. A set-valued law has ``NAME_sliding``, ``NAME_breakaway``, ``NAME_force``, which takes the force that would hold
        the body at rest, and a ``NAME_step`` for time-stepping simulations, in which bodies come to rest and stay at rest. MATLAB is a
        function NAME that returns a struct with the same. TOML is the table ``[robot.friction]`` of a study file.
    name : str, optional
        Name of the functions (or the joint); by default the law's name in lower case.
    load : float, optional
        For ``"mujoco"``: load on the contact [N]. By default that of a robot whose load is a number, else 1, for which friction
        coefficients are forces.
    speeds : tuple of float, optional
        For ``"mujoco"``, where it is required: the range (slowest, fastest) [m/s or rad/s] over which the joint is fitted to the law.
    armature : float, optional
        For ``"mujoco"``: inertia of the rotor as the joint feels it, gear ratio squared times the motor's [kg m^2].

    Returns
    -------
    ExportedLaw
        The text, and for ``"mujoco"`` the numbers with their error: a MuJoCo joint has dry friction and damping that are the same in both
        directions; the pair with the smallest maximum error over the range of speeds is taken.

    Raises
    ------
    InputError
        If the law cannot be written in this language: a law with random numbers, or in TOML a user-defined one.

    Examples
    --------
    >>> import stickslip as ss
    >>> print(ss.export_law(ss.Dahl(mu_plus=0.15, mu_minus=0.21, sigma0=4e5), "c").text.splitlines()[-2:])
    ['', '#endif']
    >>> joint = ss.export_law(ss.Stribeck.example(), "mujoco", speeds=(2e-3, 0.1))
    >>> print(joint.text.splitlines()[1])
    <joint name="stribeck" frictionloss="0.18629503" damping="0.287383845" armature="0"/>
    """
    problems = Problems("export_law")
    if language not in LANGUAGES:
        problems.add(f"language = {language!r} is not known; {did_you_mean(str(language), LANGUAGES)}")
    elif language == "mujoco":
        _check_range(speeds, load, armature, problems)
    elif any(value not in (None, 0.0) for value in (load, speeds, armature)):
        problems.add(f'load, speeds and armature are those of "mujoco"; leave them out for {language!r}')
    _refuse_amperes(law, problems)
    given = law.model() if callable(getattr(law, "model", None)) and not is_law(law) and not is_machine(law) else law
    if not is_law(given) and not is_machine(given):
        what = "a friction law, a robot or machine with one contact, or a fit"
        problems.add(f"{type(law).__name__} given; allowed is {what}; type for example robot.friction")
    problems.check()
    own = given if is_law(given) else _only_law(given)
    if language == "mujoco" and load is None:
        load = _load_of(given)
    return LANGUAGES[language](own, language, prefix_of(own, name), load, speeds, armature, _units_of(given))


def _refuse_amperes(law: Any, problems: Problems) -> None:
    """A problem for a fit whose torques are over a motor constant that nobody gave."""
    from stickslip.inverse.identification.fit import Fit

    if isinstance(law, Fit) and law.in_amperes:
        typed = 'type ss.fit(..., numbers={"motor_constant": 0.05}) with that of the motor [N m/A]'
        problems.add(f"the torques of this fit are in amperes, because nobody gave a motor constant; {typed}")


def _check_range(speeds: Any, load: Any, armature: Any, problems: Problems) -> None:
    given = "is missing" if speeds is None else f"= {speeds!r}"
    try:
        low, high = map(float, speeds)
        good = 0 < low < high < float("inf")
    except (TypeError, ValueError):
        good = False
    if not good:
        problems.add(
            f"speeds {given}; allowed is a range (slowest, fastest) above zero [m/s or rad/s]; type for example speeds=(1e-3, 0.1)"
        )
    if load is not None:
        checked_number("load", load, problems, positive, "a positive force [N]", "load=1.0")
    checked_number("armature", armature, problems, at_least(0.0), "zero or more [kg m^2]", "armature=0.01")


def _only_law(model: Model) -> Any:
    """The law of a machine that has one contact, possibly with several bodies."""
    laws = machine_of(model).mechanics.laws
    if len(laws) != 1:
        given = f"{type(model).__name__} has {len(laws)} contacts"
        raise InputError("export_law", [f"{given}; allowed is one with one contact; give the law of one of them, a part of its contacts"])
    load = getattr(model, "load", None)
    return _of_servo(laws[0].law, load) if isinstance(load, ServoLoad) else laws[0].law


def _of_servo(law: Any, load: ServoLoad) -> Any:
    """Friction of a servo as a law for a load of 1, where it goes by velocity alone; `InputError` where torques change it."""
    by_torque = [name for name in _BY_TORQUE if getattr(load, name)]
    mu: Any = getattr(law, "mu_plus", 1.0)
    if by_torque or law != Coulomb(mu, mu):
        why = f"friction of this servo grows with its torques ({', '.join(by_torque)})" if by_torque else f"its law is {law!r}"
        typed = "type ss.export_fmu(model) for the whole machine, or model.load.to_bam() for the numbers of BAM"
        raise InputError("export_law", [f"{why}; allowed is Coulomb with one coefficient under a load without such parts; {typed}"])
    base, viscous = mu * load.base, mu * load.viscous
    if not load.stribeck:
        return CoulombViscous(base, base, viscous=viscous)
    most = mu * (load.base + load.stribeck)
    return Stribeck(base, base, most, most, v_s=load.v_s, exponent=load.exponent, viscous=viscous)


def _load_of(model: Any) -> float:
    """The load of a model with one contact; 1 for a law, and for a servo, whose coefficients are then forces or torques."""
    load = getattr(model, "load", None)
    load = 1.0 if is_law(model) or isinstance(load, ServoLoad) else load
    if not isinstance(load, (int, float)):
        raise InputError("export_law", [f"the load of this {type(model).__name__} is not a number of its own; type for example load=1.0"])
    return float(load)


def _source(own: Any, language: str, name: str, *_: Any) -> ExportedLaw:
    from stickslip import __version__
    from stickslip.engine.law_as_written import traced_as_written
    from stickslip.show.export.written import MATLAB, C, source_of

    return ExportedLaw(language, name, source_of(traced_as_written(own), name, C if language == "c" else MATLAB, __version__))


def _toml(own: Any, language: str, name: str, *_: Any) -> ExportedLaw:
    import tomli_w

    from stickslip.models.tables import part_to_table

    return ExportedLaw(language, name, tomli_w.dumps({"robot": {"friction": part_to_table("friction", own)}}))


_OF_A_LAW = ("m/s", "N")


def _units_of(given: Any) -> tuple[str, str]:
    """Units of the slip velocity and of friction; a law does not know what it is in."""
    if is_law(given):
        return _OF_A_LAW
    contact = machine_of(given).mechanics.contacts[0]
    return unit_of_part("slip", given, contact), unit_of_part("friction_force", given, contact)


def _mujoco(own: Any, language: str, name: str, load: Any, speeds: Any, armature: float, units: tuple[str, str]) -> ExportedLaw:
    from stickslip.show.export.mujoco import joint_friction, written_for_mujoco

    low, high = map(float, speeds)
    fitted, lost = joint_friction(own, load, (low, high), units)
    remark = f"{type(own).__name__} under a load of {load:.6g}, over speeds from {low:.4g} to {high:.4g} {units[0]} both ways."
    remark += " For a hinge read rad/s for m/s and N m for N." if units is _OF_A_LAW else ""
    numbers = fitted | {"armature": armature}
    return ExportedLaw(language, name, written_for_mujoco(numbers, lost, name, remark, units[0]), numbers, lost)


LANGUAGES: dict[str, Callable[..., ExportedLaw]] = {"c": _source, "matlab": _source, "octave": _source, "toml": _toml, "mujoco": _mujoco}
_ENDINGS = {"c": "h", "matlab": "m", "octave": "m", "toml": "toml", "mujoco": "xml"}

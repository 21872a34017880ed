"""The paper's actuator: a spring-steel beam, bent by piezo patches at its root, that shakes the inner mass at its tip (section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from stickslip.basics.arguments import Numbers, explains_arguments
from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import Frozen, describe, everywhere, is_array
from stickslip.basics.maths import pi, sqrt
from stickslip.basics.quantities import Rule, at_least, positive, quantity
from stickslip.models.drives import beam_notes
from stickslip.models.drives.beam_input import arithmetic, checked_transient, given, take_damping
from stickslip.models.drives.cantilever import cantilever_eigenvalues
from stickslip.models.drives.harmonic import Harmonic
from stickslip.models.drives.patch_moment import tip_by_modes, tip_participation


class TipMotion(NamedTuple):
    """Steady motion of the tip, amplitude sin(omega t + phase), for a voltage sin(omega t)."""

    amplitude: Any
    phase: Any


@dataclass(frozen=True, eq=False)
class PiezoBeam(Frozen):
    r"""A clamped beam with a pair of piezo patches at its root and the inner mass at its tip (Eqs 3.1 to 3.7, corrected).

    .. math:: EI\,u'''' + \text{damping} + \rho A\,\ddot u = \frac{\partial}{\partial x}\bigl[T(t)\,(\delta(x)-\delta(x-l_0))\bigr]

    .. math:: T(t) = d_{31}(h_1+h_2)\,b\,E_2\,V(t)

    The tip moves as xi(t) = u(L, t). The beam is uniform: the stiffness and the mass of the patches are left out, as in the paper, and so
    is the effect of the body's motion on the beam. The defaults are a rig of ours with the paper's inner mass and a first resonance at 33.4
    Hz, near the paper's 32.7 Hz; the paper does not give the data of its beam.

    Parameters
    ----------
    length : float
        Length L of the beam [m].
    width : float
        Width b of the beam and of the patches [m].
    thickness : float
        Thickness h1 of the beam [m].
    density : float
        Density rho of the beam [kg/m^3].
    modulus : float
        Young's modulus E of the beam [N/m^2].
    patch_length : float
        Length l0 of the patches, from the clamp on [m]. There is one on each face, driven with opposite signs.
    patch_thickness : float
        Thickness h2 of one patch [m].
    patch_modulus : float
        Young's modulus E2 of the patches [N/m^2].
    d31 : float
        Piezoelectric constant [m/V]. Its sign is in the wiring: a negative one turns the phase by pi.
    tip_mass : float
        Mass m at the tip [kg]: the robot's inner mass.
    damping : float or tuple of float
        Damping ratio of all modes, or a tuple with one for each [-]; above 0 and below 1.
    modes : int
        Number of modes in the sum for the tip's motion.

    Examples
    --------
    >>> beam = PiezoBeam()
    >>> beam.frequencies(3).round(1).tolist()
    [33.4, 373.9, 1176.8]
    >>> tip = beam.response(voltage=20.0, frequency=32.7)
    >>> print(f"{tip.amplitude * 1e3:.2f} mm")
    0.67 mm
    """

    length: float = field(
        default=0.1, metadata=quantity("length of the beam", "m", "L", example=0.1, rule=positive, range=(0.07, 0.14), shown="mm")
    )
    width: float = field(default=0.01, metadata=quantity("width of the beam", "m", "b", example=0.01, rule=positive))
    thickness: float = field(
        default=1e-3, metadata=quantity("thickness of the beam", "m", "h_{1}", example=1e-3, rule=positive, range=(5e-4, 2e-3), shown="mm")
    )
    density: float = field(default=7850.0, metadata=quantity("density of the beam", "kg/m^3", r"\rho", example=7850.0, rule=positive))
    modulus: float = field(default=2e11, metadata=quantity("modulus of the beam", "N/m^2", "E", example=2e11, rule=positive))
    patch_length: float = field(default=0.03, metadata=quantity("length of the patches", "m", "l_{0}", example=0.03, rule=positive))
    patch_thickness: float = field(default=2e-4, metadata=quantity("thickness of a patch", "m", "h_{2}", example=2e-4, rule=positive))
    patch_modulus: float = field(
        default=6.1e10, metadata=quantity("modulus of the patches", "N/m^2", "E_{2}", example=6.1e10, rule=positive)
    )
    d31: float = field(
        default=1.71e-10,
        metadata=quantity(
            "piezoelectric constant of the patches",
            "m/V",
            "d_{31}",
            example=1.71e-10,
            rule=Rule(lambda x: x != 0.0, "a constant other than zero"),
        ),
    )
    tip_mass: float = field(default=9.48e-3, metadata=quantity("tip mass", "kg", "m", example=9.48e-3, rule=at_least(0.0)))
    damping: Any = 0.02
    modes: int = 8

    def _check(self, problems: Problems) -> None:
        problems.whole("modes", self.modes, 1, example=5)
        take_damping(self, problems)
        try:
            if everywhere(self.length > 0) and not everywhere(self.patch_length <= self.length):
                long = f"patch_length = {describe(self.patch_length)} is more than length = {describe(self.length)}"
                problems.add(f"{long}; allowed is at most the length of the beam; type for example patch_length=0.03")
        except (TypeError, ValueError):  # a number that was already reported, or shapes that do not fit
            pass

    @property
    def bending_stiffness(self) -> float:
        """EI of the bare beam [N m^2]."""
        return self.modulus * self.width * self.thickness**3 / 12

    @property
    def mass(self) -> float:
        """Mass of the beam, rho A L [kg]."""
        return self.density * self.width * self.thickness * self.length

    @property
    def tip_mass_ratio(self) -> float:
        """R = m/(rho A L) [-]."""
        return self.tip_mass / self.mass

    @property
    def angular_unit(self) -> float:
        """Factor of (beta_i L)^2 in the angular frequency of mode i, sqrt(EI/(rho A L^4)) [rad/s]."""
        return sqrt(self.bending_stiffness / (self.mass * self.length**3))

    @property
    def moment_per_volt(self) -> float:
        """Bending moment T of both patches for one volt, d31 (h1 + h2) b E2 [N m/V] (Eq. 3.2, E2 being Young's modulus)."""
        return self.d31 * (self.thickness + self.patch_thickness) * self.width * self.patch_modulus

    @explains_arguments
    def eigenvalues(self, n: int | None = None) -> Any:
        """The first n eigenvalues beta_i L (Eq. 3.5) [-], shape (..., n); as many as `modes` if n is left out."""
        return cantilever_eigenvalues(self.tip_mass_ratio, self.modes if n is None else n)

    @explains_arguments
    def frequencies(self, n: int | None = None) -> Any:
        """The first n undamped natural frequencies [Hz], shape (..., n)."""
        import numpy as np

        return self.eigenvalues(n) ** 2 * np.asarray(self.angular_unit)[..., None] / (2 * pi)

    @explains_arguments
    def response(self, voltage: Numbers, frequency: Numbers) -> TipMotion:
        """Steady motion of the tip for V(t) = voltage sin(2 pi frequency t) (Eq. 3.7).

        Parameters
        ----------
        voltage : float or array
            Amplitude of the voltage [V].
        frequency : float or array
            Frequency [Hz]. Arrays broadcast with each other and with those of the beam.

        Returns
        -------
        TipMotion
            amplitude [m] and phase [rad]: u(L, t) = amplitude sin(2 pi frequency t + phase). The phase is negative if the tip lags behind
            the voltage.
        """
        import numpy as np

        u = self.length * self.spread(tip_by_modes, *given(voltage, frequency))
        return TipMotion(_plain(abs(u)), _plain(np.arctan2(u.imag, u.real)))

    def spread(self, function: Any, voltage: Numeric, frequency: Numeric) -> Any:
        """A function of the unit beam (`tip_by_modes` and its like) times T L/EI, for every case; labelled arrays broadcast by name.

        A displacement comes out in units of L, a slope in radians.
        """
        import numpy as np

        per_mode = isinstance(self.damping, tuple)

        def cases(omega: Numeric, ratio: Numeric, end: Numeric, damping: Numeric, moment: Any) -> Any:
            zeta = np.asarray(self.damping) if per_mode else np.asarray(damping)[..., None]
            return moment * function(omega, ratio, end, self.modes, zeta)

        with arithmetic(**vars(self), voltage=voltage, frequency=frequency) as labelled:
            moment = self.moment_per_volt * voltage * self.length / self.bending_stiffness
            numbers = (2 * pi * frequency / self.angular_unit, self.tip_mass_ratio, self.patch_length / self.length)
            arguments = (*numbers, 0.0 if per_mode else self.damping, moment)
            if not labelled:
                return cases(*arguments)
            import xarray as xr

            return xr.apply_ufunc(cases, *arguments, join="exact")

    @explains_arguments
    def drive(self, voltage: Numbers, frequency: Numbers) -> Harmonic:
        """The motion of the tip as a robot's drive: amplitude and frequency of `response`, with remarks.

        The phase is left out: it only shifts the origin of time. A robot started at rest has another transient, and where several motions
        coexist it may reach another one.
        """
        tip = self.response(voltage, frequency)
        return Harmonic(amplitude=tip.amplitude, frequency=frequency, notes=tuple(self.notes(voltage, frequency)))

    @explains_arguments
    def notes(self, voltage: Any = None, frequency: Any = None) -> list[str]:
        """Remarks on this beam and, if given, on driving it with this voltage [V] and frequency [Hz]."""
        if voltage is None or frequency is None:
            return beam_notes.of_beam(self)
        return [*beam_notes.of_beam(self), *beam_notes.of_use(self, *given(voltage, frequency))]

    @explains_arguments
    def transient(self, t: Numbers, voltage: Numbers, frequency: Numbers | None = None) -> Any:
        """Motion of the tip from rest at the first time.

        Parameters
        ----------
        t : array (times,)
            Ascending times [s]; with `frequency` from 0 on.
        voltage : float, array (times,) or callable
            With `frequency` the amplitude of a sine that begins at t = 0 (Eq. 3.6, corrected). Without, V at the times or a function V(t):
            the voltage is a straight line between them, and for that the answer is exact [V].
        frequency : float, optional
            Frequency of the sine [Hz].

        Returns
        -------
        array (times,)
            u(L, t) [m].
        """
        import numpy as np

        from stickslip.models.drives.oscillator import modal_response, sine_from_rest

        b = self.eigenvalues()
        if b.ndim > 1 or is_array(self.moment_per_volt * self.length):
            raise InputError(
                "PiezoBeam", ["transient is for one beam and this one holds arrays; type for example beam.replace(length=0.1)"]
            )
        free, damping = b**2 * self.angular_unit, np.broadcast_to(self.damping, b.shape)
        t, volts = checked_transient(t, voltage, frequency)
        q = (
            modal_response(t, volts, free, damping)
            if frequency is None
            else volts * sine_from_rest(t[:, None], 2 * pi * frequency, free, damping)
        )
        push = tip_participation(b, self.tip_mass_ratio, self.patch_length / self.length) * self.angular_unit**2
        return (q * push).sum(axis=1) * self.moment_per_volt * self.length**2 / self.bending_stiffness


def _plain(value: Numeric) -> Any:
    """A float where the answer is one number."""
    return value if is_array(value) else float(value)

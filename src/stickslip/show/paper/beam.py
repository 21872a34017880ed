"""The beam of section 3, with our own data, as the paper prints none: its modes, its tip, and the recoil of the body."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.models.drives import PiezoBeam
from stickslip.models.drives.cantilever import modal_mass, mode_shape
from stickslip.models.drives.patch_moment import modal_amplitudes, tip_by_modes, tip_in_closed_form
from stickslip.show.paper.cases import EXPERIMENTS, OMEGA
from stickslip.show.paper.solved_runs import Runs

__all__ = ["VOLTAGE", "Beam"]

#: Voltage of the figures and numbers [V]; in linear theory, everything is proportional to it.
VOLTAGE = 60.0
#: Gauss points along the beam, enough to integrate the products of the first modes to rounding.
_GAUSS = 64


@dataclass(frozen=True)
class Beam:
    """Computed properties of the beam."""

    beam: PiezoBeam

    @cached_property
    def b(self) -> Any:
        """Eigenvalues."""
        return self.beam.eigenvalues()

    @property
    def unit(self) -> float:
        """Angular frequency of the unit beam [rad/s]."""
        return float(self.beam.angular_unit)

    @property
    def end(self) -> float:
        """Length of the patches over that of the beam."""
        return float(self.beam.patch_length / self.beam.length)

    @property
    def frequency(self) -> float:
        """First natural frequency [Hz]."""
        return float(self.beam.frequencies(1)[0])

    def products(self, modes: int = 5) -> Any:
        """Inner products of the modes over the beam with tip mass, normalised by modal masses: the unit matrix if (3.3) decouples (3.1)."""
        b, s, weight = self.b[:modes], *_gauss()
        shapes = mode_shape(b[:, None], s)
        tip, mass = mode_shape(b, 1.0), modal_mass(b, self.beam.tip_mass_ratio)
        whole = (shapes * weight) @ shapes.T + self.beam.tip_mass_ratio * np.outer(tip, tip)
        return whole / np.sqrt(np.outer(mass, mass))

    def misses(self, modes: int, frequency: Any) -> float:
        """Largest relative error of the undamped tip amplitude with a finite number of modes, against the closed-form solution."""
        omega = 2 * np.pi * np.asarray(frequency) / self.unit
        exact = tip_in_closed_form(np.sqrt(omega), self.beam.tip_mass_ratio, self.end)
        return float(abs(tip_by_modes(omega, self.beam.tip_mass_ratio, self.end, modes) / exact - 1).max())

    def curvature(self, s: Any) -> Any:
        """Y''/Y of the first mode, which would have to be constant in the printed (3.1), with u_xx for u_tt."""
        return mode_shape(self.b[0], s, derivative=2) / mode_shape(self.b[0], s)

    def amplitude(self, omega: Any) -> Any:
        """Amplitude of the tip at `VOLTAGE` [m]."""
        return self.beam.response(VOLTAGE, np.asarray(omega) / (2 * np.pi)).amplitude

    def undamped(self, frequency: Any) -> Any:
        """Tip amplitude for one volt by the closed-form solution, without modes and damping [m]."""
        b, beam = np.sqrt(2 * np.pi * np.asarray(frequency) / self.unit), self.beam
        answer = abs(tip_in_closed_form(b, beam.tip_mass_ratio, self.end))
        return answer * beam.moment_per_volt * beam.length**2 / beam.bending_stiffness

    def settled(self, periods: int = 100, samples: int = 512) -> Any:
        """The tip over the last of some periods from rest [m], from samples of the voltage, without assuming a sinusoidal tip."""
        t = np.linspace(0.0, periods * 2 * np.pi / OMEGA, periods * samples + 1)
        return self.beam.transient(t, VOLTAGE * np.sin(OMEGA * t))[-samples - 1 : -1]

    def slope(self, amplitude: float) -> float:
        """Slope of the beam's tip at the drive's frequency, for a given tip amplitude [rad]."""
        q = modal_amplitudes(OMEGA / self.unit, self.beam.tip_mass_ratio, self.end, self.beam.modes, self.beam.damping)
        tip, slope = ((q * mode_shape(self.b, 1.0, derivative=d)).sum() for d in (0, 1))
        return float(abs(slope / tip) * amplitude / self.beam.length)

    def shortening(self, amplitude: float) -> float:
        """Amplitude of the tip's motion along the beam, at twice the drive's frequency, for a given tip amplitude across it [m]."""
        q = modal_amplitudes(OMEGA / self.unit, self.beam.tip_mass_ratio, self.end, self.beam.modes, self.beam.damping)
        s, weight = _gauss()
        slope = (q[:, None] * mode_shape(self.b[:, None], s, derivative=1)).sum(axis=0) / abs((q * mode_shape(self.b, 1.0)).sum())
        return float(0.25 * (abs(slope) ** 2 * weight).sum() * amplitude**2 / self.beam.length)

    def shaken(self, runs: Runs) -> dict[float, Any]:
        """By tilt: harmonics of the drive from the second on that the body's own motion adds to the tip, relative to the amplitude."""
        return {e.tilt_deg: abs(self._answer(runs.lugre[e.name])[1:]) / e.amplitude for e in EXPERIMENTS}

    def recoil(self, runs: Runs) -> float:
        """The largest first harmonic of this response, relative to the amplitude."""
        return max(float(abs(self._answer(runs.lugre[e.name])[0])) / e.amplitude for e in EXPERIMENTS)

    def _answer(self, run: Any, count: int = 8) -> Any:
        """Complex amplitudes of the tip's harmonics 1 to `count` under the clamp's acceleration [m]; one-way coupling."""
        n = 2048
        t = np.linspace(run.strobe_times[-2], run.strobe_times[-1], n + 1)[:-1]
        k = np.arange(1, count + 1)
        push = 1j * k * OMEGA * np.fft.rfft(run.at(t)["v"])[1 : count + 1] * 2 / n  # harmonics of the clamp's acceleration
        s, weight = _gauss()
        held = (mode_shape(self.b[:, None], s) * weight).sum(axis=1) + self.beam.tip_mass_ratio * mode_shape(self.b, 1.0)
        part = held * mode_shape(self.b, 1.0) / modal_mass(self.b, self.beam.tip_mass_ratio)
        free, omega = self.unit * self.b**2, (k * OMEGA)[:, None]
        return -(part / (free**2 - omega**2 + 2j * self.beam.damping * free * omega)).sum(axis=1) * push


def _gauss() -> tuple[Any, Any]:
    """Points and weights on 0 to 1."""
    at, weight = np.polynomial.legendre.leggauss(_GAUSS)
    return 0.5 * (at + 1), 0.5 * weight

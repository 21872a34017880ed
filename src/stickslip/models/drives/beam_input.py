"""Inputs of a piezo beam: damping, voltages, frequencies and records, checked together."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from stickslip.basics.contracts import Numeric
from stickslip.basics.errors import InputError, Problems
from stickslip.basics.fields import checked_number, describe, everywhere, is_array, number
from stickslip.basics.quantities import between

if TYPE_CHECKING:
    from stickslip.models.drives.piezo_beam import PiezoBeam


def take_damping(beam: PiezoBeam, problems: Problems) -> None:
    """One ratio for all modes (or an array of cases), or a tuple with one for each."""
    value, allowed = beam.damping, "allowed is above 0 and below 1, or a tuple with one for each mode; type for example damping=0.02"
    try:
        if isinstance(value, list):
            raise ValueError(f"{value!r} is a list, which may mean modes or cases; give modes as a tuple and cases as an array")
        taken = tuple(float(number(v)) for v in value) if isinstance(value, tuple) else number(value)
    except (TypeError, ValueError) as error:
        problems.add(f"damping: {error}; {allowed}")
        return
    object.__setattr__(beam, "damping", taken)
    if not all(everywhere(v > 0) and everywhere(v < 1) for v in (taken if isinstance(taken, tuple) else (taken,))):
        problems.add(f"damping = {describe(taken)}; {allowed}")
    if isinstance(taken, tuple) and len(taken) != beam.modes:
        problems.add(f"damping has {len(taken)} ratios for modes = {beam.modes!r}; allowed is one for each mode; type modes={len(taken)}")


def given(voltage: Numeric, frequency: Numeric) -> tuple[Any, Any]:
    """Voltage and frequency as numbers; what is wrong with both at once."""
    problems, hertz = Problems("PiezoBeam"), "a positive frequency [Hz], 1e-9 to 1e12"
    voltage = checked_number("voltage", voltage, problems, between(0.0, 1e9), "zero or more [V], up to 1e9", "voltage=60", "V")
    frequency = checked_number("frequency", frequency, problems, between(1e-9, 1e12), hertz, "frequency=32.7", "Hz")
    problems.check()
    return voltage, frequency


def checked_transient(t: Any, voltage: Any, frequency: Any) -> tuple[Any, Any]:
    """Times and volts of a transient, checked."""
    import numpy as np

    problems, t = Problems("PiezoBeam"), np.atleast_1d(np.asarray(number(t), float))
    if t.ndim != 1 or t.size == 0 or not np.all(np.isfinite(t)) or np.any(np.diff(t) <= 0) or (frequency is not None and t[0] < 0):
        allowed = "allowed are ascending times [s], with a frequency from 0 on"
        problems.add(f"t = {describe(t)}; {allowed}; type for example t=np.linspace(0, 1, 2001)")
    if frequency is not None:
        try:
            voltage, frequency = given(voltage, frequency)
        except InputError as error:
            problems.include(error)
        for name, value in (("voltage", voltage), ("frequency", frequency)):
            if is_array(value):
                problems.add(f"{name} is {describe(value)}; allowed is one number where a sine is asked for")
        problems.check()
        return t, voltage
    volts = np.asarray([voltage(x) for x in t] if callable(voltage) else voltage, float)
    if volts.shape != t.shape or not np.all(np.isfinite(volts)):
        shapes = f"voltage has shape {volts.shape} and t has shape {t.shape}"
        problems.add(f"{shapes}; allowed is a finite voltage for each time, or a function of time; for a sine type frequency=32.7")
    problems.check()
    return t, volts


@contextlib.contextmanager
def arithmetic(**arrays: Any) -> Iterator[bool]:
    """Arithmetic with these numbers: whether they carry names; arrays that do not fit together are an `InputError`."""
    many = {name: a for name, a in arrays.items() if is_array(a)}
    named = [name for name, a in many.items() if hasattr(a, "dims")]
    if named and len(named) < len(many):
        bare = ", ".join(name for name in many if name not in named)
        raise InputError("PiezoBeam", [f"{bare} has no names beside labelled arrays; give it as an xarray.DataArray with dims"])
    try:
        if named:
            import xarray as xr

            with xr.set_options(arithmetic_join="exact"):
                yield True
        else:
            yield False
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        shapes = "; ".join(f"{name} has shape {a.shape}" for name, a in many.items())
        raise InputError("PiezoBeam", [f"the arrays do not fit together: {shapes}; give arrays of one shape, or label them"]) from None

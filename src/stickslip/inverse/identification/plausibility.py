"""Whether a record and the model it is fitted by can be of one machine: frequencies, sizes of the motions, and the model's numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from stickslip.basics.contracts import Array, Model
from stickslip.inverse.identification.least_squares import MeasuredProblem
from stickslip.inverse.identification.targets import Target
from stickslip.models.drives.drive_adapter import MISTAKEN
from stickslip.models.machine_adapter import is_machine, machine_of
from stickslip.models.robot import Robot

_APART = 0.01  # relative distance of two frequencies that no clock has
_OTHER_UNIT = 30.0  # ratio of two motions beyond which a unit is likelier to be wrong than a number of the model


def contradictions(problem: MeasuredProblem, values: dict[str, float], point: Array) -> list[str]:
    """Sentences on what does not go together, at the end of a fit; none of forces over a motion."""
    curves = [(i, t) for i, t in enumerate(problem.targets) if isinstance(t, Target) and t.kind != "mean"]
    models = {i: problem.parameters.model(values, i) for i, _ in curves}
    shown = problem.model.predicted(point[: problem.first]) if curves else None
    parts = [] if shown is None else np.split(shown, np.cumsum([t.count for t in problem.targets])[:-1])
    sentences = [_frequencies(target, models[i]) for i, target in curves] + [_sizes(target, parts[i]) for i, target in curves if parts]
    notes = [note for model in models.values() if is_machine(model) for note in machine_of(model).notes if note.startswith(MISTAKEN)]
    return list(dict.fromkeys([*(sentence for sentence in sentences if sentence), *notes]))


def _frequencies(target: Target, model: Model) -> str:
    """A correction if the model's drive frequency differs from the record's."""
    own = math.nan if model.period is None else 1 / float(model.period)
    one_drive = isinstance(model, Robot) and not isinstance(model.drive, tuple)  # of a common period a record may show a part
    ratio = target.frequency / own
    if not math.isfinite(ratio) or abs(ratio - (1 if one_drive else max(round(ratio), 1))) < _APART * ratio:
        return ""
    mismatch = f"the record repeats at {target.frequency:.5g} Hz and the drive of the model at {own:.5g} Hz"
    advice = "correct the drive's frequency or the unit of the record's times"
    return f"{target.label}: {mismatch}: the fitted friction is that of another drive; {advice}"


def _sizes(target: Target, modelled: Any) -> str:
    """A question where record and model differ as by a unit."""
    measured, own = float(np.std(target.y)), float(np.std(modelled))
    if not own > 0 or 1 / _OTHER_UNIT < measured / own < _OTHER_UNIT:
        return ""
    ratio = f"{measured / own:.3g} times" if measured > own else f"1/{own / measured:.3g} of"
    advice = "check the unit of the record and the amplitude of the drive"
    return f"{target.label}: {MISTAKEN} The measured {target.kind} is {ratio} the one of the model; {advice}"

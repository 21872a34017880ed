"""Kinds of motion that starts settle on, and their descriptions."""

from __future__ import annotations

UNDONE = -1  # period number of what was not computed

PERIODIC, QUASI_PERIODIC, CHAOTIC = "periodic", "quasi-periodic", "chaotic"
STEADY = "steady"  # of a model without a period: its state does not change
UNSETTLED, RUNS_AWAY, UNSOLVED, NOT_COMPUTED = "not settled", "runs away", "not solved", "not computed"
#: Kinds of motion that are attractors.
ATTRACTING = (PERIODIC, QUASI_PERIODIC, CHAOTIC, STEADY)
#: All kinds, in the order of legends and tables.
KINDS = (*ATTRACTING, UNSETTLED, RUNS_AWAY, UNSOLVED, NOT_COMPUTED)
#: What the numbers of a motion beside its period are.
OF_MOTIONS = {
    "motion": {"long_name": "motion: periodic, quasi-periodic, chaotic, steady, not settled, runs away, not solved, not computed"},
    "exponent": {"long_name": "largest Lyapunov exponent per drive period", "units": "1"},
    "error": {"long_name": "standard error of the exponent", "units": "1"},
    "run": {"long_name": "drive periods until it was recognised, or given up", "units": "1"},
}


def of_motions(on_section: bool) -> dict[str, dict[str, str]]:
    """The same in words of a driven model, or of one that is looked at on a section."""
    return {name: worded(about, on_section) for name, about in OF_MOTIONS.items()}


def worded(attributes: dict[str, str], on_section: bool) -> dict[str, str]:
    """Attributes of a column in which drive periods are counted; on a section these are returns.

    Examples
    --------
    >>> worded({"long_name": "exponent per drive period"}, True)
    {'long_name': 'exponent per return'}
    """
    return {key: text.replace("drive period", "return") for key, text in attributes.items()} if on_section else dict(attributes)

"""A number is described once, in its field: messages, axes, sliders and equations read it there, a user's own as ours."""

import subprocess
import sys
from dataclasses import dataclass, field

import pytest

import stickslip as ss
from rows import each_row
from stickslip.basics.quantities import positive
from stickslip.friction import LAWS
from stickslip.show.explorer.machines import sliders_of

GRIP = ss.quantities.quantity("grip of the pad", "1", r"\gamma_{p}", example=0.2, rule=positive, range=(0.05, 0.5))


@dataclass(frozen=True, eq=False)
class Pad(ss.Coulomb):
    """Coulomb friction with a number of its own."""

    grip: float = field(default=0.2, metadata=GRIP)

    def sliding(self, v, load):
        return super().sliding(v, load) * self.grip

    def breakaway(self, load):
        back, ahead = super().breakaway(load)
        return back * self.grip, ahead * self.grip


ROBOT = ss.Robot(0.0626, 0.0095, ss.Harmonic(6e-4, 205.0), Pad(0.5, 0.7))


def test_a_law_of_ones_own_has_words_and_units_on_axes_sliders_and_errors():
    grid = ss.sweep(ROBOT, **{"friction.grip": [0.2, 0.3]})
    assert dict(grid["friction.grip"].attrs) == {"long_name": "grip of the pad γₚ", "units": "1"}
    slider = {p.name: p for p in sliders_of(ROBOT)}["friction.grip"]
    assert (slider.label, slider.symbol, slider.low, slider.high, slider.unit) == ("grip of the pad", "γₚ", 0.05, 0.5, "")
    with pytest.raises(ss.InputError, match=r"Pad: grip = -1\.0; allowed is a positive number; type for example grip=0\.2"):
        Pad(0.5, 0.7, grip=-1.0)
    assert r"\gamma_{p}" in ss.latex(Pad(0.5, 0.7))


def test_a_study_keeps_the_words_of_a_law_of_ones_own(tmp_path):
    ss.sweep(ROBOT, **{"friction.grip": [0.2, 0.3]}, out=tmp_path / "study")
    assert ss.open_study(tmp_path / "study")["friction.grip"].attrs["long_name"] == "grip of the pad γₚ"


NEW_LAW = """
from dataclasses import dataclass, field
import stickslip as ss
from stickslip.friction import LAWS
@dataclass(frozen=True, eq=False)
class Odd(ss.Viscous):
    a: float = field(default=1.0, metadata=ss.quantities.quantity("another a", "N", example=2.0))
    plain: float = field(default=3.0, metadata={"example": 3.0})
LAWS["odd"] = Odd
from stickslip.show.explorer.requests import State
from stickslip.show.explorer.sliders import PARAMETERS
assert PARAMETERS["odd_a"].label == "another a" and PARAMETERS["a"].label == "direct effect of the speed"
assert PARAMETERS["plain"].label == "plain" and PARAMETERS["plain"].low < 3.0 < PARAMETERS["plain"].high
assert State(law="odd").robot().friction.a == 2.0
"""


def test_a_new_law_is_on_the_page_whatever_its_fields_are_called():
    """One process, because the page is made when it is imported."""
    subprocess.run([sys.executable, "-c", NEW_LAW], check=True)


def test_a_law_without_examples_is_told_what_to_type():
    @dataclass(frozen=True, eq=False)
    class Bare(ss.Viscous):
        depth: float = field(kw_only=True)

    with pytest.raises(ss.InputError, match=r"Bare: depth has no example; type depth: float = field\(metadata=ss\.quantities\.quantity\("):
        Bare.example()


@each_row("law", LAWS)
def test_sliders_of_every_law_reach_around_its_example(law):
    robot = ROBOT.replace(friction=LAWS[law].example())
    assert all(p.low <= p.default <= p.high and p.label for p in sliders_of(robot))


def test_a_description_that_makes_no_sense_is_refused_at_once():
    with pytest.raises(ss.InputError, match="4 problems"):
        ss.quantities.quantity("grip", 3, example="big", range=(1.0, 0.0), shown="parsec")


def test_an_alias_of_float_is_a_number():
    from dataclasses import dataclass

    from stickslip.basics.fields import Frozen, leaves

    @dataclass(frozen=True, eq=False)
    class Pad(Frozen):
        mu: ALIAS
        shares: "tuple[ALIAS, ...] | None" = None

    assert leaves(Pad(0.2, (0.5, 0.5))) == [("mu", 0.2), ("shares.0", 0.5), ("shares.1", 0.5)]


ALIAS = float


def test_a_number_may_be_a_type_that_only_a_type_checker_imports_too():
    from dataclasses import dataclass

    from stickslip.basics.field_types import field_types

    @dataclass
    class Pad:
        mu: "float | nobody.imports.This[int] | None"  # noqa: F821

    assert field_types(Pad)["mu"] == ("number", True, True)

"""Each recipe of CONTRIBUTING: a registered thing has all that its recipe names, and what is forgotten is told in a sentence."""

from dataclasses import dataclass, field

import pytest

import stickslip as ss
from house import ROOT
from kinds import LAWS
from registries import examples, lacking
from stickslip.cli import COMMANDS
from stickslip.engine.tableaux import TABLEAUX
from stickslip.solvers.methods import METHODS
from stickslip.tracks import TRACKS
from stickslip.variables import VARIABLES

OF_DRIVES = ("position", "velocity", "acceleration", "period", "velocity_scale")


def needs_of(law):
    return ("sliding", "breakaway") if hasattr(law, "sliding") else ("rate", "force")


@pytest.mark.parametrize("name", ss.LAWS)
def test_a_law_has_what_its_recipe_names(name):
    assert not lacking(name, ss.LAWS[name], needs_of(ss.LAWS[name]), "laws")


@pytest.mark.parametrize("name", ss.DRIVES)
def test_a_drive_has_what_its_recipe_names(name):
    assert not lacking(name, ss.DRIVES[name], OF_DRIVES, "drives")


@pytest.mark.parametrize("name", TRACKS)
def test_a_track_has_what_its_recipe_names(name):
    kind = TRACKS[name]
    numbers = [f for f in kind.__dataclass_fields__.values() if "float" in str(f.type)]
    assert all({"label", "unit", "example"} <= set(f.metadata) for f in numbers), f"describe the numbers of {kind.__name__}"
    assert callable(kind.across) and callable(kind.along)


@pytest.mark.parametrize("name", TABLEAUX)
def test_a_tableau_is_a_method(name):
    assert name in set(METHODS), f"add {name} to src/stickslip/solvers/methods.py"


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_has_its_example(name):
    assert (ROOT / "src" / "stickslip" / "cli" / "examples" / f"{name}.txt").exists(), f"write src/stickslip/cli/examples/{name}.txt"


@pytest.mark.parametrize("name", VARIABLES)
def test_a_column_has_a_unit_and_words(name):
    told = VARIABLES[name]
    assert told.name == name and told.long_name and told.symbol, f"{name}: say its symbol and what it is in variables.py"


@dataclass(frozen=True, eq=False)
class Forgetful(ss.Viscous):
    """A law of which nearly everything was forgotten."""

    depth: float = field(kw_only=True)


def test_what_a_law_forgets_is_told_in_sentences_and_hides_no_other(monkeypatch):
    monkeypatch.setitem(ss.LAWS, "forgetful", Forgetful)
    told = "\n".join(lacking("forgetful", Forgetful, needs_of(Forgetful), "laws"))
    said = "Forgetful.depth has no label, unit, example; type depth: float", "example() gives no Forgetful"
    assert all(words in told for words in (*said, "docs/laws", "docs/api.md", "__init__.pyi")), told
    assert set(examples(ss.LAWS)) == set(ss.LAWS) - {"forgetful"} and set(ss.LAWS) - {"forgetful"} <= set(LAWS)


def test_a_class_that_is_no_dataclass_is_told_what_to_write():
    assert lacking("odd", type("Odd", (), {}), ()) == ["Odd: write @dataclass(frozen=True, eq=False) above the class"]

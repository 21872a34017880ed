"""The house is in order: what README promises is there, floors hold, public names explain themselves."""

import ast
import importlib
import importlib.util
import inspect
import json
import re
import subprocess
import sys
import tomllib

import pytest

from house import PAGES, ROOT, blocks
from rows import each_row

SOURCES = sorted(p for p in (ROOT / "src" / "stickslip").rglob("*.py") if p.parent.name != "kernels")  # kernel texts are not modules
HEAVY = ("llvmlite", "scipy", "matplotlib", "xarray", "pandas", "h5py", "pydantic", "jinja2", "sympy")


def id_of(path):
    return path.relative_to(ROOT).as_posix()


@pytest.fixture(scope="module")
def trees():
    """Each module's syntax tree, parsed once for the tests of this file."""
    return {p: ast.parse(p.read_text(encoding="utf-8")) for p in SOURCES}


def python(code, *arguments):
    """Run code in a fresh interpreter and return what it prints."""
    done = subprocess.run([sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def loaded(modules, code, *arguments):
    """Which of these modules are loaded after running code."""
    last = f"\nimport sys; print('LOADED', *(m for m in {tuple(modules)!r} if m in sys.modules))"
    return python(code + last, *arguments).rsplit("LOADED", 1)[1].split()


# README -----------------------------------------------------------------------------------------------------------


def test_readme_begins_with_two_commands_of_one_line_each():
    commands = [block.text.strip() for block in blocks(ROOT / "README.md", "bash")[:2]]
    assert [command.count("\n") for command in commands] == [0, 0]
    for command, last in zip(commands, ("stickslip paper", "pytest"), strict=True):
        steps = [step.strip() for step in command.split("&&")]
        assert steps[0] == "python3 -m venv .venv"
        assert steps[1].startswith(".venv/bin/pip install ") and "--no-compile" in steps[1]
        assert steps[-1].startswith(f".venv/bin/{last}")


def test_every_command_in_the_docs_exists():
    shown = {m[1] for page in PAGES for block in blocks(page, "bash") for m in re.finditer(r"\bstickslip ([a-z]+)", block.text)}
    told = python("from stickslip.show.cli import main; main()", "--help")
    missing = [command for command in sorted(shown) if not re.search(rf"\b{command}\b", told)]
    assert shown and not missing, f"`stickslip --help` does not know {missing}"


def test_every_link_within_the_repository_leads_somewhere():
    texts = {p: re.sub(r"^( *)(```+).*?^\1\2 *$", "", p.read_text(encoding="utf-8"), flags=re.M | re.S) for p in PAGES}
    links = [
        (p, *target.partition("#")[::2])
        for p, text in texts.items()
        for target in re.findall(r"\]\(([^)\s]+)\)", text)
        if "://" not in target
    ]
    missing = [f"{id_of(p)}: {target}" for p, target, _ in links if target and not (p.parent / target).exists()]
    assert len(links) > 100 and not missing
    headings = {p.resolve(): anchors_of(text) for p, text in texts.items()}
    ends = [(p, (p.parent / target).resolve() if target else p.resolve(), anchor) for p, target, anchor in links if anchor]
    stale = [f"{id_of(p)}: {page.name}#{anchor}" for p, page, anchor in ends if page in headings and anchor not in headings[page]]
    assert len(ends) > 20 and not stale


def anchors_of(text):
    """The anchors that the headings and the labels of a page give, as GitHub and Sphinx spell them."""
    headings = (re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in re.findall(r"^#+ +(.*?) *$", text, re.M))
    return {*headings, *re.findall(r"^\((.+)\)=$", text, re.M)}


def test_the_version_is_the_same_everywhere():
    import stickslip

    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.M)
    archived = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))["version"]
    recipe = re.search(r'^  version: "(\S+)"$', (ROOT / "packaging/conda-forge/recipe.yaml").read_text(encoding="utf-8"), re.M)
    assert {cited[1], stickslip.__version__, archived, recipe[1]} == {project["version"]}


def test_the_conda_recipe_asks_for_what_the_package_asks_for():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    recipe = (ROOT / "packaging/conda-forge/recipe.yaml").read_text(encoding="utf-8").replace("matplotlib-base", "matplotlib")
    listed = re.findall(r"^    - ([\w-]+) (>=[\d.]+)$", recipe.partition("  run:\n")[2], re.M)
    assert {f"{name}{floor}" for name, floor in listed} == set(project["dependencies"])


# floors -----------------------------------------------------------------------------------------------------------


def test_the_import_contracts_hold():
    code = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True, no_logo=True))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


PACKAGES = ["show", "inverse", "dynamics", "studies", "analysis", "solvers", "engine", "records", "results", "models", "basics"]


def test_the_packages_are_the_contract_and_the_first_line_of_the_architecture():
    contract = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"][0]["layers"]
    page = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    here = [p.name for p in (ROOT / "src" / "stickslip").iterdir() if not p.name.startswith("__") and p.name != "py.typed"]
    assert contract == PACKAGES and sorted(here) == sorted(PACKAGES)
    assert page.splitlines()[2].strip() == " > ".join(PACKAGES) and len(page.split()) <= 1200


def test_nothing_is_imported_by_a_string_that_lies_above():
    below = {name: PACKAGES[: PACKAGES.index(name)] for name in PACKAGES}
    texts = {p: p.read_text(encoding="utf-8") for p in SOURCES}
    upward = [
        f"{id_of(p)}: {called}"
        for p, text in texts.items()
        for called in re.findall(r"""(?:import_module|__import__|files)\(f?["'](stickslip[\w.{}]*)""", text)
        if len(parts := p.relative_to(ROOT / "src" / "stickslip").parts) > 1
        and called.split(".")[1:2]
        and called.split(".")[1] in below[parts[0]]
    ]
    assert not upward


#: Each module is the first of ours that its process imports; what others have made, which takes most of the time, they share.
_EACH_FIRST = """
import os, sys, matplotlib.pyplot, scipy.optimize, xarray
for pair in sys.argv[1:]:
    if not os.fork():
        short, long = (f"stickslip.{name}" for name in pair.split())
        exec(f"import {short}, stickslip; import {long}")
        modules, shown = sys.modules, getattr(sys.modules["stickslip"], short.removeprefix("stickslip."))
        print(modules[short] is modules[long] is shown, modules[long].__spec__.name, flush=True)
        os._exit(0)
    os.wait()
"""


def test_public_modules_are_the_same_under_their_short_and_their_long_name():
    import stickslip

    stubs = {p.stem: p.read_text(encoding="utf-8") for p in (ROOT / "src" / "stickslip-stubs").glob("*.pyi")}
    plot = "from stickslip.show.figures import __getattr__ as __getattr__\n"  # a figure that its stub does not list
    known = stickslip.PUBLIC_MODULES.items()
    assert stubs == {short: f"from stickslip.{long} import *\n{plot if short == 'plot' else ''}" for short, long in known}
    each = [f"{short} {long}" for short, long in stickslip.PUBLIC_MODULES.items()]
    assert python(_EACH_FIRST, *each).splitlines() == [f"True stickslip.{long}" for long in stickslip.PUBLIC_MODULES.values()]
    assert python("from stickslip.friction.lugre import LuGre; import stickslip as ss; print(LuGre is ss.LuGre)").strip() == "True"
    with pytest.raises(ModuleNotFoundError, match=r"stickslip\.errors has moved; type stickslip\.basics\.errors"):
        importlib.import_module("stickslip.errors")
    assert all(importlib.util.find_spec(f"stickslip.{there}") for there in stickslip._MOVED.values())


#: Modules that still import one another, all inside functions: what adds up to a sum, a symbol that solves equations, and what chooses
#: among all methods.
CIRCLES = [
    {"models.drives.force", "models.drives.harmonic_force"},
    {f"models.friction.{name}" for name in ("law", "stribeck", "sum", "two_sided", "viscous")},
    {"inverse.identification.fit", "inverse.identification.uncertainty"},
    {"engine.linear_systems", "engine.symbols"},
    {"models.machines.machine", "models.machines.mirrored"},
    {"studies.following", "studies.planning", "studies.solving"},
]


def test_few_files_ask_what_kind_of_model_there_is():
    """Robots, machines of parts and flows answer the same questions (`adapter_of`); their kind is known there, and where they are made."""
    asking = [id_of(p) for p in SOURCES if re.search(r"is_single|\bis_flow\(", p.read_text(encoding="utf-8"))]
    assert len(asking) <= 5, asking


def circles():
    """Sets of modules that import one another, directly or not, inside functions too."""
    import grimp

    graph = grimp.build_graph("stickslip", exclude_type_checking_imports=True, cache_dir=None)
    around = {m: graph.find_upstream_modules(m) & graph.find_downstream_modules(m) for m in graph.modules - {"stickslip"}}
    found = {frozenset({m.removeprefix("stickslip.") for m in (*others, m)} - {"stickslip"}) for m, others in around.items() if others}
    return [set(each) for each in found if len(each) > 1]


def test_no_modules_import_one_another_but_those_that_are_named():
    new = [found for found in circles() if found not in CIRCLES and not all(m.startswith("solvers.") for m in found)]
    assert not new, f"these modules import one another: {new}; move what they share into a file of its own"


def test_nobody_imports_what_another_module_keeps_to_itself(trees):
    imports = [
        (p, n)
        for p, tree in trees.items()
        for n in ast.walk(tree)
        if isinstance(n, ast.ImportFrom) and (n.module or "").startswith("stickslip")
    ]
    private = [
        f"{id_of(p)}: {a.name} of {n.module}" for p, n in imports for a in n.names if a.name.startswith("_") and not a.name.startswith("__")
    ]
    assert len(imports) > 1000 and not private, f"{private}: give it a name without an underscore, and a docstring"


def test_importing_the_package_loads_nothing_heavy():
    assert loaded((*HEAVY, "numpy"), "import stickslip") == []


def test_asking_for_help_loads_neither_numpy_nor_a_compiler():
    code = "import stickslip.show.cli\ntry:\n    stickslip.show.cli.main()\nexcept SystemExit:\n    pass"
    assert loaded(("numpy", *HEAVY), code, "--help") == []


# words ------------------------------------------------------------------------------------------------------------


def public_definitions(tree):
    """The public classes and functions of a module, and the public methods of its public classes."""
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from (m for m in node.body if isinstance(m, ast.FunctionDef) and not m.name.startswith("_"))


def is_overload(node):
    """Whether its implementation, further down, has the docstring."""
    return any(isinstance(d, ast.Name) and d.id == "overload" for d in node.decorator_list)


def test_everything_public_has_a_docstring(trees):
    defined = [(p, node) for p, tree in trees.items() for node in public_definitions(tree) if not is_overload(node)]
    missing = [f"{id_of(p)}:{node.lineno} {node.name}" for p, node in defined if not ast.get_docstring(node)]
    missing += [f"{id_of(p)}: the module" for p, tree in trees.items() if tree.body and not ast.get_docstring(tree)]
    assert len(defined) > 1000 and not missing


def parameters_of(function, of_class):
    a = function.args
    named = [*a.posonlyargs, *a.args, *a.kwonlyargs]
    return named[1:] if of_class and named and named[0].arg in ("self", "cls") else named


def test_most_public_parameters_say_what_they_are(trees):
    """At most 15 % of the named ones are `Any`, which says nothing to a reader."""
    classes = {id(m) for t in trees.values() for n in t.body if isinstance(n, ast.ClassDef) for m in n.body}
    functions = [n for t in trees.values() for n in public_definitions(t) if isinstance(n, ast.FunctionDef)]
    annotations = [ast.unparse(x.annotation) for f in functions for x in parameters_of(f, id(f) in classes)]
    share = annotations.count("Any") / len(annotations)
    assert len(annotations) > 1000 and share <= 0.15, f"{share:.1%} of the public parameters are Any; give the new ones a type"


def public_objects():
    """Every object of the package and of the modules that it shows."""
    import stickslip as ss

    values = {name: getattr(ss, name) for name in ss.__all__}
    modules = {name: value for name, value in values.items() if inspect.ismodule(value)}
    inside = {f"{module}.{name}": getattr(value, name) for module, value in modules.items() for name in value.__all__}
    return {name: value for name, value in values.items() if name not in modules} | inside


def test_at_most_seventy_names_are_in_reach_and_modules_show_nothing_but_theirs():
    import stickslip as ss

    shown = [name for name in dir(ss) if not name.startswith("_")]
    assert shown == sorted(ss.__all__) and len(shown) <= 70
    modules = {name: getattr(ss, name) for name in (*ss.PUBLIC_MODULES, *shown) if inspect.ismodule(getattr(ss, name))}
    leaking = {name: set(dir(module)) - set(module.__all__) for name, module in modules.items()}
    assert len(modules) > 15 and not {name: names for name, names in leaking.items() if names}


@each_row(
    ("name", "hint"),
    [
        ("curve_fit", "type ss.identify"), ("simulate", "type ss.solve"), ("plt", "type ss.plot"), ("minimize", "type ss.optimise"),
        ("tornado", "type ss.plot.tornado"), ("Stepper", "type ss.simulation"), ("check_law", "type ss.testing.check_law(law)"),
        ("export_c", 'type ss.export_law(law, "c")'), ("qwertz", "type dir(ss) for the names that there are"),
        ("Simulation", "type from stickslip.solvers.simulation import Simulation"), ("sovle", "did you mean 'solve'?"),
    ],
)  # fmt: skip
def test_a_name_that_is_elsewhere_says_what_to_type(name, hint):
    import stickslip as ss

    with pytest.raises(AttributeError) as raised:
        getattr(ss, name)
    assert str(raised.value) == f"stickslip has no {name!r}; {hint}"


def test_a_figure_under_another_name_says_what_to_type():
    import stickslip as ss

    with pytest.raises(AttributeError, match=r"ss.plot has no 'phase_portrait'; type ss.plot.phase\(run\)"):
        _ = ss.plot.phase_portrait
    with pytest.raises(ss.InputError, match=r"type run.plot\(\)"):
        ss.plot(3)


def test_classes_that_live_in_their_modules_are_there():
    import stickslip as ss

    assert all(getattr(importlib.import_module(f"stickslip.{place}"), name) for name, place in ss._IN_MODULES.items())
    assert ss.optimize is ss.optimise
    assert all(getattr(ss, name) is getattr(importlib.import_module(f"stickslip.{place}"), name) for name, place in ss._UNLISTED.items())
    assert ss.GMS is ss.friction.GMS and ss.merge is ss.studies.merge and ss.Atlas is ss.dynamics.Atlas  # typed at the top, but not listed


#: Results whose function has the example, and the functions of mathematics, which need none.
SHOWN_ELSEWHERE = (
    "designs.SweepDesign",
    "identification.Comparison",
    "identification.Design",
    "identification.Ranking",
    "optimisation.Search",
)


def test_every_public_name_has_an_example_that_runs():
    objects = {name: thing for name, thing in public_objects().items() if name not in SHOWN_ELSEWHERE and not name.startswith("maths.")}
    owed = {
        name: thing for name, thing in objects.items() if callable(thing) and not (inspect.isclass(thing) and issubclass(thing, Exception))
    }
    missing = [name for name, thing in owed.items() if ">>>" not in (inspect.getdoc(thing) or "")]
    assert not missing, f"their docstrings have no example: {', '.join(missing)}"


def test_figures_that_editors_know_exist():
    import stickslip as ss

    stub = (ROOT / "src" / "stickslip" / "show" / "figures" / "__init__.pyi").read_text(encoding="utf-8")
    listed = {name.asname for node in ast.walk(ast.parse(stub)) if isinstance(node, ast.ImportFrom) and node.level for name in node.names}
    assert listed and listed <= set(ss.plot.__all__), f"take out of {stub}: {listed - set(ss.plot.__all__)}"


def test_no_module_hides_a_public_name():
    import stickslip as ss

    modules = [".".join(path.relative_to(ROOT / "src").with_suffix("").parts).removesuffix(".__init__") for path in SOURCES]
    for module in modules:
        if not module.endswith("__main__"):
            importlib.import_module(module)
    modules_in_all = "import inspect, stickslip as ss; print(*(n for n in ss.__all__ if inspect.ismodule(getattr(ss, n))))"
    hidden = {n for n in ss.__all__ if inspect.ismodule(getattr(ss, n))} - set(python(modules_in_all).split())
    assert not hidden, f"once every module is imported, these are modules and no longer what they were: {sorted(hidden)}"


def test_no_word_is_left_unfinished():
    words = r"\b(TODO|FIXME|XXX|NotImplementedError)\b"
    unfinished = {id_of(p): found for p in SOURCES if (found := re.findall(words, p.read_text(encoding="utf-8")))}
    assert not unfinished


def test_nothing_is_unpickled_but_what_the_caller_sends_to_its_workers():
    """Reading a file runs no code of its author."""
    pickling = [id_of(p) for p in SOURCES if re.search(r"\b(import|from) (cloud)?pickle\b", p.read_text(encoding="utf-8"))]
    assert pickling == ["src/stickslip/basics/executors.py"]


def test_variables_are_called_by_what_they_are(trees):
    functions = [(p, n) for p, tree in trees.items() for n in ast.walk(tree) if isinstance(n, ast.FunctionDef)]
    stored = [(p, v.id) for p, f in functions for v in ast.walk(f) if isinstance(v, ast.Name) and isinstance(v.ctx, ast.Store)]
    arguments = [(p, a.arg) for p, f in functions for a in f.args.args]
    names = {f"{id_of(p)}: {name}" for p, name in [*stored, *arguments] if name in ("found", "told", "seen", "place")}
    assert names == {"src/stickslip/models/tracks/profiles.py: place"}  # a public argument: metres along the track

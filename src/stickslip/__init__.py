"""Vibration-driven robots and stick-slip friction: the public names of `__init__.pyi`, loaded when they are first used."""

import importlib
import importlib.machinery
import sys

from stickslip.basics.lazy_names import from_a_package, lazy_names, typed_name
from stickslip.basics.presenting import on_demand

__version__ = "0.1.0"

_load, __dir__, __all__ = lazy_names(__name__, __file__, lambda name: _elsewhere(name))


def __getattr__(name: str) -> object:
    from stickslip.basics.interruption import held_together  # with what it imports it takes twice as long as all the rest of this module

    if name in PUBLIC_MODULES:
        with held_together():  # an import that Ctrl-C leaves half done poisons the process
            return importlib.import_module(f"{__name__}.{PUBLIC_MODULES[name]}")
    with held_together():
        try:
            return _load(name)
        except (AttributeError, ModuleNotFoundError) as error:
            if name in __all__ and (isinstance(error, AttributeError) or (error.name or "").startswith(__name__)):
                error.add_note(f"{name!r} is looked for where src/stickslip/__init__.pyi has it from")
            raise


def _elsewhere(name: str) -> object:
    """What a name that is not listed stands for in a package, such as ``ss.GMS``; an error says what else to type."""
    if name in _UNLISTED:
        return getattr(importlib.import_module(f"{__name__}.{_UNLISTED[name]}"), name)
    if name.lower() not in _CALLED and (package := from_a_package(name)):
        return package[1]
    raise AttributeError(f"stickslip has no {name!r}; {_instead(name)}")


def _instead(name: str) -> str:
    """What to type instead of a name: where it is, what it is called, or what is written like it."""
    if name.lower() in _CALLED:
        return f"type {_CALLED[name.lower()]}"
    if typed := typed_name(name):
        return f"type {typed}"
    if name in _IN_MODULES:
        return f"type from stickslip.{_IN_MODULES[name]} import {name}"
    from stickslip.basics.errors import did_you_mean

    return did_you_mean(name, __all__, "type dir(ss) for the names that there are")


#: Classes that functions return and nobody makes, and where they are.
_IN_MODULES = {
    "ExportedFMU": "show.export",
    "ExportedLaw": "show.export",
    "LogFit": "inverse.logs",
    "Simulation": "solvers.simulation",
}

#: Functions of packages without a short name that can be typed at the top, where they are not listed.
_UNLISTED = {"export_fmu": "show.export"}

#: What is typed for names, in lower case, that other packages use or a user may think of.
_CALLED = {
    name: typed
    for typed, names in {
        "ss.solve": "simulate integrate run odeint solve_ivp ode45 lsoda",
        "ss.simulation": "stepper step simulator",
        "ss.identify": "curve_fit estimate",
        "ss.read": "read_csv open import_record",
        "ss.load": "load_run read_run open_run",
        'run.save("run.nc")': "save save_run",
        "ss.optimise": "minimize minimise maximize maximise",
        "ss.plot": "plt figure show",
        "run.plot()": "plot_run draw",
        'ss.export_fmu(machine, "machine.fmu")': "fmu to_fmu export_machine simulink",
        'ss.export_law(law, "c")': "export_c to_c export_code",
        'ss.export_law(law, "matlab")': "export_matlab to_matlab",
        "ss.testing.check_law(law)": "check_law",
        "ss.latex(machine)": "equations equations_of_motion tex",
        "ss.periodic_orbit": "limit_cycle shooting stability floquet multipliers",
        "ss.continuation": "period_doubling fold hopf bifurcations",
        "ss.verdict": "chaos is_chaotic",
        "ss.BlockOnBelt": "belt",
        "ss.Trajectory, of flows as of machines": "flowrun",
    }.items()
    for name in names.split()
}

#: Modules that users import by a short name, such as ``stickslip.maths``, and where they are.
PUBLIC_MODULES = {
    "designs": "studies.designs",
    "drives": "models.drives",
    "friction": "models.friction",
    "identification": "inverse.identification",
    "machines": "models.machines",
    "maths": "basics.maths",
    "mechanisms": "models.machines",
    "optimisation": "inverse.optimisation",
    "paper": "show.paper",
    "plot": "show.figures",
    "presets": "models.presets",
    "quantities": "basics.quantities",
    "testing": "analysis.law_claims",
    "tracks": "models.tracks",
    "variables": "basics.variables",
}

#: Modules that have moved, for those who imported them: what to type instead.
_MOVED = {
    "benching": "analysis.bench",
    "checking": "analysis.checking",
    "cli": "show.cli",
    "errors": "basics.errors",
    "explorer": "show.explorer",
    "exporting": "show.export",
    "fields": "basics.fields",
    "flow": "models.switching_flow",
    "identifying": "inverse.identification",
    "io": "results.loading",
    "mechanics": "models.mechanics",
    "optimising": "inverse.optimisation",
    "report": "show.reports",
    "robot": "models.robot",
    "sweeps": "studies",
    "trajectory": "results.trajectory",
    "units": "basics.units",
}


class _PublicModules:
    """Import ``stickslip.plot`` as the module that it stands for, so that there is one module under both names.

    It has no base class: that of finders stands in a module which loads thirty others.
    """

    def find_spec(self, fullname, path=None, target=None):  # type: ignore[no-untyped-def]
        package, _, rest = fullname.partition(".")
        first, dot, more = rest.partition(".")
        if package != __name__ or first not in PUBLIC_MODULES:
            if package == __name__ and first in _MOVED:
                raise ModuleNotFoundError(f"{fullname} has moved; type {__name__}.{_MOVED[first]}{dot}{more}", name=fullname)
            return None
        return importlib.machinery.ModuleSpec(fullname, self, origin=f"{__name__}.{PUBLIC_MODULES[first]}{dot}{more}")  # type: ignore[arg-type]

    def create_module(self, spec):  # type: ignore[no-untyped-def]
        return None

    def exec_module(self, module):  # type: ignore[no-untyped-def]
        sys.modules[module.__spec__.name] = importlib.import_module(module.__spec__.origin)


sys.meta_path.insert(0, _PublicModules())
on_demand(lambda: importlib.import_module(f"{__name__}.show"))  # results are drawn by a package above them
on_demand(lambda: importlib.import_module(f"{__name__}.analysis"))  # and judged by another

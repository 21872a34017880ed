"""Vibration-driven robots and stick-slip friction: the public names of `__init__.pyi`, loaded when they are first used."""

import lazy_loader

__version__ = "0.1.0.dev0"

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name not in __all__:
        from stickslip.errors import did_you_mean

        hint = f"did you mean {_ELSEWHERE[name]!r}?" if name in _ELSEWHERE else did_you_mean(name, __all__)
        raise AttributeError(f"stickslip has no {name!r}; {hint}")
    from stickslip.interruption import held_together

    with held_together():  # an import that Ctrl-C ends half done, such as that of Numba, fails until the process is started anew
        return _load(name)


#: Names that other packages use for some of our functions.
_ELSEWHERE = {
    **dict.fromkeys(("simulate", "simulation", "integrate", "run", "odeint", "solve_ivp"), "solve"),
    **dict.fromkeys(("fit", "curve_fit", "estimate"), "identify"),
    **dict.fromkeys(("read_csv", "open", "import_record"), "read"),
    **dict.fromkeys(("minimize", "minimise", "maximize", "maximise"), "optimise"),
}

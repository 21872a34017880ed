"""Vibration-driven robots and stick-slip friction: the public names of `__init__.pyi`, loaded when they are first used."""

import lazy_loader

__version__ = "0.1.0.dev0"

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name not in __all__:
        from stickslip.errors import did_you_mean

        raise AttributeError(f"stickslip has no {name!r}; {did_you_mean(name, __all__)}")
    return _load(name)

"""Machines in study files and notebooks: their TOML table, shape and page."""

from __future__ import annotations

from typing import Any, ClassVar

from stickslip.basics.batch import shape_of
from stickslip.basics.fields import Frozen
from stickslip.models.mechanics import lists_parts
from stickslip.models.tables import from_toml, record_html, to_toml


class Filed(Frozen):
    """Base of the machines of one body and of several."""

    #: Its name in a study file; "" of a class of one's own, which a study file cannot name.
    kind: ClassVar[str] = ""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch; () for a single machine."""
        return shape_of(self)

    def to_toml(self) -> str:
        """The machine as TOML text, every digit kept; `from_toml` of its class reads it back.

        A study file holds what `stickslip` knows by name, such as a `Chain`; of a class of your own it names the function that makes it.
        """
        return to_toml(self, self._table())

    @classmethod
    def from_toml(cls, text: str) -> Any:
        """A machine of this kind from the TOML text of `to_toml`."""
        return from_toml(cls, text, cls._table())

    @classmethod
    def _table(cls) -> str:
        """The name of its table in TOML."""
        return "mechanism" if cls.kind or not lists_parts(cls) else "machine"

    def _repr_html_(self) -> str:
        return record_html(self)

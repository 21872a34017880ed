"""Export a machine as an FMI 3 unit, for Simulink, OpenModelica, fmpy and others."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from stickslip.basics.arguments import explains_arguments
from stickslip.basics.errors import InputError, as_path


@dataclass(frozen=True)
class ExportedFMU:
    """An FMI 3 unit that was written.

    Parameters
    ----------
    path : Path
    name : str
    inputs, outputs, parameters : tuple of str
        Names of its variables.
    method : str
        How it steps in Co-Simulation: "exact", or the name of the steps of a dynamic law.
    platform : str or None
        The platform of its compiled library, as FMI 3 names it; None where it has its sources alone.
    """

    path: Path
    name: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    parameters: tuple[str, ...]
    method: str
    platform: str | None


@explains_arguments
def export_fmu(
    machine: Any,
    path: str | Path | None = None,
    *,
    inputs: Sequence[str] | None = None,
    outputs: Sequence[str] | None = None,
    start: dict[str, Any] | None = None,
    rtol: float = 1e-6,
    method: str = "auto",
    name: str | None = None,
    binary: bool | None = None,
) -> ExportedFMU:
    """Write a machine as a unit of FMI 3 (.fmu), with Co-Simulation and Model Exchange; it needs no Python.

    Within a step of Co-Simulation the motion is that of `solve`: events at their exact instants, however long the step is. The C is made
    from the text of the kernel that `solve` compiles, and gives the same numbers.

    Parameters
    ----------
    machine : Robot or a mechanism, or a machine of several bodies
        One case. Equations are written out, so that the text grows with the number of contacts.
    path : str or Path, optional
        The file, or a folder; by default the name of the machine's class in the current folder.
    inputs : sequence of str, optional
        What the importer sets while it runs: forces on bodies ("force", "torque on joint"; see `stickslip.simulation`) or numbers of the
        machine by their dotted names, such as "control.target". They are constant over a step of Co-Simulation. By default all forces.
        The other numbers are parameters.
    outputs : sequence of str, optional
        "x", "v", "a", "friction_force" and inner states of one body; of a machine that lists its bodies "x.NAME" and so on. All by
        default; modes of contacts and the number of events are always there.
    start : dict, optional
        As for `solve`.
    rtol : float
        Relative tolerance for dynamic laws; steps of set-valued laws are exact to rounding.
    method : str
        As for `simulation`.
    name : str, optional
        Name of the model.
    binary : bool, optional
        Whether it has a compiled library for this platform; by default if gcc or clang is there. The sources are always in it.

    Returns
    -------
    ExportedFMU

    Raises
    ------
    InputError
        For a machine that no compiled method steps, a batch, or an input or output that is not known.

    Examples
    --------
    >>> import tempfile
    >>> import stickslip as ss
    >>> belt = ss.BlockOnBelt(mass=2.0, stiffness=2.0, speed=0.1, friction=ss.Coulomb(0.3, 0.3, f_plus=0.4, f_minus=0.4))
    >>> made = ss.export_fmu(belt, f"{tempfile.mkdtemp()}/belt.fmu", inputs=["speed"], binary=False)
    >>> made.inputs, made.outputs, made.method
    (('speed',), ('x', 'v', 'a', 'friction_force', 'mode', 'events'), 'exact')
    """
    from stickslip import __version__
    from stickslip.basics.whole_files import unwritable, write_whole
    from stickslip.show.export.fmu.building import archive, compiler, library, sources, this_platform
    from stickslip.show.export.fmu.description import build_description, described
    from stickslip.show.export.fmu.header import header
    from stickslip.solvers.machine_in_c import machine_in_c

    own, made = _name(machine, name), machine_in_c(machine, inputs, outputs, start, rtol, method, "export_fmu")
    target = Path(f"{own}.fmu") if path is None else as_path(path, "export_fmu", f"{own}.fmu")
    target = target / f"{own}.fmu" if target.is_dir() else target
    compiles = compiler() if binary is not False else None
    if binary and compiles is None:
        raise InputError("export_fmu", ["binary = True and there is no C compiler; install gcc or clang, or type binary=False"])
    first = described(machine, made, own, own, "", __version__)
    token = hashlib.sha256("\n".join([first.xml, header(made, "", __version__)]).encode()).hexdigest()[:32]
    xml, files = described(machine, made, own, own, token, __version__), sources(header(made, token, __version__))
    content: dict[str, str | bytes] = {"modelDescription.xml": xml.xml, "sources/buildDescription.xml": build_description(own)}
    content |= {f"sources/{each}": text for each, text in files.items()}
    platform, ending = this_platform()
    if compiles is not None:
        content[f"binaries/{platform}/{own}{ending}"] = library(files, compiles, "export_fmu")
    written = write_whole(target, archive(content), unwritable("export_fmu"))
    return ExportedFMU(written, own, xml.inputs, xml.outputs, xml.parameters, made.method, platform if compiles is not None else None)


def _name(machine: Any, name: Any) -> str:
    """The name of the model, which is that of its library too."""
    if name is None:
        return type(machine).__name__ if _is_plain(type(machine).__name__) else "machine"
    if not isinstance(name, str) or not _is_plain(name):
        raise InputError("export_fmu", [f"name = {name!r}; allowed is a name of letters, digits and _; type for example name='my_robot'"])
    return name


def _is_plain(name: str) -> bool:
    return name.isascii() and name.isidentifier() and len(name) <= 60

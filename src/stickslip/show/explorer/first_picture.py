"""The picture that the page shows first, solved beforehand: it needs no solver, and waits for no kernel.

``python -m stickslip.show.explorer.first_picture`` solves it anew and writes the file. A test compares the file with the solver.
"""

from __future__ import annotations

import functools
from dataclasses import replace
from importlib.resources import as_file, files
from typing import Any

from stickslip.show.explorer.code import python
from stickslip.show.explorer.frames import encoded, unpacked
from stickslip.show.explorer.kernels import Kernels, compiling
from stickslip.show.explorer.requests import DEFAULT, Message

_FILE = files("stickslip.show.explorer") / "assets" / "first_picture.bin"
#: The curves that a page asks for when it opens.
FIRST = Message("curves", 0, DEFAULT)


def _shown() -> dict[str, Any]:
    """What is on the page at first."""
    return {"choices": [DEFAULT.drive, DEFAULT.track, DEFAULT.contact, *DEFAULT.laws], "values": dict(DEFAULT.values)}


@functools.cache
def first_picture() -> bytes | None:
    """The response with these curves, after a run of full length; None if the file was written for other numbers."""
    data = _FILE.read_bytes()
    return data if unpacked(data)[0]["of"] == _shown() else None


def first_answer(asked: Message, kernels: Kernels) -> bytes | None:
    """The response to a request for these curves while kernels of theirs are being prepared; None to any other request."""
    if replace(asked, id=0, fine=False) != FIRST or (data := first_picture()) is None:
        return None
    waits = [law for law in asked.state.laws if not kernels.ready(asked.state, law, asked.state.robot(law), False)]
    if not waits:
        return None
    header, arrays = unpacked(data)
    laws = [
        law | ({"waits": compiling(asked.state, law["name"]), "solved": True} if law["name"] in waits else {}) for law in header["laws"]
    ]
    header |= {"id": asked.id, "fine": asked.fine, "laws": laws} | ({"python": python(asked.state)} if asked.fine else {})
    return encoded(header, arrays)


def solved() -> bytes:
    """The response by the solver."""
    from stickslip.show.explorer.responses import curves

    header, arrays = curves(replace(FIRST, fine=True), _AllReady(), lambda: False)
    del header["python"]
    return encoded({"channel": FIRST.channel, "id": FIRST.id, **header, "fine": False, "of": _shown()}, arrays)


class _AllReady(Kernels):
    """Kernels that are compiled when they are needed."""

    def __init__(self) -> None:
        pass

    def ready(self, *_: Any) -> bool:
        """Always."""
        return True


if __name__ == "__main__":
    from stickslip.basics.whole_files import unwritable, write_whole

    with as_file(_FILE) as path:
        write_whole(path, solved(), unwritable("first_picture"))

"""HDF5 files from anywhere: everything that is read lies within the file, and is no more than the file may unpack to.

HDF5 lets a dataset lie in any other file (external storage, virtual datasets, external links) and lets a few bytes stand for any number
of them (fill values, packed chunks). So a file is looked through once before anything in it is read.
"""

from __future__ import annotations

import contextlib
import math
import zlib
from collections.abc import Iterator
from typing import Any

from stickslip.errors import InputError
from stickslip.unpacking import Allowance, shown

__all__ = ["attributes", "checked", "members", "opened", "place_of"]

#: A stream of deflate never has less than a byte for so many (a match of 258 bytes takes two bits).
_DEFLATE_RATIO = 1032
_UNPACK, _REPACK = "export the record with its numbers in the file itself", "type h5repack -f GZIP=4 old.h5 new.h5"


@contextlib.contextmanager
def opened(source: Any, doing: str, allowance: Allowance) -> Iterator[Any]:
    """An HDF5 file, open for reading, of which everything was looked through.

    Parameters
    ----------
    source : path or file object
    doing : str
        What is being done, for the errors.
    allowance : Allowance
        What the file may unpack to.
    """
    import h5py

    with h5py.File(source, "r") as file:
        checked(file, doing, allowance)
        yield file


def checked(file: Any, doing: str, allowance: Allowance) -> None:
    """Refuse a file with data elsewhere, or with more than it may unpack to."""
    import h5py

    seen, waiting, size = set(), [("", file)], 0
    while waiting:
        prefix, group = waiting.pop()
        for name, item in members(group, doing):
            if isinstance(item, h5py.Dataset):
                size += _checked_size(item.id, f"{prefix}{name}", doing, allowance)
            elif isinstance(item, h5py.Group) and (place := place_of(item)) not in seen:
                seen.add(place)
                waiting.append((f"{prefix}{name}/", item))
    allowance.take(size, "what it declares")


def place_of(item: Any) -> int:
    """Where in its file an object lies: it is the same one under all its names."""
    import h5py

    return int(h5py.h5o.get_info(item.id).addr)


def members(group: Any, doing: str) -> Iterator[tuple[str, Any]]:
    """Names and objects of a group; None for a soft link, a second name that is not followed. A link to another file is refused."""
    import h5py

    for name in group:
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise InputError(doing, [f"{name!r} of the file is a link to another file, which is not followed; {_UNPACK}"])
        yield name, group.get(name) if isinstance(link, h5py.HardLink) else None


def attributes(item: Any, allowance: Allowance, size: int) -> dict[str, Any]:
    """The attributes of an object, without those that could be more than a file of this size may unpack to."""
    import h5py

    found = {}
    for name in item.attrs:
        one = item.attrs.get_id(name)
        kind, count = one.get_type(), math.prod(one.shape or ())
        plain = kind.get_class() in (h5py.h5t.INTEGER, h5py.h5t.FLOAT, h5py.h5t.ENUM)
        plain = plain or (kind.get_class() == h5py.h5t.STRING and not kind.is_variable_str())
        if count * (kind.get_size() if plain else size) <= allowance.limit:  # of varying length: each may be as long as the file
            found[name] = item.attrs[name]
    return found


def _checked_size(dataset: Any, name: str, doing: str, allowance: Allowance) -> int:
    """The bytes that a dataset declares, as numbers of eight; refuse one whose numbers lie elsewhere, or that hides more."""
    import h5py

    made = dataset.get_create_plist()
    layout = made.get_layout()
    if layout == h5py.h5d.VIRTUAL:
        raise InputError(doing, [f"{name!r} is a virtual dataset: its numbers lie in other datasets, which are not followed; {_UNPACK}"])
    if layout == h5py.h5d.CONTIGUOUS and made.get_external_count():
        raise InputError(doing, [f"the numbers of {name!r} lie in another file, which is not followed; {_UNPACK}"])
    if layout == h5py.h5d.CHUNKED:
        _check_chunks(dataset, made, name, doing, allowance)
    return max(dataset.get_type().get_size(), 8) * math.prod(dataset.shape or ())


def _check_chunks(dataset: Any, made: Any, name: str, doing: str, allowance: Allowance) -> None:
    """Refuse chunks that are larger than the file may unpack to, as they are declared or as they are packed."""
    chunk = dataset.get_type().get_size() * math.prod(made.get_chunk())
    allowance.check(chunk, f"a chunk of {name!r}")
    if _is_deflated(made, chunk, name, doing):
        for place in _suspects(dataset, allowance.limit / _DEFLATE_RATIO):
            _, packed = dataset.read_direct_chunk(place)
            _check_deflated(packed, chunk, name, doing)


def _is_deflated(made: Any, chunk: int, name: str, doing: str) -> bool:
    """Whether chunks are packed by deflate; refuse other ways, whose own parameters may claim any size, and two at once."""
    import h5py

    filters = [made.get_filter(i) for i in range(made.get_nfilters())]
    harmless = (h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32)
    packing = [(code, values, label) for code, _, values, label in filters if code not in harmless]
    for code, values, label in packing:
        known = code == h5py.h5z.FILTER_DEFLATE or (code == h5py.h5z.FILTER_LZF and (len(values) < 3 or values[2] <= chunk))
        if not known or len(packing) > 1:
            what = label.decode("ascii", "replace")[:40] or f"filter {code}"
            raise InputError(doing, [f"{name!r} is packed by {what!r}; allowed is gzip or lzf, once; {_REPACK}"])
    return any(code == h5py.h5z.FILTER_DEFLATE for code, *_ in packing)


def _suspects(dataset: Any, most: float) -> list[Any]:
    """Where chunks begin that have more than `most` bytes as they are packed."""
    found: list[Any] = []

    def look(chunk: Any) -> None:
        if chunk.size > most:
            found.append(chunk.chunk_offset)

    dataset.chunk_iter(look)
    return found


def _check_deflated(packed: bytes, chunk: int, name: str, doing: str) -> None:
    with contextlib.suppress(zlib.error):  # damage, which the library finds too
        if len(zlib.decompressobj().decompress(packed, chunk + 16)) > chunk + 8:  # a checksum may be packed with it
            raise InputError(doing, [f"a chunk of {name!r} unpacks to more than the {shown(chunk)} that it declares: the file is damaged"])

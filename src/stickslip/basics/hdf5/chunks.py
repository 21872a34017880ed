"""Chunks of a dataset, unpacked here: the HDF5 library trusts their sizes, and ends the process or grows without end over damaged ones.

A chunk is kept as its filters left it: shuffled (the first bytes of all numbers, then the second ones), deflated or packed by LZF, and
followed by a checksum (Fletcher). Each is undone in the order opposite to the one in which it was done.
"""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

_DEFLATE, _SHUFFLE, _FLETCHER, _LZF = 1, 2, 3, 32000
Undo = Callable[[bytes, int, tuple[int, ...]], bytes]


def dataset_values(dataset: Any) -> Any:
    """All numbers of a dataset; `ValueError` where a chunk is not what the dataset declares.

    Parameters
    ----------
    dataset : h5py.Dataset
        Of a file that was looked through by `opened`.
    """
    if dataset.chunks is None:
        return dataset[()]
    import h5py

    if h5py.h5t.py_create(dataset.dtype, logical=True) != dataset.id.get_type():
        raise ValueError("its numbers are of no usual type")
    corners = _places(dataset.id)
    kept = set(corners)
    every = itertools.product(*(range(0, n, step) for n, step in zip(dataset.shape, dataset.chunks, strict=True)))
    missing = next((corner for corner in every if corner not in kept), None)
    array = np.full(dataset.shape, 0 if missing is None else dataset[missing], dataset.dtype)
    for corner, part in _chunks(dataset.id, corners):
        whole = np.frombuffer(part, dataset.dtype).reshape(dataset.chunks)
        inside = tuple(slice(0, max(n - start, 0)) for n, start in zip(dataset.shape, corner, strict=True))
        there = tuple(slice(start, start + n) for start, n in zip(corner, dataset.chunks, strict=True))
        array[there] = whole[inside]
    return array


def check_chunks(dataset: Any) -> None:
    """That every chunk is what the dataset declares, before another library reads it; `ValueError` where one is not."""
    for _ in _chunks(dataset, _places(dataset)):
        pass


def _places(dataset: Any) -> list[tuple[int, ...]]:
    """Where chunks begin."""
    places: list[tuple[int, ...]] = []
    dataset.chunk_iter(lambda chunk: places.append(chunk.chunk_offset))  # append returns None: go on
    return places


def _chunks(dataset: Any, corners: list[tuple[int, ...]]) -> Iterator[tuple[tuple[int, ...], bytes]]:
    """Chunks with where they begin, unpacked."""
    made = dataset.get_create_plist()
    size = dataset.get_type().get_size() * math.prod(made.get_chunk())
    filters = [made.get_filter(i) for i in range(made.get_nfilters())]
    for corner in corners:
        left_out, data = dataset.read_direct_chunk(corner)
        for i, (code, _, parameters, _) in reversed([*enumerate(filters)]):
            if not left_out >> i & 1:
                data = KNOWN[code](data, size, parameters)
        if len(data) != size:
            raise ValueError(f"a chunk of {len(data)} bytes where {size} are declared")
        yield corner, data


# ---- filters ----
def _inflated(data: bytes, size: int, parameters: tuple[int, ...]) -> bytes:
    machine = zlib.decompressobj()
    try:
        unpacked = machine.decompress(data, size + 8)  # with a checksum, and one byte to be seen
    except zlib.error as error:
        raise ValueError(f"a chunk is damaged, {error}") from None
    if not machine.eof and machine.decompress(machine.unconsumed_tail, 1):
        raise ValueError(f"a chunk unpacks to more than the {size} bytes that are declared")
    return unpacked


def _in_order(data: bytes, size: int, parameters: tuple[int, ...]) -> bytes:
    width = parameters[0] if parameters else 1
    if not 1 <= width <= max(size, 1):
        raise ValueError(f"a chunk is shuffled by numbers of {width} bytes")
    whole = len(data) // width * width
    numbers = np.frombuffer(data[:whole], "u1").reshape(width, -1)
    return numbers.T.tobytes() + data[whole:]


def _without_checksum(data: bytes, size: int, parameters: tuple[int, ...]) -> bytes:
    """The bytes before their checksum; Fletcher's sums of words of 16 bits are equal modulo 65535."""
    if len(data) < 4:
        raise ValueError(f"a chunk of {len(data)} bytes holds no checksum")
    data, kept = data[:-4], int.from_bytes(data[-4:], "little")
    words = np.frombuffer(data + b"\0" * (len(data) % 2), ">u2").astype(np.uint64)
    weights = np.arange(len(words), 0, -1, dtype=np.uint64) % np.uint64(65535)
    sums = (int((weights * words).sum()) % 65535, int(words.sum()) % 65535)
    if sums != ((kept >> 16) % 65535, (kept & 0xFFFF) % 65535):
        raise ValueError("the checksum of a chunk does not fit")
    return data


def _expanded(data: bytes, size: int, parameters: tuple[int, ...]) -> bytes:
    """Expands LZF: literal runs of bytes, and references to up to 264 bytes within the last 8192."""
    unpacked, at = bytearray(), 0
    while at < len(data) and len(unpacked) <= size + 4:
        head, at = data[at], at + 1
        if head < 32:  # a run
            unpacked += data[at : at + head + 1]
            at += head + 1
            continue
        length = head >> 5
        if length == 7:
            length, at = length + data[at], at + 1
        back, at = ((head & 31) << 8 | data[at]) + 1, at + 1
        if back > len(unpacked):
            raise ValueError("a chunk refers to what lies before it")
        piece = unpacked[len(unpacked) - back : len(unpacked) - back + length + 2]
        while len(piece) < length + 2:  # it overlaps what it makes
            piece += piece[: length + 2 - len(piece)]
        unpacked += piece
    return bytes(unpacked)


#: What undoes the filters that are read, by their numbers in HDF5.
KNOWN: dict[int, Undo] = {_DEFLATE: _inflated, _SHUFFLE: _in_order, _FLETCHER: _without_checksum, _LZF: _expanded}

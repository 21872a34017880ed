"""Files that a page sends: received within a time limit, read in a separate process, and fitted in another."""

from __future__ import annotations

import asyncio
from typing import Any

from starlette.requests import ClientDisconnect, Request
from starlette.responses import PlainTextResponse, Response

from stickslip.basics.child_process import ChildProcess
from stickslip.show.explorer.dropped_records import MOST_BYTES
from stickslip.show.explorer.log_fits import MOST, Fitters, problems
from stickslip.show.explorer.upload_reading import Reader

#: Time limits for receiving a record, and for reading it [s].
RECEIVING, READING = 120.0, 20.0
_ZIP = b"PK"  # how a record for the process that fits begins; everything else is already a response


class Uploads:
    """The records that pages send, the process that reads them, and those that fit them."""

    def __init__(self) -> None:
        self._reader, self._fitters = Reader(READING), Fitters()

    async def answer(self, request: Request, what: str, choices: Any = None) -> Response:
        """The response to a file: its "velocity", its "drive" or the "plan" of its fit, or the error."""
        data = await _received(request)
        if isinstance(data, Response):
            return data
        answer = await self._read(request, what, data, choices)
        if what == "plan":
            asyncio.get_running_loop().run_in_executor(None, self._fitters.prepare)
        return _binary(answer)

    async def fitted(self, request: Request, choices: dict[str, Any]) -> Response:
        """The response with the fit of a file; the fit ends when the page no longer waits for it."""
        data = await _received(request)
        if isinstance(data, Response):
            return data
        record = await self._read(request, "record", data, choices)
        if not record.startswith(_ZIP):
            return _binary(record)
        child = self._fitters.taken()
        if child is None:
            return _binary(problems(f"{MOST} fits are under way on this server; wait for one, or stop it"))
        left = asyncio.create_task(_ended_without_page(request, child))
        try:
            return _binary(await asyncio.get_running_loop().run_in_executor(None, self._fitters.fit, child, choices, record))
        finally:
            left.cancel()

    async def _read(self, request: Request, what: str, data: bytes, choices: Any) -> bytes:
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(None, self._reader.read, what, request.path_params["name"], data, choices)

    def close(self) -> None:
        """End the processes."""
        self._reader.end()
        self._fitters.close()


def _binary(answer: bytes) -> Response:
    return Response(answer, media_type="application/octet-stream")


async def _received(request: Request) -> bytes | Response:
    """The file, or the response that says why there is none."""
    try:
        async with asyncio.timeout(RECEIVING):
            data = await _whole(request)
    except ClientDisconnect:
        return PlainTextResponse("", 400)
    except TimeoutError:
        return PlainTextResponse("the file did not arrive in time; try again\n", 408, {"Connection": "close"})
    if data is None:
        return PlainTextResponse(f"the file is larger than {MOST_BYTES // 1_000_000} MB\n", 413, {"Connection": "close"})
    return data


async def _ended_without_page(request: Request, child: ChildProcess) -> None:
    """End a process once the page has closed the connection of a request whose body was read."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
    child.end()


async def _whole(request: Request) -> bytes | None:
    """The complete file, or None if it is too large."""
    data = bytearray()
    async for part in request.stream():
        data += part
        if len(data) > MOST_BYTES:
            return None
    return bytes(data)

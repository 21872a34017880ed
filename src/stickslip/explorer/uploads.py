"""Files that a page sends: taken within a time, so many at once of an address, and read in a process of their own."""

from __future__ import annotations

import asyncio
from collections import Counter

from starlette.requests import ClientDisconnect, Request
from starlette.responses import PlainTextResponse, Response

from stickslip.explorer.client_limits import Limits
from stickslip.explorer.dropped_records import MOST_BYTES
from stickslip.explorer.upload_reading import Readers


class Uploads:
    """The files that are on their way.

    Parameters
    ----------
    limits : Limits
    """

    def __init__(self, limits: Limits):
        self._limits, self._readers = limits, Readers(limits.reading)
        self._under_way: Counter[str] = Counter()

    async def answer(self, request: Request, what: str) -> Response:
        """The answer to a file: its "velocity" or its "drive", or what is wrong."""
        address = request.client.host if request.client else ""
        if self._under_way[address] >= self._limits.uploads:
            return PlainTextResponse("two records are being read already; try again later\n", 503, {"Retry-After": "5"})
        self._under_way[address] += 1
        try:
            return await self._answer(request, what)
        except ClientDisconnect:
            return PlainTextResponse("", 400)  # nobody is there to read it
        finally:
            self._under_way[address] -= 1

    async def _answer(self, request: Request, what: str) -> Response:
        try:
            async with asyncio.timeout(self._limits.upload):
                data = await self._whole(request)
        except TimeoutError:
            return PlainTextResponse("the file did not arrive in time; try again\n", 408, {"Connection": "close"})
        if data is None:
            return PlainTextResponse(f"the file is larger than {MOST_BYTES // 1_000_000} MB\n", 413, {"Connection": "close"})
        loop = asyncio.get_running_loop()
        answer = await loop.run_in_executor(None, self._readers.read, what, request.path_params["name"], data)
        return Response(answer, media_type="application/octet-stream")

    async def _whole(self, request: Request) -> bytes | None:
        """The file, or None where it is too large; `TimeoutError` where nothing more comes."""
        data, parts = bytearray(), request.stream()
        while True:
            try:
                async with asyncio.timeout(self._limits.silence):
                    data += await anext(parts)
            except StopAsyncIteration:
                return bytes(data)
            if len(data) > MOST_BYTES:
                return None

    def close(self) -> None:
        """End the processes that read."""
        self._readers.end()

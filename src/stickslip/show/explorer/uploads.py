"""Files that a page sends: received within a time limit, a few at a time per address, and read in a separate process."""

from __future__ import annotations

import asyncio
from collections import Counter

from starlette.requests import ClientDisconnect, Request
from starlette.responses import PlainTextResponse, Response

from stickslip.show.explorer.client_limits import Limits
from stickslip.show.explorer.dropped_records import MOST_BYTES
from stickslip.show.explorer.upload_reading import Readers


class Uploads:
    """The uploads in progress.

    Parameters
    ----------
    limits : Limits
    """

    def __init__(self, limits: Limits):
        self._limits, self._readers = limits, Readers(limits.reading)
        self._under_way: Counter[str] = Counter()

    async def answer(self, request: Request, what: str) -> Response:
        """The response to a file: its "velocity" or its "drive", or the error."""
        address = request.client.host if request.client else ""
        if self._under_way[address] >= self._limits.uploads:
            return PlainTextResponse("two records are being read already; try again later\n", 503, {"Retry-After": "5"})
        self._under_way[address] += 1
        try:
            return await self._answer(request, what)
        except ClientDisconnect:
            return PlainTextResponse("", 400)  # the client has disconnected
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
        """The complete file, or None if it is too large; `TimeoutError` if the upload stalls."""
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
        """End the reading processes."""
        self._readers.end()

"""Limits on connections: those without an admitted request ("strangers") are few and short-lived, and the oldest is closed first.

So half-sent requests, however many, block nobody: a complete request with the token is admitted, and counted by address instead.
On the loopback all addresses are equal; there the token distinguishes its user's pages from the connections of other users.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from stickslip.show.explorer.client_limits import Limits

Client = tuple[str, int]


class Connections:
    """The open connections: strangers, and the number of requests and pages of each address.

    Parameters
    ----------
    limits : Limits
    """

    def __init__(self, limits: Limits):
        self._limits = limits
        self._strangers: dict[Client, asyncio.Transport] = {}  # the oldest first
        self._timers: dict[Client, asyncio.TimerHandle] = {}
        self._held: Counter[str] = Counter()

    def wait(self, client: Client | None, transport: asyncio.Transport) -> None:
        """Register a connection that may send a request within a short time."""
        if client is None:
            return
        self.forget(client)
        self._strangers[client] = transport
        self._set(client, transport, self._limits.headers)
        if len(self._strangers) > self._limits.strangers:
            self._drop_one()

    def admit(self, client: Client | None, http: bool) -> bool:
        """Admit a request, unless its address has reached its limit; `release` must follow."""
        if client is None:
            return True
        if self._held[client[0]] >= self._limits.each:
            return False
        self._held[client[0]] += 1
        transport = self._strangers.get(client)
        self.forget(client)
        if http and transport is not None:  # the connection of a page has other limits
            self._set(client, transport, self._limits.request)
        return True

    def release(self, client: Client | None) -> None:
        """Count one request or page less: it was answered, or has closed."""
        if client is None:
            return
        self._held[client[0]] -= 1
        if not self._held[client[0]]:
            del self._held[client[0]]

    def forget(self, client: Client | None) -> None:
        """Stop watching a connection, which was lost or admitted."""
        if client is not None:
            self._strangers.pop(client, None)
            if (timer := self._timers.pop(client, None)) is not None:
                timer.cancel()

    def _set(self, client: Client, transport: asyncio.Transport, seconds: float) -> None:
        self._timers[client] = asyncio.get_running_loop().call_later(seconds, self._drop, client, transport)

    def _drop(self, client: Client, transport: asyncio.Transport) -> None:
        self.forget(client)
        transport.abort()

    def _drop_one(self) -> None:
        """Close the oldest connection of the address with most strangers."""
        crowd = Counter(host for host, _ in self._strangers).most_common(1)[0][0]
        oldest = next(client for client in self._strangers if client[0] == crowd)
        self._drop(oldest, self._strangers[oldest])


class Watched(H11Protocol):
    """A connection that reports its state to `Connections`."""

    def __init__(self, connections: Connections, *arguments: Any, **more: Any):
        super().__init__(*arguments, **more)
        self._watch = connections

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Register the new connection."""
        super().connection_made(transport)
        self._watch.wait(self.client, transport)

    def connection_lost(self, exc: Exception | None) -> None:
        """Remove the lost connection."""
        self._watch.forget(self.client)
        super().connection_lost(exc)

    def on_response_complete(self) -> None:
        """Wait for the next request after a response."""
        if not self.transport.is_closing():
            self._watch.wait(self.client, self.transport)
        super().on_response_complete()

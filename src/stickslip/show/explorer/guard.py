"""Access control: the name in Host and Origin must be ours, and a token is required, because a machine has other users."""

from __future__ import annotations

import contextlib
import hmac
import ipaddress
import socket
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import SplitResult, parse_qs, urlsplit

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse

COOKIE = "stickslip_token"
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-cache",
}


def is_loopback(host: str) -> bool:
    """Whether a host means this machine alone.

    Examples
    --------
    >>> is_loopback("127.0.0.1"), is_loopback("localhost"), is_loopback("0.0.0.0")
    (True, True, False)
    """
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return host == "localhost"


class RequestGuard:
    """The application, with checks of every request.

    Parameters
    ----------
    app : ASGI application
    host : str
        The address on which the server listens.
    token : str or None
        The token that a page must send, first in the address and then as a cookie; None if none is needed.
    """

    def __init__(self, app: Any, host: str, token: str | None):
        self.inner, self._host, self._token = app, host, token

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        """Let a request through, or refuse it."""
        if scope["type"] not in ("http", "websocket"):
            return await self.inner(scope, receive, send)
        if (refused := self._refused(scope)) is not None:
            return await _refuse(refused, 403, scope, receive, send)
        if not _is_text(scope["query_string"]):  # routing such a request would raise an error
            return await _refuse("the address of this request is not text in UTF-8", 400, scope, receive, send)
        await self.inner(scope, receive, self._marked(scope, send))

    def _refused(self, scope: Any) -> str | None:
        """The reason for refusing a request; None if it is admitted."""
        headers = Headers(scope=scope)
        hosts, origins = headers.getlist("host"), headers.getlist("origin")
        if len(hosts) != 1 or not self._is_ours(hosts[0]):
            return "the Host of this request is not this server"
        if len(origins) > 1 or (origins and _split(origins[0]).netloc != hosts[0]):
            return "the Origin of this request is another page"
        if headers.get("sec-fetch-site", "none") not in ("none", "same-origin") and not _opens(scope, headers):
            return "this request comes from another page"
        if self._token is not None and not self._knows_token(scope, headers):
            return "the token is missing; open the address that `stickslip explore` printed (--no-token does without)"
        return None

    def _is_ours(self, host: str) -> bool:
        """Whether a Host names this server: protection against foreign names that resolve to this machine."""
        name = (_split(f"//{host}").hostname or "").lower()
        if is_loopback(self._host):
            return is_loopback(name)
        return name in (self._host, socket.gethostname().lower()) or _is_address(name)

    def _knows_token(self, scope: Any, headers: Headers) -> bool:
        given = [*_query(scope).get("token", ())]
        cookies: SimpleCookie = SimpleCookie()
        with contextlib.suppress(CookieError):
            cookies.load(headers.get("cookie", ""))
        if (name := _cookie(scope)) in cookies:
            given.append(cookies[name].value)
        return any(hmac.compare_digest(word.encode(), (self._token or "").encode()) for word in given)

    def _marked(self, scope: Any, send: Any) -> Any:
        """Wrap `send`, to add the headers of every response and the token as a cookie."""
        cookie = (
            f"{_cookie(scope)}={self._token}; HttpOnly; SameSite=Strict; Path=/" if self._token and _query(scope).get("token") else None
        )

        async def marked(event: Any) -> None:
            if event["type"] == "http.response.start":
                headers = MutableHeaders(scope=event)
                for name, value in HEADERS.items():
                    headers.setdefault(name, value)
                if cookie:
                    headers.append("Set-Cookie", cookie)
            await send(event)

        return marked if scope["type"] == "http" else send


def _is_text(query: bytes) -> bool:
    """Whether the query of an address is valid UTF-8."""
    try:
        return isinstance(query.decode(), str)
    except UnicodeDecodeError:
        return False


async def _refuse(why: str, status: int, scope: Any, receive: Any, send: Any) -> None:
    """Send the reason, and close the connection."""
    if scope["type"] == "websocket":
        await receive()
        return await send({"type": "websocket.close", "code": 1008, "reason": why[:120]})
    await PlainTextResponse(why + "\n", status, {**HEADERS, "Connection": "close"})(scope, receive, send)


def _cookie(scope: Any) -> str:
    """The name of the cookie: browsers share cookies between the ports of a host, and each server needs its own."""
    return f"{COOKIE}_{(scope.get('server') or ('', 0))[1]}"


def _split(address: str) -> SplitResult:
    """The parts of an address; empty parts if it is invalid."""
    try:
        return urlsplit(address)
    except ValueError:
        return urlsplit("")


def _opens(scope: Any, headers: Headers) -> bool:
    """Whether a request only opens the page, as a link from another site does."""
    return scope["type"] == "http" and scope["path"] == "/" and headers.get("sec-fetch-mode") == "navigate"


def _query(scope: Any) -> dict[str, list[str]]:
    try:
        return parse_qs(scope.get("query_string", b"").decode("latin-1"), max_num_fields=16)
    except ValueError:
        return {}


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True

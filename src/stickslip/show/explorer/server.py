"""The server of the explorer: one page, its files, a websocket for slider values, and exports."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import functools
import json
import re
import secrets
from collections.abc import AsyncIterator, Callable
from importlib.resources import files
from typing import Any
from urllib.parse import parse_qs

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from stickslip.basics.errors import InputError, StickslipError
from stickslip.models.drives.within import drives_within
from stickslip.show.explorer.exports import EXPORTS, export
from stickslip.show.explorer.first_picture import first_picture
from stickslip.show.explorer.guard import RequestGuard, is_loopback
from stickslip.show.explorer.kernels import Kernels
from stickslip.show.explorer.machines import Shown, part_label, report, study
from stickslip.show.explorer.models import CONTACTS, DRIVES, FRICTION, TRACKS, active
from stickslip.show.explorer.paper_figures import GROUPS, PRESETS
from stickslip.show.explorer.requests import DEFAULT, KEPT, MOST_HARMONICS, machine_numbers, state
from stickslip.show.explorer.sessions import MESSAGE_BYTES, Session, Workshop
from stickslip.show.explorer.sliders import PARAMETERS
from stickslip.show.explorer.uploads import Uploads

_TYPES = {
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
}
#: Downloads for a machine: file name -> (media type, function that makes it).
MACHINE_EXPORTS = {
    "report.html": ("text/html; charset=utf-8", report),
    "study.toml": ("application/toml; charset=utf-8", study),
}
_GROUPS = {
    "Drive": {name for part in DRIVES.values() for name in part.parameters},
    "Track": {name for part in TRACKS.values() for name in part.parameters} | {"gravity"},
    "Masses": {"body_mass", "inner_mass"},
}


# ---- the page ----
def _rendered(template: str, script: str, **content: Any) -> str:
    from stickslip import __version__
    from stickslip.show.reports.html import environment

    templates = environment(str(files("stickslip.show.explorer") / "assets"))
    return templates.get_template(template).render(**content, scripts=_modules(script), version=__version__)


def _modules(name: str) -> list[str]:
    """A script's modules, each after the first that imports it: the page requests them all at once, not one after the other."""
    known = [name]
    for each in known:  # grows
        known += [other for other in re.findall(r'from "\./([a-z]+\.js)"', _assets()[each].decode()) if other not in known]
    return known


def machine_page(shown: Shown) -> str:
    """The page of a machine before any script runs."""
    data = {"parameters": {name: vars(p) for name, p in shown.numbers.items()}, "exports": list(MACHINE_EXPORTS)}
    groups = {part_label(part): of for part, of in shown.groups.items()}
    return _rendered("machine.html", "machine.js", shown=shown, groups=groups, exports=list(MACHINE_EXPORTS), data=data, kept=_kept(shown))


def _kept(shown: Shown) -> list[str]:
    """Quantities that a search may be forbidden to increase; sweeps of a machine of several bodies have no column of power."""
    from stickslip.inverse.optimisation.peaks import LIMITS as LIMITS_OF_DRIVES
    from stickslip.inverse.optimisation.results import quantities

    known = [*LIMITS_OF_DRIVES, *quantities(shown.model)] if list(drives_within(shown.model)) else quantities(shown.model)
    return [name for name in KEPT if name in known]


@functools.cache
def page() -> str:
    """The page before any script runs."""
    groups = {name: [p for p in PARAMETERS.values() if p.name in own] for name, own in _GROUPS.items()}
    rest = [p for p in PARAMETERS.values() if not any(p in group for group in groups.values())]
    return _rendered(
        "page.html", "main.js", drives=DRIVES, tracks=TRACKS, contacts=CONTACTS, laws=FRICTION, presets=GROUPS, exports=list(EXPORTS),
        groups={"Drive": groups["Drive"], "Track": groups["Track"], "Friction": rest, "Masses": groups["Masses"]},
        first=DEFAULT, active=set(DEFAULT.active), data=_data(), kept=KEPT, picture=base64.b64encode(first_picture() or b"").decode(),
    )  # fmt: skip


def _data() -> dict[str, Any]:
    """The data for the scripts: which parameters matter when, their numbers, the presets."""
    choices = {"drive": DRIVES, "track": TRACKS, "contact": CONTACTS, "law": FRICTION}
    return {
        "parameters": {name: vars(p) for name, p in PARAMETERS.items()},
        "choices": {
            kind: {name: {"label": p.label, "parameters": list(p.parameters)} for name, p in parts.items()}
            for kind, parts in choices.items()
        },
        "always": active("harmonic", "level", "isotropic", ()),
        "presets": PRESETS,
        "harmonics": MOST_HARMONICS,
        "first": {"drive": DEFAULT.drive, "track": DEFAULT.track, "contact": DEFAULT.contact, "law": DEFAULT.law, "also": DEFAULT.also},
    }


async def _page(request: Request) -> Response:
    shown = request.app.state.workshop.shown
    return HTMLResponse(page() if shown is None else machine_page(shown))


@functools.cache
def _assets() -> dict[str, bytes]:
    """The files of the page, read once; nothing else can be requested."""
    own, shared = files("stickslip.show.explorer") / "assets", files("stickslip.show.reports") / "templates"
    paths = [*own.iterdir(), *(shared / name for name in ("moving.js", "moving.css"))]
    return {f.name: f.read_bytes() for f in paths if f.is_file() and "." + f.name.rpartition(".")[2] in _TYPES}


async def _asset(request: Request) -> Response:
    name = request.path_params["name"]
    if name not in _assets():
        return PlainTextResponse("there is no such file\n", 404)
    return Response(_assets()[name], media_type=_TYPES["." + name.rpartition(".")[2]])


# ---- exports ----
async def _export(request: Request) -> Response:
    name, workshop = request.path_params["name"], request.app.state.workshop
    try:
        shown = state(_asked_json(request, "state"))
        missing = [law for law in shown.laws if name in EXPORTS and not workshop.kernels.ready(shown, law, shown.robot(law), False)]
        if missing:
            return PlainTextResponse(f"{', '.join(missing)}: still compiling, once; try again in some seconds\n", 503, {"Retry-After": "5"})
        return await _made(request, EXPORTS.get(name, ("", None))[0], export, name, shown)
    except StickslipError as error:
        return PlainTextResponse(f"{error}\n", 404 if name not in EXPORTS else 400)


async def _machine_export(request: Request) -> Response:
    """The report or the study file of the machine with the numbers in the address."""
    name, shown = request.path_params["name"], request.app.state.workshop.shown
    if shown is None or name not in MACHINE_EXPORTS:
        return PlainTextResponse("there is no such file\n", 404)
    try:
        return await _made(request, *MACHINE_EXPORTS[name], shown, machine_numbers(_asked_json(request, "machine")))
    except StickslipError as error:
        return PlainTextResponse(f"{error}\n", 400)


async def _made(request: Request, media: str, make: Callable[..., bytes], *given: Any) -> Response:
    """A download, made in a thread, under the name in the address."""
    data = await asyncio.get_running_loop().run_in_executor(None, make, *given)
    return Response(data, media_type=media, headers={"Content-Disposition": f'attachment; filename="{request.path_params["name"]}"'})


async def _record(request: Request) -> Response:
    """The velocity or the drive of a measured record, read by `stickslip.read`."""
    what = "drive" if request.url.path.startswith("/drive/") else "velocity"
    return await request.app.state.uploads.answer(request, what)


async def _log(request: Request) -> Response:
    """What a log is taken for, or its fit, with the choices in the address."""
    try:
        choices = _asked_json(request, "choices")
    except InputError as error:
        return PlainTextResponse(f"{error}\n", 400)
    uploads = request.app.state.uploads
    fits = request.url.path.startswith("/fit/")
    return await (uploads.fitted(request, choices) if fits else uploads.answer(request, "plan", choices))


def _asked_json(request: Request, name: str) -> Any:
    """The JSON value of a name in the query of an address."""
    query = request.scope["query_string"].decode("latin-1")
    try:
        return json.loads(parse_qs(query, max_num_fields=4).get(name, ["{}"])[0])
    except (ValueError, RecursionError):
        raise InputError("export", [f"{name} is not JSON"]) from None


# ---- the server ----
async def _socket(socket: WebSocket) -> None:
    await Session(socket, socket.app.state.workshop).serve()


def application(
    host: str = "127.0.0.1", token: str | None = None, workers: int | None = None, separate: bool = True, shown: Shown | None = None
) -> Any:
    """The explorer as an ASGI application.

    Parameters
    ----------
    host : str
        Where it will listen; on the loopback, only names of this machine are accepted.
    token : str, optional
        The token that a page must send.
    workers : int, optional
        Computing threads; by default one for each processor, at least 2 and at most 8.
    separate : bool
        Whether to compile in a separate process.
    shown : Shown, optional
        The machine whose page is served; without it that of robots.
    """

    @contextlib.asynccontextmanager
    async def life(app: Starlette) -> AsyncIterator[None]:
        kernels = Kernels(separate)
        app.state.workshop = Workshop(kernels, workers, shown)
        app.state.uploads = Uploads()
        if shown is None:
            kernels.begin(state(preset["state"]) for preset in PRESETS.values())
        else:
            kernels.ready(shown, "", shown.model, False)
        yield
        app.state.workshop.close()
        app.state.uploads.close()

    routes = [
        Route("/", _page),
        Route("/assets/{name}", _asset),
        Route("/export/{name}", _export),
        Route("/machine/{name}", _machine_export),
        Route("/record/{name}", _record, methods=["POST"]),
        Route("/drive/{name}", _record, methods=["POST"]),
        Route("/log/{name}", _log, methods=["POST"]),
        Route("/fit/{name}", _log, methods=["POST"]),
        WebSocketRoute("/socket", _socket),
    ]
    return RequestGuard(Starlette(routes=routes, lifespan=life), host, token)


class _Server(uvicorn.Server):
    """A server that reports its address once it is listening."""

    def __init__(self, config: uvicorn.Config, tell: Callable[[int], None]):
        super().__init__(config)
        self._tell = tell

    async def startup(self, sockets: Any = None) -> None:
        """Start serving, then report the port."""
        await super().startup(sockets)
        if self.started:
            self._tell(self.servers[0].sockets[0].getsockname()[1])

    async def shutdown(self, sockets: Any = None) -> None:
        """Stop reading records first, as no client waits for them any longer."""
        guard: Any = self.config.app
        guard.inner.state.uploads.close()
        await super().shutdown(sockets)


def server_of(
    host: str,
    port: int,
    tell: Callable[[str], None],
    workers: int | None = None,
    with_token: bool = True,
    shown: Shown | None = None,
) -> uvicorn.Server:
    """A server, whose ``run`` serves until interrupted.

    Parameters
    ----------
    host : str
        Where to listen.
    port : int
        0 selects a free port.
    tell : callable
        Called with the address once the page can be opened.
    workers : int, optional
        As for `application`.
    with_token : bool
        Whether to require a token, which is part of the address; without one, all users of this machine may use the page.
    shown : Shown, optional
        The machine whose page is served; without it that of robots.
    """
    if not with_token and not is_loopback(host):
        raise InputError("explore", [f"--no-token is for this machine alone, and --host is {host}; leave one of them out"])
    token = secrets.token_urlsafe(24) if with_token else None
    app = application(host, token, workers, shown=shown)
    config = uvicorn.Config(
        app, host=host, port=port, log_level="error", access_log=False, lifespan="on", http="h11",
        ws="websockets-sansio", ws_max_size=MESSAGE_BYTES, ws_per_message_deflate=False, server_header=False,
        timeout_graceful_shutdown=2, backlog=256, proxy_headers=False,
    )  # fmt: skip
    name = f"[{host}]" if ":" in host else host
    _check_port(host, port)
    query = f"?token={token}" if token else ""
    return _Server(config, lambda taken: tell(f"http://{name}:{taken}/{query}"))


def _check_port(host: str, port: int) -> None:
    """Raise an error with advice if a port is in use, before anything starts."""
    import socket

    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except OSError as error:
            why = error.strerror or error
            raise InputError("explore", [f"cannot listen on {host}, port {port}: {why}; type --port 0 for a free port"]) from None

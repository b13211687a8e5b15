"""The workbench on loopback: its routes, behind `dashboards.guard`.

It listens on 127.0.0.1 only. Nothing is fetched from elsewhere, and the page may not be framed.
"""

import socket
from collections.abc import Callable
from pathlib import Path
from threading import Lock
from typing import Final, TypeVar

import uvicorn
from markupsafe import Markup
from pydantic import BaseModel, ValidationError
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from dashboards import fonts, labels
from dashboards.guard import guarded
from dashboards.html import as_json, environment, in_both
from dashboards.site.render import vega_bundle
from dashboards.site.specifications import chart_specifications
from dashboards.workbench.bench import Base, Bench, Named, Question
from dashboards.workbench.texts import in_each, words
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGES, pgettext, say

LOOPBACK: Final = "127.0.0.1"
HERE: Final = Path(__file__).parent
SITE: Final = HERE.parent / "site" / "static"

HEADERS: Final = {
    # Vega compiles its expressions, and its tooltips bring a style of their own.
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
        "img-src data:; font-src data:; connect-src 'self'; form-action 'none'; "
        "frame-ancestors 'none'; base-uri 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}

Wanted = TypeVar("Wanted", bound=BaseModel)


def application(bench: Bench) -> Starlette:
    """The workbench as a web application."""
    page = _page(bench)
    figures = {language: chart_specifications(language) for language in LANGUAGES}
    files = {
        "vega.js": vega_bundle(),
        "figures.js": f"window.HERIJK_FIGURES = {as_json(figures)};\n",
        "font.css": fonts.style_sheet(),
        "site.css": (SITE / "site.css").read_text(encoding="utf-8"),
    } | {f.name: f.read_text(encoding="utf-8") for f in (HERE / "static").iterdir()}

    async def index(_: Request) -> Response:
        return HTMLResponse(page, headers=HEADERS)

    async def static(request: Request) -> Response:
        name = request.path_params["name"]
        if name not in files:
            raise HTTPException(404)
        kind = "text/css" if name.endswith(".css") else "text/javascript"
        return Response(files[name], media_type=kind, headers=HEADERS)

    def saved(wish: Named) -> dict[str, object]:
        path = bench.save(wish)
        data = path.parents[1]
        return {
            "path": str(path),
            "command": f"herijk compare as-published {path} --data {data}",
        }

    return Starlette(
        routes=[
            Route("/", index),
            Route("/static/{name}", static),
            _asked("/base", Base, bench.base),
            _asked("/answer", Question, bench.answer),
            _asked("/file", Named, lambda wish: {"text": bench.method_file(wish)}),
            _asked("/save", Named, saved),
        ]
    )


def _asked(path: str, model: type[Wanted], answer: Callable[[Wanted], dict[str, object]]) -> Route:
    """A route that takes a model as JSON.

    What cannot be is answered with a sentence in `refused`, and with status 200: it is an answer,
    and a browser reports other statuses as errors of the page.
    """
    one_at_a_time = Lock()

    def work(body: bytes) -> Response:
        try:
            wanted = model.model_validate_json(body)
            with one_at_a_time:
                return JSONResponse(answer(wanted), headers=HEADERS)
        except ValidationError as error:
            return JSONResponse(_refusal(error), headers=HEADERS)
        except HerijkError as error:
            return JSONResponse({"refused": str(error)}, headers=HEADERS)

    async def endpoint(request: Request) -> Response:
        return await run_in_threadpool(work, await request.body())

    return Route(path, endpoint, methods=["POST"])


def _refusal(error: ValidationError) -> dict[str, object]:
    """The first thing that is wrong, with the option it is about.

    `kind` and `limit` are for the page, which says it in its language; `refused` is for others.
    """
    first = error.errors(include_url=False)[0]
    known = first.get("ctx", {})
    where = [part for part in first["loc"] if isinstance(part, str) and part != "steps"]
    message = first["msg"]
    shown = "" if first["type"] == "json_invalid" else f", not {first['input']!r}"
    return {
        "refused": f"{'.'.join(where)}: {message[0].lower()}{message[1:]}{shown}",
        "where": ".".join(where),
        "kind": first["type"],
        "limit": next((known[name] for name in ("gt", "ge", "lt", "le") if name in known), None),
    }


def _page(bench: Bench) -> str:
    start = bench.start()
    data = Markup(as_json(start | {"words": words()}))  # noqa: S704 - as_json escapes
    made = environment(
        HERE / "templates",
        _=_text,
        both=in_each,
        say=say,
        pgettext=pgettext,
        SIMULATED=labels.SIMULATED,
    )
    return made.get_template("workbench.html.j2").render(start=start, data=data)


def _text(text: str) -> Markup:
    return in_both(in_each(text))


def address(listening: socket.socket) -> str:
    """Where a browser finds the workbench."""
    return f"http://{LOOPBACK}:{listening.getsockname()[1]}/"


def serving(bench: Bench) -> uvicorn.Server:
    """The server, to be run on a socket of `guard.listen`."""
    return guarded(application(bench), LOOPBACK)

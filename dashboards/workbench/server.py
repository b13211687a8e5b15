"""The workbench on loopback: its routes, behind `dashboards.guard`.

It listens on 127.0.0.1 only. Nothing is fetched from elsewhere, and the page may not be framed.
"""

import socket
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from threading import Lock
from typing import Final

import uvicorn
from markupsafe import Markup
from pydantic import ValidationError
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from dashboards import labels
from dashboards.guard import guarded
from dashboards.html import environment
from dashboards.option_labels import range_in_words, text, value_in_words
from dashboards.site.charts import page_json
from dashboards.site.parts import Page
from dashboards.site.render import Edition, charts_file, shared_files
from dashboards.workbench.bench import Asked, Bench, Saving
from dashboards.workbench.form import CONTROLS, Control
from dashboards.workbench.results import BenchCells, results
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGES, pgettext, spoken
from pipeline.method.definition import SeasonSteps
from pipeline.method.reading import list_shipped_methods
from pipeline.method.variant import Difference
from warehouse.queries.views import Views

LOOPBACK: Final = "127.0.0.1"
HERE: Final = Path(__file__).parent
SITE: Final = HERE.parent / "site" / "templates"
ADDRESSES: Final = {"nl": "/", "en": "/en/"}

HEADERS: Final = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; "
        "img-src data:; font-src data:; connect-src 'self'; form-action 'none'; "
        "frame-ancestors 'none'; base-uri 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
ONE_AT_A_TIME: Final = Lock()
ELSEWHERE: Final = "cross-site"
"""What a browser says of a request that a page of another site makes."""


def application(bench: Bench) -> Starlette:
    """The workbench as a web application."""
    own = {f.name: f.read_text(encoding="utf-8") for f in (HERE / "static").iterdir()}
    charts = {name: text for each in LANGUAGES for name, text in charts_file(each).items()}
    with Views(bench.store) as views:
        pages = [BenchPage(bench, views, language) for language in LANGUAGES]
    return Starlette(
        routes=[
            *[Route(ADDRESSES[page.language], page.shown) for page in pages],
            *[Route(f"/save/{page.language}", page.save, methods=["POST"]) for page in pages],
            Route("/static/{name}", _static(shared_files() | charts | own)),
        ]
    )


def _static(files: Mapping[str, str]) -> Callable[[Request], Response]:
    def static(request: Request) -> Response:
        name = request.path_params["name"]
        if name not in files:
            raise HTTPException(404)
        kind = "text/css" if name.endswith(".css") else "text/javascript"
        return Response(files[name], media_type=kind, headers=HEADERS)

    return static


class BenchPage:
    """The page of the workbench in one language."""

    def __init__(self, bench: Bench, views: Views, language: str) -> None:
        self._bench, self.language = bench, language
        self._edition = Edition(views, language, BenchCells)
        self._template = environment(
            *(HERE / "templates", SITE),
            pgettext=pgettext,
            text=text,
            value_in_words=value_in_words,
            SIMULATED=labels.SIMULATED,
            method_name=labels.method,
        ).get_template("workbench.html.j2")

    async def shown(self, request: Request) -> Response:
        """The answer to an address; a page of another site cannot have one made."""
        if request.headers.get("sec-fetch-site") == ELSEWHERE and request.query_params:
            raise HTTPException(403)
        page = await run_in_threadpool(self.html, dict(request.query_params))
        return HTMLResponse(page, headers=HEADERS)

    async def save(self, request: Request) -> Response:
        """The command that shows all that a saved method changes; or why it is not saved."""
        answer = await run_in_threadpool(self._saved, await request.body())
        return JSONResponse(answer, headers=HEADERS)

    def _saved(self, body: bytes) -> dict[str, str]:
        try:
            wanted = Saving.model_validate_json(body)
            path = self._bench.save(wanted)
        except ValidationError as error:
            return {"refused": str(error.errors(include_url=False)[0]["msg"])}
        except HerijkError as error:
            return {"refused": str(spoken(error, self.language))}
        base, data = self._bench.asked(wanted.address).base, self._bench.store.root
        return {"command": f"herijk compare {base} {path} --data {data}"}

    def html(self, query: Mapping[str, str]) -> str:
        """The page that answers an address; where it cannot be answered, the page that says so."""
        asked = self._bench.asked(query)
        try:
            with ONE_AT_A_TIME:
                page = results(self._bench, asked)
            return self._html(asked, page, self._bench.changed(asked))
        except HerijkError as error:
            usual = self._bench.asked({"base": asked.base} if self._known(asked.base) else {})
            return self._html(usual, refused=str(spoken(error, self.language)))

    def _known(self, method: str) -> bool:
        return method in (*list_shipped_methods(), *self._bench.known.own)

    def _html(
        self,
        asked: Asked,
        page: Page | None = None,
        changed: Sequence[Difference] = (),
        refused: str = "",
    ) -> str:
        ranges = self._bench.ranges(asked)
        other = next(name for name in LANGUAGES if name != self.language)
        shown = page or Page("index.html", text("workbench"), [])
        data = page_json(shown).replace("<", "\\u003c")
        return self._template.render(
            **self._edition.names(shown),
            stills={},
            site="" if self.language == "nl" else "../",
            root="",
            data_path="",
            asked=asked,
            changed=changed,
            refused=refused,
            data=Markup(data),  # noqa: S704 - no text in it closes the element
            methods=list(list_shipped_methods()),
            saved=list(self._bench.known.own),
            editions=self._bench.editions(),
            steps={} if refused else self._steps(asked, ranges),
            ranges=[(str(r.first), range_in_words(r.first, r.last)) for r in ranges],
            range_in_words=range_in_words,
            is_whole=lambda d: (d.first, d.last) == (ranges[0].first, ranges[-1].last),
            other=other,
            other_page=ADDRESSES[other] + asked.address(),
        )

    def _steps(
        self, asked: Asked, ranges: tuple[SeasonSteps, ...]
    ) -> dict[str, list[tuple[Control, str | None]]]:
        """The controls of each step, with what they hold in the seasons that are shown."""
        method = self._bench.method(asked)
        shown = [
            SeasonSteps(first=r.first, last=r.last, steps=method.for_season(r.first))
            for r in ranges
            if asked.at in ("", str(r.first))
        ]
        steps: dict[str, list[tuple[Control, str | None]]] = {}
        for control in CONTROLS.values():
            steps.setdefault(control.step, []).append((control, control.held(shown)))
        return steps


def address(listening: socket.socket) -> str:
    """Where a browser finds the workbench."""
    return f"http://{LOOPBACK}:{listening.getsockname()[1]}/"


def serving(bench: Bench) -> uvicorn.Server:
    """The server, to be run on a socket of `guard.listen`."""
    return guarded(application(bench), LOOPBACK)

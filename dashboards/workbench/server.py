"""The workbench on loopback: its routes, behind `dashboards.guard`.

It listens on 127.0.0.1 only. Nothing is fetched from elsewhere, and the page may not be framed.
"""

import socket
from collections.abc import Mapping
from threading import Lock
from typing import Any, Final

import uvicorn
from pydantic import ValidationError
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, Response
from starlette.routing import Route

from dashboards import fonts
from dashboards.document import Document
from dashboards.guard import make_server
from dashboards.language import Language, get_other_language
from dashboards.site import STATIC
from dashboards.workbench.bench import Asked, Bench, Saving
from dashboards.workbench.form import CONTROLS, Control
from pipeline.errors import HerijkError
from pipeline.messages import LANGUAGES, write_in_language
from pipeline.method.definition import SeasonSteps
from pipeline.method.reading import list_shipped_methods
from warehouse.queries.views import Views

LOOPBACK: Final = "127.0.0.1"
ADDRESSES: Final = {"nl": "/", "en": "/en/"}
HEADERS: Final = {
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; "
        "img-src data:; font-src data:; connect-src 'self'; form-action 'none'; "
        "frame-ancestors 'none'; base-uri 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
"""What every answer tells the browser."""

_COMPUTING: Final = Lock()
"""Held while an answer is computed: two at a time would be no quicker."""


def make_application(bench: Bench) -> Starlette:
    """Return the workbench as a web application."""
    files = {file.name: file.read_text("utf-8") for file in STATIC.iterdir()}
    files |= {"font.css": fonts.style_sheet()}
    with Views(bench.store) as views:
        about = views.about()
    pages = [BenchPage(bench, about, language) for language in LANGUAGES]

    def send_static(request: Request) -> Response:
        name = request.path_params["name"]
        if name not in files:
            raise HTTPException(404)
        kind = "text/css" if name.endswith(".css") else "text/javascript"
        return Response(files[name], media_type=kind, headers=HEADERS)

    return Starlette(
        routes=[
            *[Route(ADDRESSES[page.language], page.show) for page in pages],
            *[Route(f"/save/{page.language}", page.save, methods=["POST"]) for page in pages],
            Route("/static/{name}", send_static),
        ]
    )


class BenchPage:
    """The page of the workbench in one language.

    Args:
        bench: computes what is asked.
        about: what is known about the database.
        language: `nl` or `en`.
    """

    def __init__(self, bench: Bench, about: Mapping[str, str], language: str) -> None:
        self._bench, self._about, self.language = bench, about, language

    async def show(self, request: Request) -> Response:
        """Answer an address; a page of another site cannot have one computed."""
        if request.headers.get("sec-fetch-site") == "cross-site" and request.query_params:
            raise HTTPException(403)
        page = await run_in_threadpool(self.render, dict(request.query_params))
        return HTMLResponse(page, headers=HEADERS)

    async def save(self, request: Request) -> Response:
        """Save a method file, and say how to see all its effects."""
        body = await request.body()
        return JSONResponse(await run_in_threadpool(self._save, body), headers=HEADERS)

    def _save(self, body: bytes) -> dict[str, str]:
        try:
            wanted = Saving.model_validate_json(body)
            path = self._bench.save(wanted)
        except ValidationError as error:
            return {"refused": str(error.errors(include_url=False)[0]["msg"])}
        except HerijkError as error:
            return {"refused": str(write_in_language(error, self.language))}
        base, data = self._bench.read_address(wanted.address).base, self._bench.store.root
        return {"command": f"herijk compare {base} {path} --data {data}"}

    def render(self, query: Mapping[str, str]) -> str:
        """Return the page that answers an address, or the one that says why it cannot."""
        asked = self._bench.read_address(query)
        try:
            with _COMPUTING:
                results = self._bench.compute_results(asked)
            return self._render(asked, results, "")
        except HerijkError as error:
            is_known = asked.base in (*list_shipped_methods(), *self._bench.known.own)
            usual = self._bench.read_address({"base": asked.base} if is_known else {})
            return self._render(usual, None, str(write_in_language(error, self.language)))

    def _render(self, asked: Asked, results: dict[str, Any] | None, refused: str) -> str:
        bench = self._bench
        ranges = bench.list_ranges(asked)
        other = get_other_language(self.language)
        tows = results["tows"] if results else []
        chosen = {"tow_id": tows[0] if tows else ""}

        def link_to_boat(name: str, value: object) -> str:
            return asked.address(boat=value) + "#boat" if name == "fsn_no" and value else ""

        document = Document(Language(self.language, self._about), "", chosen, link=link_to_boat)
        return document.render(
            "workbench",
            asked=asked,
            results=results,
            refused=refused,
            ranges=ranges,
            changed=[] if refused else bench.list_changes(asked),
            steps={} if refused else self._list_controls(asked, ranges),
            methods=list(list_shipped_methods()),
            saved=list(bench.known.own),
            editions=bench.list_editions(),
            boats=bench.boats.select("fsn_no", "name").rows(),
            simulated=self._about.get("simulated") == "true",
            code_version=self._about.get("code_version", ""),
            path="",
            site_root="" if self.language == "nl" else "../",
            other=other,
            other_page=ADDRESSES[other] + asked.address(),
        )

    def _list_controls(
        self, asked: Asked, ranges: tuple[SeasonSteps, ...]
    ) -> dict[str, list[tuple[Control, str | None]]]:
        """Return the controls of each step, with their values in the seasons that are shown."""
        method = self._bench.make_method(asked)
        shown = [
            SeasonSteps(first=r.first, last=r.last, steps=method.get_steps(r.first))
            for r in ranges
            if asked.at in ("", str(r.first))
        ]
        steps: dict[str, list[tuple[Control, str | None]]] = {}
        for control in CONTROLS.values():
            steps.setdefault(control.step, []).append((control, control.find_value(shown)))
        return steps


def get_address(listening: socket.socket) -> str:
    """Return where a browser finds the workbench."""
    return f"http://{LOOPBACK}:{listening.getsockname()[1]}/"


def serve_bench(bench: Bench) -> uvicorn.Server:
    """Return the server, to be run on a socket of `guard.listen`."""
    return make_server(make_application(bench), LOOPBACK)

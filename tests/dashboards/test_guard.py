"""Pages of other sites can neither read nor ask; what pages hand out does no harm elsewhere."""

from pathlib import Path

import pytest
from starlette.applications import Starlette
from starlette.responses import PlainTextResponse
from starlette.routing import Route
from starlette.testclient import TestClient

import dashboards
from dashboards.guard import MAX_BODY_BYTES, guard
from warehouse.editions.sheets import FORMULA

OWN = {"host": "127.0.0.1:3000", "origin": "http://127.0.0.1:3000"}
JSON = {"content-type": "application/json"}


@pytest.fixture(scope="module")
def client():
    async def echo(request):
        return PlainTextResponse(await request.body())

    app = Starlette(routes=[Route("/", echo, methods=["GET", "POST"])])
    return TestClient(guard(app, "127.0.0.1"), base_url="http://127.0.0.1:3000")


@pytest.mark.parametrize(
    ("method", "headers", "is_answered"),
    [
        ("GET", OWN, True),
        ("GET", {"host": "localhost:3000"}, True),
        ("GET", {"host": "[::1]:3000"}, True),
        ("GET", {"host": "evil.example"}, False),
        ("GET", {"host": "127.0.0.1.evil.example"}, False),
        ("POST", OWN | JSON, True),
        ("POST", JSON | {"host": "127.0.0.1:3000"}, True),  # a script sends no origin
        ("POST", OWN | {"content-type": "text/plain"}, False),
        ("POST", OWN | {"content-type": "application/x-www-form-urlencoded"}, False),
        ("POST", OWN | JSON | {"origin": "http://evil.example"}, False),
        ("POST", OWN | JSON | {"origin": "http://127.0.0.1:1"}, False),
        ("POST", OWN | JSON | {"origin": "null"}, False),
    ],
)
def test_only_the_pages_own_requests_are_answered(client, method, headers, is_answered):
    content = b"{}" if method == "POST" else None
    answer = client.request(method, "/", headers=headers, content=content)
    assert (answer.status_code == 200) == is_answered
    assert answer.status_code in (200, 400, 403)


def test_a_body_is_bounded(client):
    headers = OWN | JSON
    assert client.post("/", headers=headers, content=b"x" * MAX_BODY_BYTES).status_code == 200
    assert client.post("/", headers=headers, content=b"x" * (MAX_BODY_BYTES + 1)).status_code == 413
    parts = (part for part in [b"x", b"y"])  # of a length that is not told
    assert client.post("/", headers=headers, content=parts).status_code == 413


def test_a_table_saved_from_a_page_holds_no_formula_either():
    text = (Path(dashboards.__file__).parent / "static" / "site.js").read_text("utf-8")
    assert f"/{FORMULA.pattern}/g" in text

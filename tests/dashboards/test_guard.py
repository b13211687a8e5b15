"""Pages of other sites can neither read nor ask; what pages hand out does no harm elsewhere."""

import asyncio
from pathlib import Path

import pytest
from starlette.requests import Request
from starlette.responses import PlainTextResponse

import dashboards
from dashboards.guard import MAX_BODY_BYTES, guard
from warehouse.editions.sheets import FORMULA

OWN = {"host": "127.0.0.1:3000", "origin": "http://127.0.0.1:3000"}
JSON = {"content-type": "application/json"}


def get_status(method, headers, content=b""):
    """The status by which an application behind the guard answers; it reads what is sent."""
    scope = {
        "type": "http",
        "scheme": "http",
        "method": method,
        "path": "/",
        "query_string": b"",
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
    }
    sent = []

    async def send(message):
        sent.append(message)

    async def receive():
        return {"type": "http.request", "body": content}

    async def echo(scope, receive, send):
        await PlainTextResponse(await Request(scope, receive).body())(scope, receive, send)

    asyncio.run(guard(echo, "127.0.0.1")(scope, receive, send))
    return sent[0]["status"]


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
def test_only_the_pages_own_requests_are_answered(method, headers, is_answered):
    length = {"content-length": "0"} if method == "POST" else {}
    status = get_status(method, headers | length)
    assert (status == 200) == is_answered
    assert status in (200, 400, 403)


def test_a_body_is_bounded():
    headers = OWN | JSON
    for told, status in ((MAX_BODY_BYTES, 200), (MAX_BODY_BYTES + 1, 413), ("-1", 413)):
        assert get_status("POST", headers | {"content-length": str(told)}) == status
    assert get_status("POST", headers | {"transfer-encoding": "chunked"}) == 413


def test_a_table_saved_from_a_page_holds_no_formula_either():
    text = (Path(dashboards.__file__).parent / "static" / "site.js").read_text("utf-8")
    assert f"/{FORMULA.pattern}/g" in text

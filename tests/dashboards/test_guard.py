"""Pages of other sites can neither read nor ask; what pages hand out does no harm elsewhere."""

import asyncio
from pathlib import Path

import pytest
from starlette.requests import Request
from starlette.responses import PlainTextResponse

import dashboards
from dashboards import guard
from dashboards.guard import Guard
from warehouse.editions.sheets import FORMULA

OWN = {"host": "127.0.0.1:3000", "origin": "http://127.0.0.1:3000"}
JSON = {"content-type": "application/json"}


@pytest.mark.parametrize(
    ("method", "path", "headers", "status"),
    [
        ("GET", "/", OWN, 200),
        *(
            ("GET", "/", {"host": host}, 403)
            for host in ("evil.example", "evil.example:80", "127.0.0.1.evil.example", "")
        ),
        ("GET", "/graphql", OWN, 200),
        ("GET", "/graphql?query=mutation", OWN, 403),
        ("GET", "/graphql?%71uery=mutation", OWN, 403),
        ("HEAD", "/graphql/?id=1", OWN, 403),
        ("POST", "/graphql", OWN | JSON, 200),
        ("POST", "/graphql", OWN | {"content-type": "text/plain"}, 403),
        ("POST", "/graphql", OWN | {"content-type": "application/x-www-form-urlencoded"}, 403),
        ("POST", "/graphql", OWN | JSON | {"origin": "http://evil.example"}, 403),
        ("POST", "/graphql", OWN | JSON | {"origin": "http://127.0.0.1:1"}, 403),
        ("POST", "/graphql", OWN | JSON | {"origin": "null"}, 403),
        ("POST", "/graphql", JSON | {"host": "127.0.0.1:3000"}, 200),  # Dagster's own client
    ],
)
def test_only_the_pages_own_requests_are_answered(method, path, headers, status):
    path, _, query = path.partition("?")
    scope = {
        "type": "http",
        "method": method,
        "path": path,
        "query_string": query.encode(),
        "headers": [(name.encode(), value.encode()) for name, value in headers.items()],
    }
    assert asyncio.run(answer(scope, [b""]))["status"] == status


async def answer(scope, parts):
    """How the response to a request begins; a body without end where a part is None."""
    sent, left = [], iter(parts)

    async def send(message):
        sent.append(message)

    async def receive():
        part = next(left, b"")
        if part is None:
            await asyncio.Event().wait()
        return {"type": "http.request", "body": part, "more_body": part != b""}

    async def echo(scope, receive, send):
        body = b"" if scope["method"] == "GET" else await Request(scope, receive).body()
        await PlainTextResponse(body)(scope, receive, send)

    await Guard(echo, "127.0.0.1")(scope, receive, send)
    return sent[0] | {"body": sent[1].get("body")}


def test_a_body_is_bounded_in_size_and_time(monkeypatch):
    monkeypatch.setattr(guard, "LONGEST_BODY_S", 0.1)
    sent = [(name.encode(), value.encode()) for name, value in (OWN | JSON).items()]
    scope = {
        "type": "http",
        "method": "POST",
        "path": "/save",
        "query_string": b"",
        "headers": sent,
    }
    part = bytes([1]) * (guard.LARGEST_BODY // 2)
    whole = asyncio.run(answer(scope, [part, part]))
    assert (whole["status"], whole["body"]) == (200, part + part)
    for parts, status in (([part, part, part], 413), ([part, None], 408)):
        refused = asyncio.run(answer(scope, parts))
        assert refused["status"] == status
        assert (b"connection", b"close") in refused["headers"]


def test_a_table_saved_from_a_page_holds_no_formula_either():
    text = (Path(dashboards.__file__).parent / "site/static/site.js").read_text("utf-8")
    assert f"/{FORMULA.pattern}/g" in text
    assert '/[",;\\n\\r]/' in text  # quoted, whichever separator a spreadsheet takes

"""Pages of other sites can neither read nor ask; what pages hand out does no harm elsewhere."""

import asyncio
from pathlib import Path

import pytest
from starlette.responses import PlainTextResponse

from herijk import dashboards
from herijk.dashboards.guard import Guard
from herijk.warehouse.editions.sheets import FORMULA

OWN = {"host": "127.0.0.1:3000", "origin": "http://127.0.0.1:3000"}
JSON = {"content-type": "application/json"}


@pytest.mark.parametrize(
    ("method", "path", "headers", "status"),
    [
        ("GET", "/", OWN, 200),
        ("GET", "/", {"host": "evil.example"}, 403),
        ("GET", "/graphql", OWN, 200),
        ("GET", "/graphql?query=mutation", OWN, 403),
        ("GET", "/graphql?%71uery=mutation", OWN, 403),
        ("HEAD", "/graphql/?id=1", OWN, 403),
        ("POST", "/graphql", OWN | JSON, 200),
        ("POST", "/graphql", OWN | {"content-type": "text/plain"}, 403),
        ("POST", "/graphql", OWN | JSON | {"origin": "http://evil.example"}, 403),
        ("POST", "/graphql", JSON | {"host": "127.0.0.1:3000"}, 403),
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
    sent = []

    async def send(message):
        sent.append(message)

    asyncio.run(Guard(PlainTextResponse("ok"), "127.0.0.1")(scope, None, send))
    assert sent[0]["status"] == status


@pytest.mark.parametrize("script", ["site/static/site.js", "workbench/static/tables.js"])
def test_a_table_saved_from_a_page_holds_no_formula_either(script):
    text = (Path(dashboards.__file__).parent / script).read_text("utf-8")
    assert f"/{FORMULA.pattern}/g" in text
    assert '/[",;\\n\\r]/' in text  # quoted, whichever separator a spreadsheet takes

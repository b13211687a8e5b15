"""The command, run in this process; what it prints as JSON is held against its schema."""

import json
import sys

import jsonschema
import pytest

from herijk.cli.json_schemas import schema_of, schemas
from herijk.cli.main import main
from tests.warehouse.conftest import edition_archive, published

__all__ = ["edition_archive", "published"]


def _closed(schema):
    """The same schema, without room for fields that it does not name."""
    if not isinstance(schema, dict):
        return schema
    inner = {
        key: {name: _closed(field) for name, field in value.items()}
        if key == "properties"
        else _closed(value)
        for key, value in schema.items()
    }
    named = schema.get("properties")
    return {"additionalProperties": False, **inner} if named else inner


def hold_against_schema(arguments, printed):
    """Fails where a result has another form than `herijk schema` says."""
    name = next(n for n in (" ".join(arguments[:2]), arguments[0]) if n in schemas())
    jsonschema.validate(json.loads(printed), _closed(schema_of(name)))


@pytest.fixture
def herijk(monkeypatch, capsys):
    """Runs the command in this process; gives exit status, stdout and stderr."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["herijk", *map(str, arguments)])
        capsys.readouterr()
        try:
            main()
        except SystemExit as stop:
            status = stop.code or 0
        else:
            status = 0
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        if "--json" in arguments and printed.out:
            hold_against_schema([*map(str, arguments)], printed.out)
        return status, printed.out, printed.err

    return run

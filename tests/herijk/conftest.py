"""The command, run in this process; what it prints as JSON is held against its documented form."""

import json
import sys
from dataclasses import fields

import pytest
from pydantic import TypeAdapter

from dashboards.statements import Said
from herijk.cli.forms import FORMS, PLAIN
from herijk.cli.main import main
from tests.warehouse.conftest import edition_archive, published

__all__ = ["edition_archive", "published"]


def hold_against_form(command, printed):
    """Fails where a result has no form that is documented for its command."""
    result = json.loads(printed)
    told = result.pop("statements", None)
    forms = [form for call, form in FORMS.items() if call.split()[0] == command]
    (form,) = {form for form in forms if {field.name for field in fields(form)} == set(result)}
    TypeAdapter(form).validate_python(result)
    assert (told is None) == (form in PLAIN)
    TypeAdapter(list[Said]).validate_python(told or [])


@pytest.fixture
def herijk(monkeypatch, capsys):
    """Runs the command in this process; gives exit status, stdout and stderr."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["herijk", *map(str, arguments)])
        monkeypatch.setattr(sys.modules["__main__"], "__package__", "")  # not `python -m pytest`
        capsys.readouterr()
        with pytest.raises(SystemExit) as stopped:
            main()
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        if "--json" in arguments and printed.out:
            hold_against_form(arguments[0], printed.out)
        return stopped.value.code or 0, printed.out, printed.err

    return run

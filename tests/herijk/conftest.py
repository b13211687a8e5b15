"""The command, run in this process; the fields of its JSON are held against `docs/json.md`."""

import json
import re
import sys
from contextvars import copy_context

import pytest

from herijk.cli.main import main
from tests.architecture.repository import read
from tests.conftest import in_one_process, records_in_memory
from tests.warehouse.conftest import edition_archive, published

__all__ = ["edition_archive", "published"]

ROW = re.compile(r"^\| `herijk ([^`]+)` \| (.+?) \|$", re.MULTILINE)
FIELDS = {
    call: set(re.findall(r"`(\w+)`", cell)) for call, cell in ROW.findall(read("docs/json.md"))
}
"""The documented fields of what a call prints."""
STATEMENT = {"about", "kind", "verdict", "text"}


def hold_against_form(command, printed):
    """Fails where a result has other fields than are documented for its command."""
    result = json.loads(printed)
    for statement in result.pop("statements"):
        assert set(statement) == STATEMENT
    documented = [fields for call, fields in FIELDS.items() if call.split()[0] == command]
    assert set(result) in documented, command


@pytest.fixture
def herijk(monkeypatch, capsys):
    """Runs the command in this process; gives exit status, stdout and stderr.

    A rebuild works in a thread and keeps its records in memory, which takes a second, not five.
    """

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["herijk", *map(str, arguments)])
        monkeypatch.setattr(sys.modules["__main__"], "__package__", "")  # not `python -m pytest`
        capsys.readouterr()
        with in_one_process(), records_in_memory(), pytest.raises(SystemExit) as stopped:
            copy_context().run(main)  # it sets the language
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        if "--json" in arguments and printed.out:
            hold_against_form(arguments[0], printed.out)
        return stopped.value.code or 0, printed.out, printed.err

    return run

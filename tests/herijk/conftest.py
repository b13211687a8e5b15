"""The command, run in this process."""

import sys

import pytest

from herijk.cli.main import main


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
        return status, printed.out, printed.err

    return run

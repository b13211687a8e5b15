"""Archives with next to nothing in them: what can be said is said, and nothing falls over."""

import re
import sys

import pytest

from herijk.cli.main import main
from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from tests.conftest import Workbench

pytestmark = pytest.mark.more

TOW_LIST = "sleeplijsten/sleeplijst_2014.csv"
BOATS = "sloepregister/sloependata.csv"
METHODS = ["rebased", "as-published"]


@pytest.fixture(scope="module")
def one_tow(tmp_path_factory):
    """One tow of four runs, no races, no types."""
    root = tmp_path_factory.mktemp("one")
    bench = Workbench(root / "archive", root / "data")
    write_simulated_archive(bench.archive, simulate_world(WorldSettings((2014,), 1, 20, 3)))
    for file in (bench.archive / "wedstrijden").glob("*"):
        file.unlink()
    tow_list = bench.archive / TOW_LIST
    tow_list.write_text(
        tow_list.read_text("utf-8").replace("1,2,3,4,5,6", "1,3,4,6"), encoding="utf-8"
    )
    return bench


def without_runs(bench, runs):
    import gzip  # noqa: PLC0415

    (file,) = (bench.archive / "meetdata_2014").iterdir()
    is_packed = file.suffix == ".gz"
    data = gzip.decompress(file.read_bytes()) if is_packed else file.read_bytes()
    kept = re.sub(rb"(?m)^[%s][;,\t].*\n" % runs.encode(), b"", data)
    assert len(kept) < len(data)
    file.write_bytes(gzip.compress(kept, mtime=0) if is_packed else kept)


def test_one_tow_without_runs_that_are_not_asked_for_is_computed(one_tow, monkeypatch, capsys):
    without_runs(one_tow, "25")
    assert "1,3,4,6" in (one_tow.archive / TOW_LIST).read_text("utf-8")
    one_tow.rebuild(("as-published-2014", *METHODS), whole=True)  # counts runs at 120 %
    assert one_tow.table("tow_runs")["run"].to_list() == [1, 3, 4, 6]
    assert one_tow.table("curves")["runs_used"].max() == 4
    for command in (["register", "--due"], ["seasons"], ["audit", "FSN101"], ["verify"]):
        monkeypatch.setattr(sys, "argv", ["herijk", *command, "--data", str(one_tow.data)])
        with pytest.raises(SystemExit) as stopped:
            main()
        said = capsys.readouterr()
        assert "Traceback" not in said.err
        assert stopped.value.code in {0, None} or said.err.startswith("herijk: "), command

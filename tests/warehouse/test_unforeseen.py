"""What nobody foresaw costs one tow, one method or one page, and nothing else."""

import importlib
import sys
from contextlib import ExitStack, contextmanager
from unittest import mock

import polars as pl
import pytest
from polars.testing import assert_frame_equal

from herijk.simulate import WorldSettings, simulate_world
from herijk.simulate.archive_writer import write_simulated_archive
from pipeline.blocks.tows import Tows
from pipeline.recompute.computed import Computed
from tests.architecture.repository import PACKAGES
from tests.conftest import METHODS, Workbench, shared
from warehouse.archive.judgement import Judgement
from warehouse.derive import recomputing

pytestmark = pytest.mark.more

TINY = WorldSettings(seasons=(2010, 2014), tows_per_season=11, rate_hz=10, seed=5)
TOW = "2014-004"


def tows_in(value):
    """Whether a value that a function is given is about the tow."""
    if isinstance(value, pl.DataFrame):
        return "tow_id" in value.columns and TOW in value["tow_id"]
    if isinstance(value, Computed):
        return tows_in(value.tows)
    if isinstance(value, Tows):
        return tows_in(value.frame)
    if isinstance(value, dict):
        return value.get("tow_id") == TOW
    if isinstance(value, Judgement):
        return value.tow["tow_id"] == TOW
    return isinstance(value, list | tuple) and any(tows_in(part) for part in value)


@contextmanager
def failing(module, name, called):
    """Inside, a function raises where it works on the tow, wherever it was imported to."""
    function = getattr(importlib.import_module(module), name)

    def raises(*arguments, **named):
        if any(tows_in(value) for value in (*arguments, *named.values())):
            called.append(name)
            raise ZeroDivisionError(f"planted in {name}")
        return function(*arguments, **named)

    places = [
        other
        for other in list(sys.modules.values())
        if getattr(other, "__name__", "").startswith(PACKAGES)
        and other.__dict__.get(name) is function
    ]
    with ExitStack() as patched:
        for place in places:
            patched.enter_context(mock.patch.object(place, name, raises))
        yield


def _build(root):
    write_simulated_archive(root / "archive", simulate_world(TINY))
    Workbench(root / "archive", root / "data").rebuild()


@pytest.fixture(scope="module")
def tiny(tmp_path_factory):
    root = shared(tmp_path_factory, "tiny", _build)
    return Workbench(root / "archive", root / "data")


@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("warehouse.archive.plausibility", "_check_whole_tow"),
        ("pipeline.season_log.estimate", "estimate_season_factors"),
    ],
)
def test_a_failing_tow_is_set_aside_and_the_rest_goes_on(module, name, tiny, tmp_path):
    bench = Workbench(tiny.archive, tmp_path / "data")
    called = []
    with failing(module, name, called):
        report = bench.rebuild((METHODS[0], "rebased"))
    assert called
    faults = bench.table("quarantine")
    assert faults["tow_id"].to_list() == [TOW]
    assert faults["reason_code"].to_list() == ["unforeseen"]
    as_published = pl.col("method") == METHODS[0]
    numbers = ("tow_id", "a_kg_m", "b_m_s", "cw_kg_m")
    others = tiny.table("curves").filter(as_published, pl.col("tow_id") != TOW).select(numbers)
    assert_frame_equal(bench.table("curves").filter(as_published).select(numbers), others)
    (check,) = [c for c in report.checks if c.check == "nothing_unforeseen"]
    assert (check.passed, check.severity, check.found["first"]) == (False, "WARN", [TOW])


def test_a_failing_method_costs_its_rows_alone(tiny, tmp_path):
    bench = Workbench(tiny.archive, tmp_path / "data")

    def fails(method, *arguments, **named):
        if method.name == METHODS[1]:
            raise ZeroDivisionError("planted")
        return real(method, *arguments, **named)

    real = recomputing.recompute
    with mock.patch.object(recomputing, "recompute", fails):
        report = bench.rebuild()
    assert set(bench.table("curves")["method"]) == {METHODS[0]}
    assert_frame_equal(
        bench.table("curves"), tiny.table("curves").filter(method=METHODS[0]), rel_tol=1e-9
    )
    (check,) = [c for c in report.checks if c.check == "nothing_unforeseen"]
    assert (check.severity, check.found["first"]) == ("ERROR", [f"method {METHODS[1]}"])
    report = bench.rebuild()  # not tried again, and still told
    assert [c.severity for c in report.checks if not c.passed] == ["ERROR"]


def test_a_tow_is_tried_again_when_its_row_changes(tiny, tmp_path):
    bench = Workbench(tmp_path / "archive", tmp_path / "data")
    write_simulated_archive(bench.archive, simulate_world(TINY))
    with failing("pipeline.assessment.assess", "assess", []):
        bench.rebuild()
    assert bench.table("quarantine")["tow_id"].to_list() == [TOW]
    assert TOW not in bench.table("tows")["tow_id"]
    bench.rebuild()
    assert TOW not in bench.table("tows")["tow_id"]  # by the same code it would fail again
    tow_list = bench.archive / "sleeplijsten" / "sleeplijst_2014.csv"
    weight = tiny.table("tows").filter(tow_id=TOW)["weight_kg"][0]
    text = tow_list.read_text("utf-8")
    (line,) = (line for line in text.splitlines() if TOW in line)
    heavier = line.replace(f",{weight:.0f},", f",{weight + 1:.0f},", 1)
    assert heavier != line
    tow_list.write_text(text.replace(line, heavier), "utf-8")
    bench.rebuild()
    assert TOW in bench.table("tows")["tow_id"]

"""What starts a rebuild by itself: schedules and sensor; with real processes: `test_served`."""

import datetime as dt
import subprocess
import sys
from pathlib import Path

import dagster as dg
import pytest

from assets.automation import (
    ASK_AGAIN_S,
    TRIES,
    archive_sensor,
    rebuild_job,
    schedules,
)
from assets.definitions import build_defs, defs
from assets.settings import Settings
from tests.conftest import METHODS

ROOT = Path(__file__).parents[2]


@pytest.fixture
def archive(tmp_path):
    """A folder with three files; the sensor opens none."""
    for name in ("sleeplijsten/sleeplijst_2009.csv", "meetdata_2009/a.csv", "meetdata_2009/b.csv"):
        path = tmp_path / "archive" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("x")
    return tmp_path / "archive"


class Ticks:
    """The sensor, asked again and again with the cursor it gave."""

    def __init__(self, archive, instance):
        self.sensor, self.cursor = archive_sensor(archive, is_served=True), None
        self.instance = instance

    def tick(self):
        """How many rebuilds a tick asks for."""
        context = dg.build_sensor_context(self.instance, cursor=self.cursor)
        found = self.sensor.evaluate_tick(context)
        self.cursor = found.cursor or self.cursor
        self.requests = found.run_requests or []
        self.said = found.skip_message
        assert len(self.cursor or "") < 200  # it is kept for every tick
        return len(self.requests)


@pytest.fixture
def ticks(archive):
    """The sensor after it saw the archive for the first time."""
    with dg.DagsterInstance.ephemeral() as instance:
        found = Ticks(archive, instance)
        assert found.tick() == 0
        assert found.tick() == 1
        yield found


@pytest.mark.parametrize(
    "change",
    [
        lambda root: (root / "meetdata_2009/c.csv").write_text("y"),
        lambda root: (root / "meetdata_2009/a.csv").write_text("mended"),
        lambda root: (root / "meetdata_2009/b.csv").unlink(),
    ],
    ids=["came", "changed", "went"],
)
def test_a_file_that_came_changed_or_went_asks_for_one_rebuild(ticks, archive, change):
    assert ticks.tick() == 0
    assert ticks.said == "no file of the archive changed"
    change(archive)
    assert ticks.tick() == 0
    assert "waiting until the archive is left alone" in ticks.said
    assert ticks.tick() == 1
    assert ticks.tick() == 0


def test_while_files_are_copied_nothing_is_asked(ticks, archive):
    for number in range(3):
        (archive / f"meetdata_2009/new{number}.csv").write_text("z")
        assert ticks.tick() == 0
    assert ticks.tick() == 1


def test_an_archive_whose_disk_is_gone_asks_for_nothing(ticks, archive):
    archive.rename(archive.with_name("away"))
    assert ticks.tick() == 0
    assert "is its disk there?" in ticks.said
    archive.with_name("away").rename(archive)
    assert ticks.tick() == 0
    assert ticks.said == "no file of the archive changed"


def test_a_change_stays_open_until_a_run_succeeded(ticks, archive, monkeypatch):
    (archive / "meetdata_2009/c.csv").write_text("y")
    assert (ticks.tick(), ticks.tick()) == (0, 1)
    (request,) = ticks.requests
    clock = dt.datetime(2026, 11, 21, 3, tzinfo=dt.UTC).timestamp()
    monkeypatch.setattr("time.time", lambda: clock)
    run = ticks.instance.create_run_for_job(rebuild_job, tags=request.tags)
    assert ticks.tick() == 0  # it is in the queue
    ticks.instance.report_run_failed(run)
    assert ticks.tick() == 0
    clock += ASK_AGAIN_S + 1
    assert ticks.tick() == 1
    run = ticks.instance.create_run_for_job(rebuild_job, tags=ticks.requests[0].tags)
    ticks.instance.handle_new_event(_ended_well(run))
    clock += ASK_AGAIN_S + 1
    assert ticks.tick() == 0


def _ended_well(run):
    event = dg.DagsterEvent(dg.DagsterEventType.RUN_SUCCESS.value, run.job_name)
    return dg.EventLogEntry(None, "info", "", run.run_id, 0.0, dagster_event=event)


def test_a_run_whose_archive_is_away_is_tried_again(tmp_path, monkeypatch):
    monkeypatch.setattr("assets.automation.TRY_AGAIN_S", 0)
    location = build_defs(str(tmp_path / "gone"), str(tmp_path / "data"), Settings(methods=METHODS))
    with dg.DagsterInstance.ephemeral() as instance:
        result = location.resolve_job_def("rebuild").execute_in_process(
            instance=instance, raise_on_error=False
        )
    assert len([e for e in result.all_events if e.event_type_value == "STEP_UP_FOR_RETRY"]) == TRIES


def test_hidden_files_and_links_are_not_followed(ticks, archive, tmp_path):
    (archive / ".lock").write_text("")
    assert ticks.tick() == 0
    assert ticks.said == "no file of the archive changed"


def test_a_night_without_a_change_does_no_work_and_says_so(bench):
    """The job itself, as the schedule runs it."""
    bench.rebuild()
    before = bench.lake_files(), bench.store.database.stat().st_mtime_ns
    location = build_defs(str(bench.archive), str(bench.data), Settings(methods=METHODS))
    with dg.DagsterInstance.ephemeral() as instance, bench.records_in_memory():
        result = location.resolve_job_def("rebuild").execute_in_process(instance=instance)
    (output,) = [e for e in result.all_events if e.event_type_value == "STEP_OUTPUT"]
    said = output.step_output_data.metadata
    assert said["nothing_changed"].value is True
    assert said["headlines"].value == ["Nothing changed since the last report."]
    assert (bench.lake_files(), bench.store.database.stat().st_mtime_ns) == before


def test_schedules_run_the_rebuild_at_night_and_in_the_season():
    settings = Settings(campaign="0 12 * 4-9 *", timezone="Europe/Amsterdam")
    nightly, campaign = schedules(settings, is_served=True)
    assert (nightly.job_name, campaign.job_name) == ("rebuild", "rebuild")
    when = dt.datetime(2026, 5, 8, 12, tzinfo=dt.UTC)
    with dg.DagsterInstance.ephemeral() as instance:
        context = dg.build_schedule_context(instance, scheduled_execution_time=when)
        (request,) = campaign.evaluate_tick(context).run_requests
        (night,) = nightly.evaluate_tick(context).run_requests
    assert request.run_config["ops"]["rebuild_archive"]["config"] == {"seasons": [2026]}
    assert night.run_config == {}


def test_no_job_publishes():
    """The code that publishes is not even loaded where jobs run."""
    jobs = {job.name for job in defs.resolve_all_job_defs()} - {"__ASSET_JOB"}
    assert jobs == {"rebuild"}
    found = subprocess.run(
        [sys.executable, "-c", "import assets.definitions, sys; print(*sys.modules)"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    loaded = found.stdout.split()
    assert "warehouse.editions.verify" in loaded
    assert "warehouse.editions.publish" not in loaded

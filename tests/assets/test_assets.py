"""Assets as Dagster sees them: what is stale, what its page can make, and what is mended."""

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import dagster as dg
import polars as pl
import pytest
from polars.testing import assert_frame_equal

import assets.instance
from assets.checks import EQUAL
from assets.definitions import ASSETS, build_defs
from pipeline.register.register import choose_default_method
from tests.assets.page import page
from tests.assets.test_rebuild import assert_same_tables, list_samples_files, spoil
from tests.conftest import METHODS, Workbench, in_one_process
from warehouse.intake.seasons import INDEXED
from warehouse.store.store import Store

ROOT = Path(__file__).parents[2]
QUIET_LOG = {"loggers": {"console": {"config": {"log_level": "CRITICAL"}}}}
EVERY = sorted(key.to_user_string() for asset in ASSETS for key in asset.keys)


@pytest.fixture
def instance(tmp_path):
    """Records of Dagster that last as long as the test."""
    (tmp_path / "records").mkdir()
    with dg.DagsterInstance.local_temp(str(tmp_path / "records")) as instance:
        yield instance


def materialise(bench, instance, *names, retry=False):
    """What a person does from Dagster's page, or by `dagster asset materialize --select`."""
    location = build_defs(str(bench.archive), str(bench.data), list(METHODS))
    with in_one_process():
        return location.resolve_implicit_global_asset_job_def().execute_in_process(
            instance=instance,
            asset_selection=[dg.AssetKey(name) for name in names],
            run_config=QUIET_LOG,
            raise_on_error=not retry,
        )


STALENESS = "query { assetNodes { assetKey { path } isMaterializable staleStatus } }"


@pytest.mark.slow
def test_after_a_run_dagster_calls_nothing_stale_and_after_a_change_what_reads_it(bench, instance):
    def stale(ask):
        nodes = ask(STALENESS)["assetNodes"]
        said = {n["assetKey"]["path"][0]: n["staleStatus"] for n in nodes if n["isMaterializable"]}
        assert said.keys() == set(EVERY)
        assert "MISSING" not in said.values()
        return {name for name, status in said.items() if status == "STALE"}

    folders = {"HERIJK_ARCHIVE": str(bench.archive), "HERIJK_DATA": str(bench.data)}
    assert materialise(bench, instance, *EVERY).success
    command = ("dagster_webserver", "--python-file", "assets/definitions.py")
    with page(*command, home=instance.root_directory, **folders) as ask:
        assert stale(ask) == set()
        spoil(list_samples_files(bench, 2009)[3])
        assert materialise(bench, instance, *INDEXED).success
        assert {"samples", "read_tows", "register"} <= stale(ask)
        assert materialise(bench, instance, *EVERY).success
        assert stale(ask) == set()


@pytest.mark.more
@pytest.mark.parametrize("name", ["type_consistency", "curves", "site"])
def test_an_asset_can_be_made_alone(name, bench, built, instance):
    bench.store.table_path(name).unlink()
    assert materialise(bench, instance, name).success
    if name in built.tables():
        assert_frame_equal(bench.store.read(name), built.store.read(name))


@pytest.mark.more
def test_a_damaged_table_is_made_again_by_a_second_run(bench, built, instance):
    path = bench.store.table_path("tows")
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    bench.store.table_path("register").unlink()
    assert not materialise(bench, instance, "register", retry=True).success
    assert not path.exists()
    assert materialise(bench, instance, "tows", "register").success
    assert_frame_equal(bench.store.read("tows"), built.store.read("tows"))
    assert_frame_equal(bench.store.read("register"), built.store.read("register"))


def test_a_run_on_schedule_that_fails_begins_once_again():
    tags = build_defs("archive", "data", []).resolve_job_def("rebuild").tags
    assert tags["dagster/max_retries"] == "1"
    assert tags["dagster/retry_on_asset_or_op_failure"] == "true"


def test_checks_of_the_last_rebuild_are_shown_on_the_assets(bench, instance):
    result = materialise(bench, instance, "check_results", "quarantine")
    shown = {one.check_name: one for one in result.get_asset_check_evaluations()}
    stored = {row["check"]: row for row in bench.store.read("check_results").to_dicts()}
    assert {"archive_without_faults", "every_listed_tow_accounted_for"} <= shown.keys()
    for name in shown.keys() & stored.keys():
        assert shown[name].passed == (stored[name]["number"] == 0)


def test_verdicts_on_types_are_shown_on_their_table(bench, instance):
    result = materialise(bench, instance, "type_consistency")
    shown = {one.check_name: one for one in result.get_asset_check_evaluations()}
    verdicts = bench.store.read("type_consistency").filter(method=choose_default_method(METHODS))
    assert "differ" in verdicts["verdict"].to_list()
    for name, quantity in EQUAL.items():
        own = dict(verdicts.filter(quantity=quantity).select("boat_type", "verdict").rows())
        assert shown[name].passed == ("differ" not in own.values())
        assert {t: shown[name].metadata[t].value for t in own} == own


@pytest.mark.more
def test_what_matters_is_set_by_the_federation_and_decides_the_verdict(bench, instance):
    before = bench.store.read("type_consistency")
    (bench.data / "beheer.toml").write_text("difference_cw = 0.9\n")
    assert materialise(bench, instance, "differences_that_matter", "type_consistency").success
    after = bench.store.read("type_consistency")
    cw = after.filter(quantity="cw_standard_kg_m")
    assert cw["difference_that_matters"].unique().to_list() == [0.9]
    judged = cw.filter(pl.col("spread_hi") < 0.9)
    assert judged.height
    assert set(judged["verdict"]) == {"equal"}
    b = pl.col("quantity") == "b_m_s"
    assert_frame_equal(after.filter(b), before.filter(b))


def test_records_are_kept_where_dagster_home_says(bench, tmp_path, monkeypatch):
    monkeypatch.setenv("DAGSTER_HOME", str(tmp_path / "home"))
    with assets.instance.open_instance(bench.store) as instance:
        assert instance.root_directory == str(tmp_path / "home")
    assert (tmp_path / "home" / "dagster.yaml").exists()
    assert not (bench.data / "dagster").exists() or list((bench.data / "dagster").iterdir())


def test_a_server_works_on_its_own_folders_alone(bench, instance, tmp_path, monkeypatch):
    for name, value in (
        ("HERIJK_SITE", "http://127.0.0.1:3001/site"),
        ("HERIJK_ARCHIVE", str(bench.archive)),
        ("HERIJK_DATA", str(bench.data)),
    ):
        monkeypatch.setenv(name, value)
    assert materialise(bench, instance, "era_shifts").success
    with pytest.raises(dg.DagsterError, match="Error executing resource_fn"):
        materialise(Workbench(bench.archive, tmp_path / "other"), instance, "era_shifts")
    assert not (tmp_path / "other").exists()


@contextmanager
def dask_cluster(folder):
    """A scheduler and two workers, in another folder; gives its address and the workers."""
    scheduler_file = folder / "scheduler.json"
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    here = ("--scheduler-file", str(scheduler_file))
    commands = [
        ("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"),
        *2 * [("distributed.cli.dask_worker", "--nthreads", "1", "--no-nanny", "--no-dashboard")],
    ]
    processes = [
        subprocess.Popen([sys.executable, "-m", *command, *here], cwd=folder, env=environment)
        for command in commands
    ]
    try:
        from distributed import Client  # noqa: PLC0415 - takes seconds to import

        while not scheduler_file.exists():
            time.sleep(0.1)
        with Client(scheduler_file=str(scheduler_file)) as client:
            client.wait_for_workers(2)
            yield client.scheduler.address, processes[1:]
    finally:
        for process in processes:
            process.kill()
            process.wait()


@pytest.mark.slow
def test_dask_workers_read_an_archive_although_one_is_killed(built, tmp_path):
    """The command names its folders relative to its own folder; the workers are in another."""
    bench = Workbench(built.archive, tmp_path / "data")
    bench.data.mkdir()
    (tmp_path / "cluster").mkdir()
    names = [part for name in METHODS for part in ("--method", name)]
    with dask_cluster(tmp_path / "cluster") as (address, workers):
        (bench.data / "beheer.toml").write_text(f'dask = "{address}"\n')
        archive = os.path.relpath(bench.archive, tmp_path)
        command = [sys.executable, "-m", "herijk", "rebuild", "--archive", archive, *names]
        run = subprocess.Popen(command, cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)})
        samples = bench.data / "lake" / "samples"
        while run.poll() is None and not list(samples.rglob("[!.]*.parquet")):
            time.sleep(0.05)
        workers[0].send_signal(signal.SIGKILL)
        assert run.wait(500) == 0
    found = {name: frame for name, frame in bench.tables().items() if name != "about"}
    expected = {name: frame for name, frame in built.tables().items() if name != "about"}
    assert_same_tables(found, expected)
    assert Store(bench.data).read_fingerprint("site") is not None

"""Assets as Dagster sees them: what is stale, what its page can make, and what is mended."""

import os
import shutil
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path

import assets.tables
import dagster as dg
import pytest
import warehouse.derive.step
from assets.resources import Setup
from polars.testing import assert_frame_equal
from warehouse.derive.graph import STEPS

import assets.instance
import assets.run
from assets.run import QUIET_LOG, assets_of
from pipeline.errors import MissingKnowledgeError
from pipeline.tables.schemas import TABLES
from tests.assets.page import page
from tests.assets.test_rebuild import (
    assert_same_tables,
    samples_files,
    spoil,
)
from tests.conftest import METHODS, SMALL, Workbench, in_one_process
from warehouse.intake import seasons as intake
from warehouse.store.methods import KnownMethods

ROOT = Path(__file__).parents[2]
PAGE = ("dagster_webserver", "--python-file")


@pytest.fixture
def instance(monkeypatch, tmp_path):
    """Records of Dagster that last as long as the test."""
    (tmp_path / "records").mkdir()
    with dg.DagsterInstance.local_temp(str(tmp_path / "records")) as instance:
        monkeypatch.setattr(Workbench, "records_in_memory", staticmethod(nullcontext))
        monkeypatch.setattr(assets.instance, "instance_of", lambda _: nullcontext(instance))
        yield instance


def materialise(bench, instance, *assets, season=None):
    """What a person does from Dagster's page."""
    setup = Setup(archive=str(bench.archive), data=str(bench.data), methods=list(METHODS))
    instance.add_dynamic_partitions("season", list(map(str, SMALL.seasons)))
    job = assets_of(setup).resolve_implicit_global_asset_job_def()
    with in_one_process():
        return job.execute_in_process(
            instance=instance,
            asset_selection=[dg.AssetKey(name) for name in assets],
            partition_key=None if season is None else str(season),
            run_config=QUIET_LOG,
        )


STALENESS = """query ($seasons: [String!]!) {
  whole: assetNodes { assetKey { path } isMaterializable isPartitioned staleStatus }
  bySeason: assetNodes(assetKeys: [{path: "samples"}, {path: "blocks"}]) {
    assetKey { path }
    staleStatusByPartition(partitions: $seasons)
  }
}"""


def stale_in_dagster(ask):
    """Assets, or seasons of them, that Dagster's page calls stale."""
    seasons = list(map(str, SMALL.seasons))
    answer = ask(STALENESS, seasons=seasons)
    said = {
        (*node["assetKey"]["path"], None): node["staleStatus"]
        for node in answer["whole"]
        if node["isMaterializable"] and not node["isPartitioned"]
    }
    for node in answer["bySeason"]:
        by_season = zip(seasons, node["staleStatusByPartition"], strict=True)
        said |= {(*node["assetKey"]["path"], season): status for season, status in by_season}
    assert len(said) > len(TABLES)
    assert "MISSING" not in said.values()
    return {of for of, status in said.items() if status == "STALE"}


def stale_to_us(bench):
    """The same by fingerprints."""
    store = bench.store
    known = [KnownMethods.of(store).get(name) for name in METHODS]
    seasons = {("samples", str(s)) for s in intake.stale_seasons(store, bench.archive)}
    return seasons | {
        (name, None) for step in STEPS if step.stale(store, known) for name in step.outputs
    }


def other_race(bench):
    (path, *_) = sorted((bench.archive / "wedstrijden").iterdir())
    first, *rest = path.read_text("utf-8").splitlines()
    path.write_text("\n".join([first, *rest[1:]]), "utf-8")


@pytest.mark.slow
def test_what_dagster_calls_stale_has_all_that_is_and_nothing_after_a_rebuild(
    bench, instance, monkeypatch
):
    def new_code(_):
        for module in (warehouse.derive.step, assets.tables):
            monkeypatch.setattr(module, "code_hash", lambda *_: "other")
        steps = [assets.tables.step_asset(step) for step in (*STEPS, assets.tables.SITE)]
        kept = [a for a in assets.run.ASSETS if a not in assets.tables.STEP_ASSETS]
        monkeypatch.setattr(assets.run, "ASSETS", [*kept, *steps])

    def agrees_after(change, ask):
        change(bench)
        materialise(bench, instance, *intake.INDEXED)
        ours = stale_to_us(bench)
        assert ours
        assert ours <= stale_in_dagster(ask)
        bench.rebuild(whole=True)
        assert stale_in_dagster(ask) == set()
        assert stale_to_us(bench) == set()

    bench.store.database.unlink()
    shutil.rmtree(bench.data / "lake")
    bench.rebuild(whole=True)
    with page(*PAGE, "assets/definitions.py", home=instance.root_directory) as ask:
        assert stale_in_dagster(ask) == set()
        agrees_after(lambda bench: spoil(samples_files(bench, 2009)[3]), ask)
        agrees_after(other_race, ask)
    with page(*PAGE, "tests/assets/other_code.py", home=instance.root_directory) as ask:
        agrees_after(new_code, ask)


@pytest.mark.more
def test_a_season_is_made_from_dagsters_page_and_what_follows_too(bench, built, instance, tmp_path):
    fresh = Workbench(bench.archive, tmp_path / "fresh")
    materialise(fresh, instance, *intake.INDEXED)
    assert materialise(fresh, instance, "samples", "blocks", season=2009).success
    assert fresh.store.partitions("blocks") == ["2009"]
    following = [name for step in STEPS[:3] for name in step.outputs]
    assert materialise(fresh, instance, *following).success
    of_2009 = built.store.read("tows").filter(season=2009)["tow_id"]
    assert fresh.store.read("tows")["tow_id"].equals(of_2009)


def test_a_damaged_table_that_an_asset_reads_is_made_again(bench, built, instance):
    path = bench.store.table_path("tows")
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])
    bench.store.table_path("curves", METHODS[0]).unlink()
    assert materialise(bench, instance, *STEPS[2].outputs).success
    assert_frame_equal(bench.store.read("tows"), built.store.read("tows"))
    assert bench.store.read("curves", METHODS[0]).equals(built.store.read("curves", METHODS[0]))


def test_records_are_kept_where_dagster_home_says(bench, tmp_path, monkeypatch):
    monkeypatch.setenv("DAGSTER_HOME", str(tmp_path / "home"))
    with assets.instance.instance_of(bench.store) as instance:
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
    with pytest.raises(dg.DagsterError) as refused:
        materialise(Workbench(bench.archive, tmp_path / "other"), instance, "era_shifts")
    assert isinstance(refused.value.__cause__, MissingKnowledgeError)
    assert not (tmp_path / "other").exists()


@pytest.mark.slow
def test_two_workers_of_a_dask_cluster_make_the_same_tables(built, tmp_path):
    bench = Workbench(built.archive, tmp_path / "data")
    bench.data.mkdir()
    from distributed import LocalCluster  # noqa: PLC0415 - takes seconds to import

    here = {"host": "127.0.0.1", "dashboard_address": None, "local_directory": tmp_path / "dask"}
    with LocalCluster(n_workers=2, threads_per_worker=1, **here) as cluster:
        (bench.data / "beheer.toml").write_text(f'dask = "{cluster.scheduler_address}"\n')
        names = [part for name in METHODS for part in ("--method", name)]
        done = subprocess.run(
            [
                *(sys.executable, "-m", "herijk", "rebuild", *names),
                *("--archive", str(bench.archive), "--data", str(bench.data)),
            ],
            cwd=ROOT, env=os.environ | {"LC_ALL": "C"}, check=False, capture_output=True, text=True,
        )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert_same_tables(
        {n: f for n, f in bench.tables().items() if n != "warehouse_database"}, built.tables()
    )

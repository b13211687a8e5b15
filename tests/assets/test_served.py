"""`herijk serve` as people use it: its processes, its page, and what the daemon does by itself."""

import shutil

import pytest
from warehouse.derive.inputs import ARCHIVE_TABLES

from tests.assets.page import page, wait_for
from tests.conftest import METHODS

RUNS = "{runsOrError {... on Runs {results {jobName status}}}}"
BACKFILL = """mutation ($what: LaunchBackfillParams!) {
  launchPartitionBackfill(backfillParams: $what) {... on LaunchBackfillSuccess {backfillId}}
}"""
BACKFILLED = """query ($backfillId: String!) {
  partitionBackfillOrError(backfillId: $backfillId) {... on PartitionBackfill {status}}
}"""


def lose(bench, season):
    """Takes away what was made of a season."""
    for kind in ("samples", "blocks"):
        shutil.rmtree(bench.data / "lake" / kind / f"season={season}")
    for table in (f"season_index/{season}", f"blocks/{season}", "tows"):
        (bench.data / "lake" / "tables" / f"{table}.parquet").unlink()


@pytest.mark.slow
def test_a_rebuild_begins_by_itself_and_a_season_is_backfilled_with_what_follows(bench, built):
    (bench.data / "beheer.toml").write_text(f"methods = {list(METHODS)}")
    lose(bench, 2014)
    folders = ("--archive", str(bench.archive), "--data", str(bench.data))
    done, ended = {"jobName": "rebuild", "status": "SUCCESS"}, {"status": "COMPLETED_SUCCESS"}
    with page("herijk", "serve", *folders, "--may-start") as ask:
        wait_for(lambda: done in ask(RUNS)["runsOrError"]["results"])
        lose(bench, 2009)
        names = ("samples", "blocks", *ARCHIVE_TABLES)
        what = {"assetSelection": [{"path": [name]} for name in names], "partitionNames": ["2009"]}
        begun = ask(BACKFILL, what=what)["launchPartitionBackfill"]
        wait_for(lambda: ask(BACKFILLED, **begun)["partitionBackfillOrError"] == ended)
    assert bench.lake_files().keys() == built.lake_files().keys()
    assert bench.store.read("tows").equals(built.store.read("tows"))

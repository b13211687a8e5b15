"""`herijk serve` as people use it: its processes, its page, and what the daemon does by itself."""

import shutil

import pytest

from tests.assets.page import page, wait_for
from tests.conftest import METHODS

RUNS = "{runsOrError {... on Runs {results {jobName status}}}}"
LAUNCH = """mutation ($what: ExecutionParams!) {
  launchRun(executionParams: $what) {... on LaunchRunSuccess {run {runId}}
                                     ... on UnauthorizedError {message}}
}"""


def lose(bench, season):
    """Take away what was made of a season."""
    for kind in ("samples", "blocks"):
        shutil.rmtree(bench.data / "lake" / kind / f"season={season}")
    bench.store.table_path("tows").unlink()


def job(selection):
    """What Dagster's page sends to start a run of some assets."""
    where = {"repositoryName": "__repository__", "repositoryLocationName": "assets.definitions"}
    assets = [{"path": [name]} for name in selection]
    selector = where | {"jobName": "rebuild", "assetSelection": assets}
    return {"selector": selector, "runConfigData": {}, "mode": "default"}


@pytest.mark.slow
def test_a_rebuild_begins_by_itself_and_assets_are_made_from_the_page(bench, built):
    (bench.data / "beheer.toml").write_text(f"methods = {list(METHODS)}")
    lose(bench, 2014)
    folders = ("--archive", str(bench.archive), "--data", str(bench.data))
    done = {"jobName": "rebuild", "status": "SUCCESS"}
    with page("herijk", "serve", *folders, "--may-start") as ask:
        wait_for(lambda: ask(RUNS)["runsOrError"]["results"] == [done])
        lose(bench, 2009)
        assert "runId" in str(ask(LAUNCH, what=job(["samples", "blocks", "tows"])))
        wait_for(lambda: ask(RUNS)["runsOrError"]["results"] == [done, done])
    assert bench.lake_files().keys() == built.lake_files().keys()
    assert bench.store.read("tows").equals(built.store.read("tows"))


@pytest.mark.more
def test_the_page_is_read_only_unless_asked_otherwise(bench):
    folders = ("--archive", str(bench.archive), "--data", str(bench.data))
    with page("herijk", "serve", *folders) as ask:
        assert "runId" not in str(ask(LAUNCH, what=job(["tows"])))

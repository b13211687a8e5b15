"""The same jobs step by step in processes of their own give the tables of one process."""

import dagster as dg
import pytest
from herijk.assets.runs import prepare_home

from herijk.assets import checks
from herijk.assets.definitions import build_defs
from herijk.assets.settings import Settings
from herijk.warehouse.build.graph import STEPS
from tests.assets.test_rebuild import assert_same_tables
from tests.conftest import METHODS, SMALL, Workbench

PRELOADED = [
    *(__name__, "herijk.dashboards.site.render", "scipy.optimize"),
    *("dagster._core.storage.sqlite_storage", "dagster._utils.test", "upath.implementations.local"),
]
FORKED = {
    "execution": {
        "config": {"multiprocess": {"start_method": {"forkserver": {"preload_modules": PRELOADED}}}}
    }
}
"""Each step in a process forked from one that has imported everything: no import per step."""


def job_of(archive: str, data: str, *assets: str) -> dg.JobDefinition:
    """A job of some assets of two folders; loaded again in every process."""
    selection = dg.AssetSelection.assets(*assets) - dg.AssetSelection.checks(*checks.ALL)
    job = dg.Definitions(jobs=[dg.define_asset_job("some", selection)])
    defs = build_defs(archive, data, Settings(methods=METHODS))
    return dg.Definitions.merge(defs, job).resolve_job_def("some")


@pytest.mark.slow
def test_the_multiprocess_executor_gives_identical_tables(built, tmp_path, monkeypatch):
    bench = Workbench(built.archive, tmp_path / "data")
    home = prepare_home(bench.store)
    monkeypatch.setenv("DAGSTER_HOME", str(home))
    steps = [
        (("archive_index",), None),
        *((("samples", "blocks"), str(season)) for season in SMALL.seasons),
        *(
            (step.outputs, partition)
            for step in STEPS
            for partition in (METHODS if step.per_method else (None,))
        ),
        (("site",), None),
    ]
    with dg.DagsterInstance.from_config(str(home)) as instance:
        instance.add_dynamic_partitions("season", [str(season) for season in SMALL.seasons])
        instance.add_dynamic_partitions("method", list(METHODS))
        for assets, partition in steps:
            job = dg.build_reconstructable_job(
                "tests.assets.test_executors",
                "job_of",
                (str(bench.archive), str(bench.data), *assets),
            )
            tags = {} if partition is None else {"dagster/partition": partition}
            result = dg.execute_job(job, instance, run_config=FORKED, tags=tags)
            assert result.success
            assert {e.event_type_value for e in result.all_events} >= {"STEP_WORKER_STARTED"}
    assert_same_tables(bench.tables(), built.tables())

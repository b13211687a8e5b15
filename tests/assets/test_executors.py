"""The same jobs step by step in processes of their own give the tables of one process."""

import dagster as dg
import pytest

from herijk.assets.jobs import BUILD_JOBS, INDEX, READ, SITE, job_defs
from herijk.assets.progress import Quiet
from herijk.assets.resources import Setup
from herijk.assets.runs import prepare_home
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


def repository_of(archive: str, data: str) -> dg.Definitions:
    """The jobs for two folders; loaded again in every process."""
    return job_defs(Setup(archive=archive, data=data, methods=list(METHODS)), Quiet())


def job_of(archive: str, data: str, name: str) -> dg.JobDefinition:
    """One of the jobs."""
    return repository_of(archive, data).resolve_job_def(name)


@pytest.mark.slow
def test_the_multiprocess_executor_gives_identical_tables(built, tmp_path, monkeypatch):
    bench = Workbench(built.archive, tmp_path / "data")
    home = prepare_home(bench.store)
    monkeypatch.setenv("DAGSTER_HOME", str(home))
    steps = [
        (INDEX, None),
        *((READ, str(season)) for season in SMALL.seasons),
        *(
            (job, partition)
            for step, job in BUILD_JOBS.items()
            for partition in (METHODS if step.per_method else (None,))
        ),
        (SITE, None),
    ]
    with dg.DagsterInstance.from_config(str(home)) as instance:
        instance.add_dynamic_partitions("season", [str(season) for season in SMALL.seasons])
        instance.add_dynamic_partitions("method", list(METHODS))
        for name, partition in steps:
            job = dg.build_reconstructable_job(
                "tests.assets.test_executors", "job_of", (str(bench.archive), str(bench.data), name)
            )
            tags = {} if partition is None else {"dagster/partition": partition}
            result = dg.execute_job(job, instance, run_config=FORKED, tags=tags)
            assert result.success
            assert {e.event_type_value for e in result.all_events} >= {"STEP_WORKER_STARTED"}
    assert_same_tables(bench.tables(), built.tables())

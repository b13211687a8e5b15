"""When a rebuild happens without anybody asking: every night, in the season, on a changed archive.

The job runs the same rebuild as the command. It makes drafts; publishing is not among the jobs.
"""

import time
from pathlib import Path
from typing import Any

import dagster as dg
from pydantic import Field

from assets.notify import Notifier
from assets.rebuild import rebuild
from assets.report import failed_checks, tell, tell_failure
from assets.resources import LogProgress, Setup
from assets.settings import Settings
from pipeline.errors import (
    HerijkError,
    MissingKnowledgeError,
    UnavailableError,
    unexpected,
)
from warehouse.intake.seasons import listing
from warehouse.store.store import fingerprint

ONE_AT_A_TIME = {"herijk/rebuild": "data folder"}
"""The tag of which one run at a time is started (see `INSTANCE_SETTINGS`)."""

LONGEST_S = 12 * 3600
"""A run that takes longer hangs, and is ended so that the next can begin."""

LISTING = "herijk/listing"
"""The tag of a run that the sensor asked for: the digest of the listing that it saw."""

ASK_AGAIN_S = 3600
"""A change of which the run failed is asked for again so long after it."""

TRY_AGAIN_S = 300
TRIES = 3


class Which(dg.Config):
    """Seasons to read; none for all."""

    seasons: list[int] = Field(default_factory=list)


@dg.op
def rebuild_archive(
    context: dg.OpExecutionContext,
    config: Which,
    setup: Setup,
    notifier: dg.ResourceParam[Notifier],
) -> None:
    """The whole rebuild, as `herijk rebuild` does it."""
    data, seasons = Path(setup.data), config.seasons or None
    try:
        names = [method.name for method in setup.chosen_methods]
        report = rebuild(setup.archive_root, data, names, LogProgress(context.log), seasons)
    except Exception as error:  # whatever it is, it is told
        passes = isinstance(error, UnavailableError) or _is_away(setup.archive_root)
        if passes and context.retry_number < TRIES:
            raise dg.RetryRequested(TRIES, TRY_AGAIN_S) from error
        raise _failure(notifier, error) from error
    for line in [*report.headlines, *tell(notifier, report)]:
        context.log.info(line)
    context.add_output_metadata(
        {
            "nothing_changed": report.nothing_changed,
            "headlines": dg.MetadataValue.json(report.headlines),
            "report": dg.MetadataValue.path(str(data / "report" / "latest.html")),
        }
    )
    if failed := failed_checks(report.checks):
        raise dg.Failure("; ".join(failed), allow_retries=False)


def _is_away(archive: Path) -> bool:
    """Whether nothing lies there: a disk that is not mounted comes back."""
    try:
        listing(archive)
    except MissingKnowledgeError:
        return True
    return False


def _failure(notifier: Notifier, error: Exception) -> dg.Failure:
    what = str(error) if isinstance(error, HerijkError) else unexpected(error)
    return dg.Failure("; ".join([what, *tell_failure(notifier, what)]), allow_retries=False)


@dg.job(name="rebuild", tags=ONE_AT_A_TIME | {"dagster/max_runtime": str(LONGEST_S)})
def rebuild_job() -> None:
    """Everything from the archive to the drafts, the site and a report; publishes nothing."""
    rebuild_archive()


def schedules(settings: Settings, is_served: bool) -> list[dg.ScheduleDefinition]:
    """Everything, every night; and in the months of towing, the season of that year.

    They run where `herijk serve` serves; anybody else has to switch them on.
    """

    def of_the_year(context: dg.ScheduleEvaluationContext) -> dict[str, Any]:
        season = context.scheduled_execution_time.year
        return {"ops": {"rebuild_archive": {"config": {"seasons": [season]}}}}

    common: dict[str, Any] = {
        "job": rebuild_job,
        "execution_timezone": settings.timezone,
        "default_status": dg.DefaultScheduleStatus.RUNNING
        if is_served
        else dg.DefaultScheduleStatus.STOPPED,
    }
    return [
        dg.ScheduleDefinition(name="nightly", cron_schedule=settings.nightly, **common),
        dg.ScheduleDefinition(
            name="campaign", cron_schedule=settings.campaign, run_config_fn=of_the_year, **common
        ),
    ]


def archive_sensor(archive: Path, is_served: bool) -> dg.SensorDefinition:
    """The sensor that asks for a rebuild when the files of the archive change."""

    def look(context: dg.SensorEvaluationContext) -> dg.SensorResult | dg.SkipReason:
        try:  # a digest of the listing, since a cursor is kept for every tick
            now = fingerprint(listing(archive))
        except MissingKnowledgeError as error:
            return dg.SkipReason(str(error))
        return _look(now, context.cursor or "", _failed_before(context.instance, now))

    return dg.SensorDefinition(
        name="archive_changed",
        description="Asks for a rebuild when files changed and copying has ended.",
        evaluation_fn=look,
        job=rebuild_job,
        minimum_interval_seconds=60,
        default_status=dg.DefaultSensorStatus.RUNNING
        if is_served
        else dg.DefaultSensorStatus.STOPPED,
    )


def _failed_before(instance: dg.DagsterInstance, now: str) -> bool:
    """Whether the last run for this state of the archive failed, a while ago."""
    asked = dg.RunsFilter(job_name=rebuild_job.name, tags={LISTING: now})
    for record in instance.get_run_records(asked, limit=1):
        failed = record.dagster_run.status == dg.DagsterRunStatus.FAILURE
        return failed and time.time() - (record.end_time or 0.0) > ASK_AGAIN_S
    return False


def _look(now: str, cursor: str, failed: bool) -> dg.SensorResult:
    """The cursor holds the digests of the listings of the last request and of the last tick.

    A change counts when two ticks see the same listing: so no clock is asked, and no half copy is
    read. A change stays open until a run succeeded.
    """
    asked, _, before = cursor.partition(" ")
    if now == asked and not failed:
        return dg.SensorResult(skip_reason="no file of the archive changed", cursor=cursor)
    if now != before:
        skip = "files changed; waiting until the archive is left alone"
        return dg.SensorResult(skip_reason=skip, cursor=f"{asked} {now}")
    return dg.SensorResult(run_requests=[dg.RunRequest(tags={LISTING: now})], cursor=f"{now} {now}")

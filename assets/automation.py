"""When a rebuild happens without anybody asking: every night, and when the archive changed.

The job runs the same rebuild as the command. It makes drafts; publishing is not among the jobs. How
it went is mailed, as `beheer.toml` asks.
"""

import datetime as dt
import os
import smtplib
import ssl
import urllib.parse
from email.message import EmailMessage
from email.utils import localtime
from pathlib import Path
from typing import Final

import dagster as dg

from assets.instance import OF_A_COMMAND
from assets.report import Done, read_report, record_failure
from assets.settings import Settings
from dashboards.guard import LOOPBACK
from dashboards.reports import CHANGED, write_mail
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import make_translator, say
from warehouse.intake.seasons import listing
from warehouse.store.store import Store, fingerprint

ONE_AT_A_TIME = {"herijk/rebuild": "data folder"}
"""The tag of which one run at a time is started (see `dagster.yaml`)."""

MAX_RUNTIME_S = 12 * 3600
"""A run that takes longer hangs. It is ended, so that the next can begin."""

TIMEOUT_S: Final = 10.0
PASSWORD_VARIABLE: Final = "HERIJK_SMTP_PASSWORD"  # noqa: S105 - its name


BEGIN_AGAIN: Final = {
    "dagster/max_retries": "1",
    "dagster/retry_on_asset_or_op_failure": "true",
    "dagster/retry_strategy": "ALL_STEPS",
}
"""A failed run begins once again: one that met a damaged file of ours has removed it."""

rebuild_job = dg.define_asset_job(
    "rebuild",
    selection=dg.AssetSelection.all(),
    tags=ONE_AT_A_TIME | BEGIN_AGAIN | {"dagster/max_runtime": str(MAX_RUNTIME_S)},
    description="Everything from the archive to drafts, site and report; publishes nothing.",
)


def nightly(settings: Settings, is_served: bool) -> dg.ScheduleDefinition:
    """Return the schedule that looks at everything every night."""
    running, stopped = dg.DefaultScheduleStatus.RUNNING, dg.DefaultScheduleStatus.STOPPED
    return dg.ScheduleDefinition(
        name="nightly",
        job=rebuild_job,
        cron_schedule=settings.nightly,
        execution_timezone=settings.timezone,
        default_status=running if is_served else stopped,
    )


def archive_changed(archive: Path, is_served: bool) -> dg.SensorDefinition:
    """Return the sensor that asks for a rebuild when files of the archive change.

    A change counts when two ticks see the same listing: so no clock is asked, and no half copy is
    read. The cursor holds the digests of the listings of the last request and of the last tick.
    """

    def look(context: dg.SensorEvaluationContext) -> dg.SensorResult | dg.SkipReason:
        try:
            now = fingerprint(listing(archive))
        except MissingKnowledgeError as error:
            return dg.SkipReason(str(error))
        asked, _, before = (context.cursor or "").partition(" ")
        if now == asked:
            return dg.SkipReason("no file of the archive changed")
        if now == before:
            return dg.SensorResult(run_requests=[dg.RunRequest()], cursor=f"{now} {now}")
        waiting = "files changed; waiting until the archive is left alone"
        return dg.SensorResult(skip_reason=waiting, cursor=f"{asked} {now}")

    return dg.SensorDefinition(
        name="archive_changed",
        description="Asks for a rebuild when files changed and copying has ended.",
        evaluation_fn=look,
        job=rebuild_job,
        minimum_interval_seconds=60,
        default_status=_get_status(is_served),
    )


def rebuild_succeeded(settings: Settings, data: Path, is_served: bool) -> dg.SensorDefinition:
    """Return the sensor that mails what a run changed that nobody watched."""

    @dg.run_status_sensor(
        run_status=dg.DagsterRunStatus.SUCCESS,
        name="rebuild_succeeded",
        monitored_jobs=[rebuild_job],
        default_status=_get_status(is_served),
    )
    def mail_news(context: dg.RunStatusSensorContext) -> None:
        report = read_report(Store(data), Done())
        is_of_run = report.made_at >= _get_start(context)
        if report.outcome == CHANGED and is_of_run and not _is_watched(context):
            send_mail(
                settings, *write_mail(report, report.checks, report.simulated, report.last_run)
            )

    return mail_news


def _is_watched(context: dg.RunStatusSensorContext) -> bool:
    """Return whether a run is that of a command, which told its user itself."""
    return OF_A_COMMAND.items() <= context.dagster_run.tags.items()


def _get_start(context: dg.RunStatusSensorContext) -> str:
    """Return when a run began, ISO 8601 in local time, as reports have it."""
    seconds = context.instance.get_run_stats(context.dagster_run.run_id).start_time or 0.0
    return dt.datetime.fromtimestamp(seconds).astimezone().isoformat(timespec="seconds")


def rebuild_failed(settings: Settings, data: Path, is_served: bool) -> dg.SensorDefinition:
    """Return the sensor that mails that a run failed, whatever made it fail, and reports it."""

    @dg.run_failure_sensor(
        name="rebuild_failed",
        monitored_jobs=[rebuild_job],
        default_status=_get_status(is_served),
    )
    def mail_failure(context: dg.RunFailureSensorContext) -> None:
        if _is_watched(context) or context.dagster_run.tags.get("dagster/will_retry") == "true":
            return
        reasons = [_explain_step(event) for event in context.get_step_failure_events()]
        reason = "\n".join(reasons) or str(context.failure_event.message)
        record_failure(Store(data), dt.datetime.now().astimezone(), reason)
        send_mail(settings, make_translator("nl")(say("The rebuild failed")), f"{reason}\n")

    return mail_failure


def _explain_step(event: dg.DagsterEvent) -> str:
    """Return the error behind the one that Dagster raises for a failed step."""
    failure = event.step_failure_data
    if failure.user_failure_data is not None:
        return failure.user_failure_data.description or ""
    error = failure.error
    return "" if error is None else (error.cause or error).message


def _get_status(is_served: bool) -> dg.DefaultSensorStatus:
    return dg.DefaultSensorStatus.RUNNING if is_served else dg.DefaultSensorStatus.STOPPED


def send_mail(settings: Settings, subject: str, text: str) -> None:
    """Send a mail, unencrypted on this machine only; none where the settings name nobody.

    Raises:
        OSError: the mail server cannot be reached or does not take it, or its password cannot be
            read.
        ValueError: an address cannot be one.
    """
    if settings.mail_to is None:
        return
    mail = EmailMessage()
    mail["From"], mail["To"] = settings.mail_from, settings.mail_to
    mail["Subject"], mail["Date"] = subject, localtime()
    mail.set_content(text)
    server = urllib.parse.urlsplit(settings.smtp)
    host, secure = str(server.hostname), ssl.create_default_context()
    with (
        smtplib.SMTP_SSL(host, server.port or 465, timeout=TIMEOUT_S, context=secure)
        if server.scheme == "smtps"
        else smtplib.SMTP(host, server.port or 587, timeout=TIMEOUT_S)
    ) as connection:
        if server.scheme == "smtp" and host not in LOOPBACK:
            connection.starttls(context=secure)
        if server.username:
            connection.login(urllib.parse.unquote(server.username), _password(settings))
        connection.send_message(mail)


def _password(settings: Settings) -> str:
    """Return the password of the mail server, from the environment or from its file."""
    password = os.environ.get(PASSWORD_VARIABLE, "")
    if password or settings.smtp_password_file is None:
        return password
    return settings.smtp_password_file.read_text(encoding="utf-8").strip()

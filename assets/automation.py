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

from assets.report import check_of, read_report
from assets.settings import Settings
from dashboards.guard import LOOPBACK
from dashboards.statements.rebuild import mail
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say, speaker
from warehouse.intake.seasons import listing
from warehouse.store.store import Store, fingerprint

ONE_AT_A_TIME = {"herijk/rebuild": "data folder"}
"""The tag of which one run at a time is started (see `dagster.yaml`)."""

LONGEST_S = 12 * 3600
"""A run that takes longer hangs, and is ended so that the next can begin."""

TIMEOUT_S: Final = 10.0
PASSWORD_VARIABLE: Final = "HERIJK_SMTP_PASSWORD"  # noqa: S105 - its name


rebuild_job = dg.define_asset_job(
    "rebuild",
    selection=dg.AssetSelection.all(),
    tags=ONE_AT_A_TIME | {"dagster/max_runtime": str(LONGEST_S)},
    description="Everything from the archive to drafts, site and report; publishes nothing.",
)


def nightly(settings: Settings, is_served: bool) -> dg.ScheduleDefinition:
    """Everything, every night; it runs where `herijk serve` serves, or who switches it on."""
    status = dg.DefaultScheduleStatus.RUNNING if is_served else dg.DefaultScheduleStatus.STOPPED
    return dg.ScheduleDefinition(
        name="nightly",
        job=rebuild_job,
        cron_schedule=settings.nightly,
        execution_timezone=settings.timezone,
        default_status=status,
    )


def archive_changed(archive: Path, is_served: bool) -> dg.SensorDefinition:
    """The sensor that asks for a rebuild when the files of the archive change.

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
        default_status=_status(is_served),
    )


def rebuild_succeeded(settings: Settings, data: Path, is_served: bool) -> dg.SensorDefinition:
    """The sensor that mails what a rebuild that nobody watched changed."""

    @dg.run_status_sensor(
        run_status=dg.DagsterRunStatus.SUCCESS,
        name="rebuild_succeeded",
        monitored_jobs=[rebuild_job],
        default_status=_status(is_served),
    )
    def tell(context: dg.RunStatusSensorContext) -> None:
        logs = context.instance.all_logs(
            context.dagster_run.run_id, of_type=dg.DagsterEventType.ASSET_CHECK_EVALUATION
        )
        events = [log.get_dagster_event() for log in logs]
        checks = [check_of(event.asset_check_evaluation_data) for event in events]
        report = read_report(Store(data), checks)
        if report.made_at >= _began(context):
            send_mail(settings, *mail(report, checks, report.simulated))

    return tell


def _began(context: dg.RunStatusSensorContext) -> str:
    stats = context.instance.get_run_stats(context.dagster_run.run_id)
    return dt.datetime.fromtimestamp(stats.start_time).astimezone().isoformat(timespec="seconds")


def rebuild_failed(settings: Settings, is_served: bool) -> dg.SensorDefinition:
    """The sensor that mails that a rebuild failed, whatever made it fail."""

    @dg.run_failure_sensor(
        name="rebuild_failed", monitored_jobs=[rebuild_job], default_status=_status(is_served)
    )
    def tell(context: dg.RunFailureSensorContext) -> None:
        why = "\n".join(map(_why, context.get_step_failure_events()))
        why = why or str(context.failure_event.message)
        send_mail(settings, speaker("nl")(say("The rebuild failed")), f"{why}\n")

    return tell


def _why(event: dg.DagsterEvent) -> str:
    """What a failed step said: of a check its own words, else the error behind Dagster's."""
    failure = event.step_failure_data
    if failure.user_failure_data is not None:
        return failure.user_failure_data.description or ""
    error = failure.error
    return "" if error is None else (error.cause or error).message


def _status(is_served: bool) -> dg.DefaultSensorStatus:
    return dg.DefaultSensorStatus.RUNNING if is_served else dg.DefaultSensorStatus.STOPPED


def send_mail(settings: Settings, subject: str, text: str) -> None:
    """Sends a mail, unencrypted on this machine only; nothing where the settings name nobody.

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
    """The password of the mail server: from the environment, or the file that the settings name."""
    password = os.environ.get(PASSWORD_VARIABLE, "")
    if password or settings.smtp_password_file is None:
        return password
    return settings.smtp_password_file.read_text(encoding="utf-8").strip()

"""What starts a rebuild by itself, and whom it mails; with real processes: `test_served`."""

import base64
import shutil
import socketserver
import subprocess
import sys
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import ClassVar

import dagster as dg
import pytest

from assets.automation import archive_changed, rebuild_failed, rebuild_succeeded, send_mail
from assets.definitions import build_defs
from assets.report import Done, read_report
from assets.settings import Settings, read_settings
from pipeline.errors import MissingKnowledgeError
from tests.assets.test_rebuild import list_samples_files, spoil
from tests.conftest import EVERY, METHODS, STUDIES, in_one_process, without_page

ROOT = Path(__file__).parents[2]


class Ticks:
    """The sensor, asked again and again with the cursor it gave."""

    def __init__(self, archive, instance):
        self.sensor, self.cursor = archive_changed(archive, is_served=True), None
        self.instance = instance

    def tick(self):
        """How many rebuilds a tick asks for."""
        context = dg.build_sensor_context(self.instance, self.cursor)
        found = self.sensor.evaluate_tick(context)
        self.cursor = found.cursor or self.cursor
        return len(found.run_requests or [])


@pytest.fixture
def archive(tmp_path):
    """A folder with two files; the sensor opens none."""
    (tmp_path / "archive").mkdir()
    for name in ("a.csv", "b.csv"):
        (tmp_path / "archive" / name).write_text("x")
    return tmp_path / "archive"


@pytest.mark.parametrize(
    ("change", "asked"),
    [
        (lambda root: (root / "c.csv").write_text("y"), 1),
        (lambda root: (root / "a.csv").write_text("mended"), 1),
        (lambda root: (root / "b.csv").unlink(), 1),
        (lambda root: (root / ".lock").write_text(""), 0),
        (lambda root: root.rename(root.with_name("away")), 0),
    ],
    ids=["came", "changed", "went", "hidden", "disk away"],
)
def test_a_file_that_came_changed_or_went_asks_for_one_rebuild(archive, change, asked):
    with dg.DagsterInstance.ephemeral() as instance:
        sensor = Ticks(archive, instance)
        assert [sensor.tick() for _ in range(3)] == [0, 1, 0]
        change(archive)
        assert [sensor.tick() for _ in range(3)] == [0, asked, 0]


class MailServer(socketserver.StreamRequestHandler):
    """Takes mail as SMTP says, from who logs in with the right password."""

    PASSWORD: ClassVar[bytes] = base64.b64encode(b"\0tc@x.org\0secret")
    taken: ClassVar[list[str]] = []

    def handle(self):
        self.wfile.write(b"220 here\r\n")
        while line := self.rfile.readline().strip():
            self.wfile.write(self.answer(line.split()) + b"\r\n")

    def answer(self, words):
        match words[0].upper():
            case b"EHLO":
                return b"250-here\r\n250 AUTH PLAIN"
            case b"AUTH":
                return b"235 yes" if words[-1] == self.PASSWORD else b"535 no"
            case b"QUIT":
                return b"221 bye"
            case b"DATA":
                self.wfile.write(b"354 go on\r\n")
                lines = iter(self.rfile.readline, b".\r\n")
                self.taken.append(b"".join(lines).decode())
        return b"250 ok"


@pytest.fixture
def mailed(tmp_path, monkeypatch):
    """Settings that mail to a server on this machine, and what that takes."""
    monkeypatch.setattr(MailServer, "taken", [])
    (tmp_path / "password").write_text("secret\n")
    with socketserver.TCPServer(("127.0.0.1", 0), MailServer) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"smtp://tc%40x.org@127.0.0.1:{server.server_address[1]}"
        yield (
            Settings(
                methods=METHODS,
                mail_to="tc@example.org",
                smtp=address,
                smtp_password_file=tmp_path / "password",
            ),
            MailServer.taken,
        )
        server.shutdown()


def test_mail_goes_by_the_mail_server_with_the_password(mailed, monkeypatch):
    settings, taken = mailed
    send_mail(settings, "onderwerp", "tekst")
    (mail,) = taken
    assert "To: tc@example.org" in mail
    assert "Subject: onderwerp" in mail
    monkeypatch.setenv("HERIJK_SMTP_PASSWORD", "wrong")
    with pytest.raises(OSError, match="535") as refused:
        send_mail(settings, "onderwerp", "tekst")
    assert "wrong" not in str(refused.value)
    with pytest.raises(ValueError, match="linefeed"):
        send_mail(settings.model_copy(update={"mail_to": "a@b.c\nBcc: x@y.z"}), "s", "t")


@contextmanager
def run_job(bench, settings):
    """The job as the schedule runs it: its result, and Dagster's records."""
    location = build_defs(str(bench.archive), str(bench.data), list(settings.methods))
    made = [dg.AssetKey(name) for name in EVERY - {*STUDIES, "site"}]
    with dg.DagsterInstance.ephemeral() as instance, without_page(), in_one_process():
        job = location.resolve_job_def("rebuild")
        result = job.execute_in_process(
            instance=instance, raise_on_error=False, asset_selection=made
        )
        yield result, instance


def tell_of_success(bench, settings, result, instance):
    """What the sensor does after a run that ended well."""
    context = dg.build_run_status_sensor_context(
        "rebuild_succeeded", result.get_run_success_event(), instance, result.dagster_run
    )
    rebuild_succeeded(settings, bench.data, is_served=True)(context)


@pytest.mark.more
def test_a_night_without_a_change_does_no_work_and_mails_nothing(bench, mailed):
    settings, taken = mailed
    before = bench.lake_files(), bench.store.database.stat().st_mtime_ns
    was = read_report(bench.store, Done())
    with run_job(bench, settings) as (result, instance):
        assert result.success
        tell_of_success(bench, settings, result, instance)
    report = read_report(bench.store, Done())
    assert (report.outcome, report.changed_at) == ("unchanged", was.changed_at)
    assert report.made_at > was.made_at
    assert (bench.lake_files(), bench.store.database.stat().st_mtime_ns) == before
    assert taken == []


@pytest.mark.more
def test_a_night_with_news_mails_it(bench, mailed):
    settings, taken = mailed
    spoil(list_samples_files(bench, 2009)[3])
    with run_job(bench, settings) as (result, instance):
        assert result.success
        tell_of_success(bench, settings, result, instance)
    (mail,) = taken
    assert "Laatste verandering" in mail
    assert "1 nieuw" in mail
    assert "GESIMULEERD" in mail


@pytest.mark.more
def test_a_night_that_fails_is_mailed_with_why(bench, mailed):
    settings, taken = mailed
    shutil.rmtree(bench.archive)
    with run_job(bench, settings) as (result, instance):
        failed = result.get_run_failure_event()
        context = dg.build_run_status_sensor_context(
            "rebuild_failed", failed, instance, result.dagster_run
        ).for_run_failure()
        rebuild_failed(settings, bench.data, is_served=True)(context)
    report = read_report(bench.store, Done())
    assert report.outcome == "failed"
    assert "There is no archive" in report.reason
    (mail,) = taken
    assert f"There is no archive at {bench.archive}" in mail.replace("=\r\n", "")


@pytest.mark.more
def test_no_job_publishes():
    """The code that publishes is not even loaded where jobs run."""
    found = subprocess.run(
        [sys.executable, "-c", "import assets.definitions, sys; print(*sys.modules)"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "warehouse.editions.verify" in found.stdout.split()
    assert "warehouse.editions.publish" not in found.stdout.split()


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("nightly = 3", "nightly"),
        ('nightly = "at three"', "nightly"),
        ('smtp = "smtp://me:secret@host"', "smtp"),
        ("night = 1", "night"),
        ("=", "TOML"),
    ],
)
def test_settings_that_are_not_understood_say_which(tmp_path, text, word):
    assert read_settings(tmp_path).nightly == "0 3 * * *"
    (tmp_path / "beheer.toml").write_text(text)
    with pytest.raises(MissingKnowledgeError, match=word) as refused:
        read_settings(tmp_path)
    assert "secret" not in str(refused.value)

"""The report of a rebuild: what changed and why, and who is told."""

import base64
import datetime as dt
import email
import email.policy
import json
import socketserver
import threading
from contextlib import contextmanager
from dataclasses import replace
from http.server import BaseHTTPRequestHandler, HTTPServer
from typing import ClassVar

import dagster as dg
import duckdb
import polars as pl
import pytest

from assets.checks import CHECKS
from assets.notify import Message, Notifier, notifier_of
from assets.report import Done, failed_checks, tell
from assets.resources import Setup
from assets.settings import read_settings
from dashboards.report import Check, headlines
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import speaker
from tests.assets.test_rebuild import samples_files, spoil, tow_of
from tests.conftest import METHODS
from tests.warehouse.test_faults import Archive, cells, line_of, times
from warehouse.queries.change_report import (
    change_report,
    remember,
    reported_path,
    summary_of,
)

NOW = dt.datetime(2026, 11, 21, 3, 5, tzinfo=dt.UTC)


def latest(bench):
    return json.loads((bench.data / "report" / "latest.json").read_text("utf-8"))


STRONGER = 1.05


def with_more_force(bench, tow):
    """Rewrites the force column of a tow's samples; every Cw of that tow moves as much."""
    archive = Archive(bench.archive, bench)
    archive.samples(tow, cells(3, times(STRONGER), 2, line_of(7)))


def test_a_report_names_what_was_set_aside_what_changed_and_why(bench, built):
    file = samples_files(bench, 2009)[3]
    gone, kept = tow_of(bench, file), spoil(file)
    register = built.table("register").filter(pl.col("tow_id").str.starts_with("2009"))
    stronger = register.filter(pl.col("tow_id") != gone).row(0, named=True)
    with_more_force(bench, stronger["tow_id"])
    report = bench.rebuild(page=True)
    assert latest(bench)["headlines"] == report.headlines
    assert {(row["tow_id"], row["what"]) for row in report.tow_rows} == {
        (gone, "gone"),
        (stronger["tow_id"], "samples"),
    }
    assert [(r["tow_id"], r["reason_code"], r["what"]) for r in report.set_aside_rows] == [
        (gone, "unknown_run", "new")
    ]
    assert report.factors == []
    changed = [line for line in report.lines if line["change"] == "changed"]
    assert [(line["fsn_no"], line["to_edition"]) for line in changed] == [
        (stronger["fsn_no"], f"concept-{method}") for method in METHODS
    ]
    for line in changed:
        assert line["cw_ratio"] == pytest.approx(STRONGER, abs=0.02)
        (cause,) = json.loads(line["causes"])
        assert (cause["cause"], cause["factor"]) == ("input", pytest.approx(line["cw_ratio"]))
    page = (bench.data / "report" / "latest.html").read_text("utf-8").replace('"', "")
    assert "invoer +5," in page

    file.write_bytes(kept)
    report = bench.rebuild()
    assert [row["what"] for row in report.set_aside_rows] == ["mended"]
    assert [row["what"] for row in report.tow_rows] == ["new"]


@contextmanager
def reported(bench):
    """What was last reported on, to be changed by changing today's tables for a moment."""
    today = bench.store.database.read_bytes()
    with duckdb.connect(bench.store.database) as db:
        yield db
    remember(bench.store)
    bench.store.database.write_bytes(today)


def test_a_log_factor_that_shows_the_same_did_not_move(bench):
    with reported(bench) as db:
        db.execute("UPDATE log_factors SET factor = factor * 1.00004 WHERE season = 2009")
        db.execute("UPDATE log_factors SET factor = factor * 1.00006 WHERE season = 2014")
    assert change_report(bench.store).factors["season"].unique().to_list() == [2014]


def test_what_is_compared_is_small_and_not_a_second_database(built):
    kept = reported_path(built.store).stat().st_size
    assert kept < built.store.database.stat().st_size / 10
    assert [f.name for f in built.data.rglob("*.duckdb")] == ["warehouse.duckdb"]


@pytest.mark.parametrize("spoilt", [b"", b"PAR1"])
def test_a_damaged_memory_of_the_last_report_makes_the_next_the_first(bench, spoilt):
    reported_path(bench.store).write_bytes(spoilt)
    assert bench.rebuild().first
    assert bench.rebuild().nothing_changed


def test_a_season_that_disappeared_from_the_archive_is_named_first(bench):
    with reported(bench) as db:
        db.execute("UPDATE tows SET season = 2002 WHERE tow_id = (SELECT min(tow_id) FROM tows)")
    summary = summary_of(change_report(bench.store))
    assert summary.seasons_gone == [2002]
    first = headlines(summary, [], speaker("en"))[0]
    assert first == "Seasons of which the archive has no tow any more: 2002"


def test_a_second_rebuild_reports_that_nothing_changed(bench):
    bench.rebuild()
    report = bench.rebuild()
    assert report.nothing_changed
    assert report.headlines == ["Nothing changed since the last report."]
    assert latest(bench)["nothing_changed"]
    page = (bench.data / "report" / "latest.html").read_text("utf-8")
    later = f"De herberekening van {report.made_at[:16].replace('T', ' ')} veranderde daarna niets."
    assert page.count(later) == 1
    assert "Eerste verslag" in page
    assert "GESIMULEERD" in page


def test_a_rebuild_killed_before_its_report_is_reported_on_by_the_next(bench, monkeypatch):
    bench.rebuild()
    spoil(samples_files(bench, 2009)[3])

    def killed(*args):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("assets.rebuild.write_report", killed)
        with pytest.raises(KeyboardInterrupt):
            bench.rebuild()
    report = bench.rebuild()
    assert report.done == Done()
    assert [row["what"] for row in report.set_aside_rows] == ["new"]


def test_all_checks_pass_on_a_sound_archive(built):
    report = json.loads(next((built.data / "report").glob("2*.json")).read_text("utf-8"))
    assert {c["check"] for c in report["checks"]} >= {"counts_agree", "tables_fit_their_schemas"}
    assert [c for c in report["checks"] if not c["passed"]] == []
    assert failed_checks([Check(**check) for check in report["checks"]]) == []


def test_all_checks_can_be_run_again_after_the_report(built):
    setup = Setup(archive="", data=str(built.data), methods=list(METHODS))
    assert all(check(setup).passed for check in CHECKS)


def test_a_failing_check_of_a_promise_is_an_error_and_a_warning_is_none():
    found = {"number": 2, "first": ["boats", "tows"]}
    for severity, failed in (
        ("ERROR", ["counts_agree: number 2, among them boats; tows"]),
        ("WARN", []),
    ):
        check = Check("tows", "counts_agree", passed=False, severity=severity, found=found)
        assert failed_checks([check]) == failed
    assert dg.AssetCheckSeverity.ERROR.value == "ERROR"


# Who is told


@pytest.fixture
def web():
    """A web address on this machine that keeps what is posted."""
    posted = []

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            posted.append(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
            self.send_response(204 if self.path == "/good" else 500)
            self.end_headers()

        def log_message(self, *_):
            pass

    with HTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}", posted
        server.shutdown()


def test_news_is_mailed_to_a_file_and_posted(bench, web):
    address, posted = web
    bench.rebuild()
    spoil(samples_files(bench, 2009)[3])
    report = bench.rebuild()
    notifier = Notifier(
        data=str(bench.data),
        mail_to="tc@example.org",
        mail_from="h@x.org",
        webhook=f"{address}/good",
    )
    assert tell(notifier, report) == []
    assert "1 nieuw" in posted[-1]["text"]
    assert "GESIMULEERD" in posted[-1]["text"]
    assert tell(notifier, replace(report, nothing_changed=True)) == []
    assert len(posted) == 1
    message = Message("onderwerp", "tekst", {"nothing_changed": False}, NOW)
    assert notifier.send(message) == []
    mail = email.message_from_bytes(
        (bench.data / "outbox" / "2026-11-21T030500.000000.eml").read_bytes(),
        policy=email.policy.default,
    )
    assert (mail["To"], mail["Subject"]) == ("tc@example.org", "onderwerp")
    assert mail.get_content() == "tekst\n"
    assert posted[-1]["report"] == {"nothing_changed": False}


def test_a_message_that_cannot_be_sent_is_reported_and_stops_nothing(tmp_path, web):
    address, _ = web
    message = Message("s", "t", {}, NOW)
    for webhook in (f"{address}/bad", "http://127.0.0.1:9/closed"):
        notifier = Notifier(data=str(tmp_path), webhook=webhook)
        (problem,) = notifier.send(message)
        assert "sent to http://127.0.0.1:" in problem
        assert webhook not in problem  # its path may be a secret
    injecting = Notifier(data=str(tmp_path), mail_to="a@b.c\nBcc: x@y.z")
    (problem,) = injecting.send(message)
    assert "no message could be sent" in problem
    assert not list(tmp_path.rglob("*.eml"))


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


@pytest.mark.parametrize(("password", "taken"), [("secret", 1), ("wrong", 0)])
def test_mail_goes_by_the_mail_server_or_into_the_outbox(tmp_path, monkeypatch, password, taken):
    monkeypatch.setattr(MailServer, "taken", [])
    (tmp_path / "password").write_text(f"{password}\n")
    with socketserver.TCPServer(("127.0.0.1", 0), MailServer) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        (tmp_path / "beheer.toml").write_text(
            f'mail_to = "tc@example.org"\nsmtp = "smtp://tc%40x.org@127.0.0.1:{server.server_address[1]}"\n'
            f'smtp_password_file = "{tmp_path}/password"'
        )
        notifier = notifier_of(str(tmp_path), read_settings(tmp_path))
        problems = notifier.send(Message("onderwerp", "tekst", {}, NOW))
        server.shutdown()
    assert len(MailServer.taken) == taken
    assert all("Subject: onderwerp" in mail for mail in MailServer.taken)
    assert len(problems) == len(list((tmp_path / "outbox").glob("*.eml"))) == 1 - taken
    assert password not in repr(notifier) + "".join(problems)


def test_settings_that_are_not_understood_say_which(tmp_path):
    assert read_settings(tmp_path).nightly == "0 3 * * *"
    for text, word in (
        ("nightly = 3", "nightly"),
        ('webhook = "file:///etc/passwd"', "webhook"),
        ('smtp = "smtp://me:secret@host"', "smtp"),
        ("night = 1", "night"),
        ("=", "TOML"),
    ):
        (tmp_path / "beheer.toml").write_text(text)
        with pytest.raises(MissingKnowledgeError, match=word):
            read_settings(tmp_path)

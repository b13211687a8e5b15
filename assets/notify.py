"""Telling people what a rebuild did: by mail, or with a message to a web address.

A message that cannot be sent is reported and never stops a rebuild. A mail that no mail server
takes is put in a folder, for the mail program of the machine or for a person.
"""

import datetime as dt
import json
import os
import smtplib
import ssl
import urllib.parse
import urllib.request
from dataclasses import asdict, dataclass, field
from email.message import EmailMessage
from email.utils import format_datetime
from http.client import HTTPException
from pathlib import Path
from typing import Any

from assets.settings import Settings
from pipeline.errors import MissingKnowledgeError
from warehouse.store.files import written_beside

TIMEOUT_S = 10.0
WEBHOOK_VARIABLE = "HERIJK_WEBHOOK"
PASSWORD_VARIABLE = "HERIJK_SMTP_PASSWORD"  # noqa: S105 - its name


@dataclass(frozen=True)
class Message:
    """A message about a rebuild; `report` is the whole of it, for programs."""

    subject: str
    text: str
    report: dict[str, Any]
    sent_at: dt.datetime


@dataclass(frozen=True)
class Notifier:
    """Whom to tell; nobody where neither address is given.

    No resource with settings of its own: Dagster's page would show them.

    Attributes:
        data: the data folder; mails that are not sent are put into `outbox/` in it, one file each.
        mail_to, mail_from: addresses of the mail.
        smtp: mail server that sends it, as in the settings; without it nothing is sent from here.
        smtp_password: of the user named in `smtp`.
        webhook: gets the message as JSON.
    """

    data: str
    mail_to: str | None = None
    mail_from: str = ""
    webhook: str | None = field(default=None, repr=False)
    smtp: str | None = None
    smtp_password: str = field(default="", repr=False)

    def send(self, message: Message) -> list[str]:
        """Sends a message everywhere; returns a sentence for each place where that failed."""
        problems = []
        for address, send in ((self.mail_to, self._mail), (self.webhook, self._post)):
            if address:
                try:
                    send(message)
                except (OSError, ValueError, HTTPException) as error:  # SMTP's errors are OSErrors
                    why = str(error).replace(address, _shown(address))
                    problems.append(f"no message could be sent to {_shown(address)}: {why}")
        return problems

    def _mail(self, message: Message) -> None:
        mail = EmailMessage()
        mail["From"], mail["To"] = self.mail_from, self.mail_to
        mail["Subject"], mail["Date"] = message.subject, format_datetime(message.sent_at)
        mail.set_content(message.text)
        try:
            self._hand_over(mail)
        except (OSError, ValueError):
            self._put_in_outbox(mail, message.sent_at)
            raise
        if self.smtp is None:
            self._put_in_outbox(mail, message.sent_at)

    def _hand_over(self, mail: EmailMessage) -> None:
        """Gives a mail to the mail server, if there is one; never unencrypted but on this machine.

        Raises:
            OSError: the server does not take it.
        """
        if self.smtp is None:
            return
        from dashboards.guard import LOOPBACK  # noqa: PLC0415 - a web server

        server = urllib.parse.urlsplit(self.smtp)
        host, secure = str(server.hostname), ssl.create_default_context()
        with (
            smtplib.SMTP_SSL(host, server.port or 465, timeout=TIMEOUT_S, context=secure)
            if server.scheme == "smtps"
            else smtplib.SMTP(host, server.port or 587, timeout=TIMEOUT_S)
        ) as connection:
            if server.scheme == "smtp" and host not in LOOPBACK:
                connection.starttls(context=secure)
            if server.username:
                connection.login(urllib.parse.unquote(server.username), self.smtp_password)
            connection.send_message(mail)

    def _put_in_outbox(self, mail: EmailMessage, sent_at: dt.datetime) -> None:
        name = f"{sent_at:%Y-%m-%dT%H%M%S.%f}.eml"
        with written_beside(Path(self.data) / "outbox" / name) as beside:
            beside.write_bytes(bytes(mail))

    def _post(self, message: Message) -> None:
        request = urllib.request.Request(  # noqa: S310 - the settings allow http and https only
            str(self.webhook),
            json.dumps(asdict(message), default=str).encode(),
            {"Content-Type": "application/json"},
        )
        with urllib.request.urlopen(request, timeout=TIMEOUT_S):  # noqa: S310
            pass


def _shown(address: str) -> str:
    """An address without what may be a secret: of a web address, the machine alone."""
    parts = urllib.parse.urlsplit(address)
    return f"{parts.scheme}://{parts.hostname}" if parts.hostname else address


def notifier_of(data: str, settings: Settings) -> Notifier:
    """The notifier that the settings ask for."""
    return Notifier(
        data=data,
        mail_to=settings.mail_to,
        mail_from=settings.mail_from,
        webhook=os.environ.get(WEBHOOK_VARIABLE, settings.webhook),
        smtp=settings.smtp,
        smtp_password=_password(settings),
    )


def _password(settings: Settings) -> str:
    """The password of the mail server: from the environment, or the file that the settings name."""
    password = os.environ.get(PASSWORD_VARIABLE)
    if password is not None or settings.smtp_password_file is None:
        return password or ""
    try:
        return settings.smtp_password_file.read_text(encoding="utf-8").strip()
    except (OSError, ValueError) as error:
        raise MissingKnowledgeError(
            "{}, named by smtp_password_file, cannot be read", settings.smtp_password_file
        ) from error

"""Telling people what a rebuild did: a mail in a folder, or a message to a web address.

A message that cannot be sent is reported and never stops a rebuild.
"""

import datetime as dt
import json
import os
import urllib.parse
import urllib.request
from dataclasses import asdict, dataclass, field
from email.message import EmailMessage
from email.utils import format_datetime
from http.client import HTTPException
from pathlib import Path
from typing import Any

from herijk.assets.settings import Settings
from herijk.warehouse.store.files import written_beside

TIMEOUT_S = 10.0
WEBHOOK_VARIABLE = "HERIJK_WEBHOOK"


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
        data: the data folder; mails are put into `outbox/` in it, one file each, for the mail
            program of the machine to send.
        mail_to, mail_from: addresses of the mail.
        webhook: gets the message as JSON.
    """

    data: str
    mail_to: str | None = None
    mail_from: str = ""
    webhook: str | None = field(default=None, repr=False)

    def send(self, message: Message) -> list[str]:
        """Sends a message everywhere; returns a sentence for each place where that failed."""
        problems = []
        for address, send in ((self.mail_to, self._mail), (self.webhook, self._post)):
            if address:
                try:
                    send(message)
                except (OSError, ValueError, HTTPException) as error:
                    why = str(error).replace(address, _shown(address))
                    problems.append(f"no message could be sent to {_shown(address)}: {why}")
        return problems

    def _mail(self, message: Message) -> None:
        mail = EmailMessage()
        mail["From"], mail["To"] = self.mail_from, self.mail_to
        mail["Subject"], mail["Date"] = message.subject, format_datetime(message.sent_at)
        mail.set_content(message.text)
        name = f"{message.sent_at:%Y-%m-%dT%H%M%S.%f}.eml"
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
    )

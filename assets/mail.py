"""A mail about a rebuild that nobody watched, as `beheer.toml` asks."""

import os
import smtplib
import ssl
import urllib.parse
from email.message import EmailMessage
from email.utils import localtime
from typing import Final

from assets.settings import Settings
from dashboards.guard import LOOPBACK

TIMEOUT_S: Final = 10.0
PASSWORD_VARIABLE: Final = "HERIJK_SMTP_PASSWORD"  # noqa: S105 - its name


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

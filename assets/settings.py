"""`beheer.toml`: when to rebuild, whom to tell and who helps, written by whoever runs it.

It lies in the data folder and may be left out. No setting in it can change a number.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Final
from zoneinfo import available_timezones

from pydantic import BaseModel, ConfigDict, Field, field_validator

from warehouse.store.methods import methods_to_apply
from warehouse.store.settings_file import read_settings_file
from warehouse.store.store import Store

FILE_NAME: Final = "beheer.toml"


class Settings(BaseModel):
    """What `beheer.toml` can say.

    Attributes:
        methods: names of the methods that a rebuild applies; see `methods_to_apply`.
        nightly: when everything is looked at; a cron line.
        campaign: when the season of that year is looked at, while it is towed.
        timezone: of both.
        mail_to, mail_from: with `mail_to`, a mail about each report: sent by `smtp`, or put into
            `outbox/` without it.
        smtp: mail server: `smtp://user@host:587`, encrypted by STARTTLS but on this machine, or
            `smtps://user@host:465`; an @ in the user is written %40.
        smtp_password_file: a file with its password; `HERIJK_SMTP_PASSWORD` in the environment
            takes precedence.
        webhook: an address to which each report is posted as JSON; `HERIJK_WEBHOOK` in the
            environment takes precedence. It may hold a secret and is shown nowhere.
        set_aside_share: more of the tows set aside gives a warning.
        factor_jump: a log factor that moves more gives a warning; a ratio minus 1.
        dask: scheduler of the Dask cluster that reads the seasons: `tcp://host:8786`; without it
            they are read in the process of the rebuild.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)

    methods: tuple[str, ...] = ()
    nightly: str = "0 3 * * *"
    campaign: str = "0 7 * 4-9 1"
    timezone: str = "Europe/Amsterdam"
    mail_to: str | None = None
    mail_from: str = "herijk@localhost"
    smtp: str | None = Field(default=None, pattern=r"^smtps?://([^:@/\s]+@)?[^:@/\s]+(:\d+)?$")
    smtp_password_file: Path | None = None
    webhook: str | None = Field(default=None, pattern=r"^https?://")
    set_aside_share: float = Field(default=0.1, ge=0, le=1)
    factor_jump: float = Field(default=0.01, gt=0)
    dask: str | None = Field(default=None, pattern=r"^(tcp|tls)://")

    @field_validator("nightly", "campaign")
    @classmethod
    def _is_cron(cls, line: str) -> str:
        import dagster as dg  # noqa: PLC0415 - takes a second

        try:
            dg.ScheduleDefinition(job_name="rebuild", cron_schedule=line)
        except dg.DagsterInvalidDefinitionError as error:
            raise ValueError(f"{line!r} is not a cron line, such as '0 3 * * *'") from error
        return line

    @field_validator("timezone")
    @classmethod
    def _is_timezone(cls, name: str) -> str:
        if name not in available_timezones():
            raise ValueError(f"{name!r} is not a time zone, such as 'Europe/Amsterdam'")
        return name


def applied(data: Path, asked: Sequence[str] = ()) -> list[str]:
    """Names of the methods that a rebuild applies when these are asked for."""
    return methods_to_apply(Store(data), read_settings(data).methods, asked)


def read_settings(data: Path) -> Settings:
    """The settings of a data folder; those above where there is no file.

    Raises:
        MissingKnowledgeError: the file cannot be understood.
    """
    return read_settings_file(data / FILE_NAME, Settings, ", ".join(Settings.model_fields))

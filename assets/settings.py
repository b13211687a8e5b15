"""`beheer.toml`: when to rebuild, whom to mail and who helps, written by whoever runs it.

It lies in the data folder and may be left out. No setting in it can change a number of the
register; which differences between boats matter decides verdicts on types, and how far a boat may
differ on a race day the limits on its inspection sheet.
"""

import datetime as dt
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from pydantic import BaseModel, ConfigDict, Field

from pipeline.consistency.types import DIFFERENCES_THAT_MATTER
from pipeline.register.inspection import TOLERANCES
from warehouse.store.methods import methods_to_apply
from warehouse.store.settings_file import read_settings_file
from warehouse.store.store import Store

FILE_NAME: Final = "beheer.toml"


class Settings(BaseModel):
    """What `beheer.toml` can say.

    Attributes:
        methods: names of the methods that a rebuild applies; see `methods_to_apply`.
        nightly: when everything is looked at; a cron line.
        timezone: of that line.
        mail_to, mail_from: with `mail_to`, a mail about each rebuild with news and each failure
            that nobody watched.
        smtp: mail server: `smtp://user@host:587`, encrypted by STARTTLS but on this machine, or
            `smtps://user@host:465`; an @ in the user is written %40.
        smtp_password_file: a file with its password; `HERIJK_SMTP_PASSWORD` in the environment
            takes precedence.
        set_aside_share: more of the tows set aside gives a warning.
        factor_jump: a log factor that moves more gives a warning; a ratio minus 1.
        difference_cw, difference_a, difference_b: spread between boats of a type, as a ratio, from
            which they are not equal; 3 % of Cw is a minute in a race of two hours.
        tolerance_weight: by how much a boat may differ on a race day from its last weight, as a
            ratio of that weight.
        tolerance_freeboard_m, tolerance_thwart_m, tolerance_rudder_m: the same of a freeboard, the
            distance of a thwart and a size of the rudder.
        issuer: the federation, by whom certificates are issued.
        objections_to: who receives an objection to a number: a name, an address, or both.
        objections_until: the last day on which one can be made.
        objection_grounds: on which grounds, as the end of a sentence.
        site: where the site is for others, `https://...`; the QR code of certificates leads there.
        dask: scheduler of the Dask cluster that reads the seasons: `tcp://host:8786`; without it
            they are read in the process of the rebuild.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", hide_input_in_errors=True)

    methods: tuple[str, ...] = ()
    nightly: str = Field(default="0 3 * * *", pattern=r"^\S+( \S+){4}$")
    timezone: str = "Europe/Amsterdam"
    mail_to: str | None = None
    mail_from: str = "herijk@localhost"
    smtp: str = Field(
        default="smtp://localhost:25", pattern=r"^smtps?://([^:@/\s]+@)?[^:@/\s]+(:\d+)?$"
    )
    smtp_password_file: Path | None = None
    set_aside_share: float = Field(default=0.1, ge=0, le=1)
    factor_jump: float = Field(default=0.01, gt=0)
    difference_cw: float = Field(default=DIFFERENCES_THAT_MATTER["cw_standard_kg_m"], gt=0, lt=1)
    difference_a: float = Field(default=DIFFERENCES_THAT_MATTER["a_kg_m"], gt=0, lt=1)
    difference_b: float = Field(default=DIFFERENCES_THAT_MATTER["b_m_s"], gt=0, lt=1)
    tolerance_weight: float = Field(default=TOLERANCES["weight"], gt=0, lt=1)
    tolerance_freeboard_m: float = Field(default=TOLERANCES["freeboard"], gt=0, lt=1)
    tolerance_thwart_m: float = Field(default=TOLERANCES["thwart"], gt=0, lt=1)
    tolerance_rudder_m: float = Field(default=TOLERANCES["rudder"], gt=0, lt=1)
    issuer: str = ""
    objections_to: str = ""
    objections_until: dt.date | None = None
    objection_grounds: str = ""
    site: str = Field(default="", pattern=r"^(https?://\S+)?$")
    dask: str | None = Field(default=None, pattern=r"^(tcp|tls)://")


def choose_methods(data: Path, asked: Sequence[str] = ()) -> list[str]:
    """Return the names of the methods that a rebuild applies when these are asked for."""
    return methods_to_apply(Store(data), read_settings(data).methods, asked)


def read_settings(data: Path) -> Settings:
    """Read the settings of a data folder; the defaults where there is no file.

    Raises:
        MissingKnowledgeError: the file cannot be understood.
    """
    return read_settings_file(data / FILE_NAME, Settings, ", ".join(Settings.model_fields))

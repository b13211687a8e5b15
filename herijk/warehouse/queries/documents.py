"""What printed documents say: the lines of certificates, and a proposal against what counts now."""

from typing import Final

import numpy as np
import polars as pl

from herijk.pipeline.curve import cw
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.races.power import curve_of_lines
from herijk.pipeline.races.race import power_per_rower_w
from herijk.tables.row import Row
from herijk.warehouse.queries.answers import answers
from herijk.warehouse.queries.views import Views
from herijk.warehouse.store.database import no_such_edition
from herijk.words import say

CURVE: Final = dict.fromkeys(("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m"), pl.Float64())
OF_EDITION: Final = ("decision", "valid_from", "published_on", "code_version")
SPEEDS: Final = (0.85, 0.90, 0.95, 1.0, 1.05, 1.10, 1.15)
"""Speeds of the power table, as parts of the declared speed: where the curve holds."""


def certificate_lines(views: Views, edition: str, fsn_no: str | None) -> list[Row]:
    """The valid lines of an edition, of one boat or all, with what their certificates say.

    Returns:
        Rows of `answers` with the columns `OF_EDITION` of the edition, `powers`
        (speed [m/s], Cw [kg/m] and power per rower [W] over the range of the curve), and the rows
        of `curve_points` and `run_points` of the tow (`curve`, `points`).

    Raises:
        MissingKnowledgeError: there is no such edition, or no valid line of that boat in it.
    """
    lines = answers(views, edition)
    if lines.is_empty():
        raise no_such_edition(edition, views.table("register")["edition"].unique())
    wanted = lines.filter(pl.col("cw_kg_m").is_not_null())
    if fsn_no is not None:
        wanted = wanted.filter(pl.col("fsn_no").str.to_lowercase() == fsn_no.lower())
    if wanted.is_empty():
        raise MissingKnowledgeError(
            "edition {} has no valid line of {}", edition, fsn_no or say("any boat")
        )
    about = views.table("editions").filter(edition=edition)
    terms = about.select(OF_EDITION).to_dicts() or [dict.fromkeys(OF_EDITION)]
    curves, points = views.table("curve_points"), views.run_points()
    return [
        line
        | terms[0]
        | {
            "powers": _powers(line),
            "curve": _of_tow(curves, line),
            "points": _of_tow(points, line).drop_nulls("cw_kg_m"),
        }
        for line in wanted.sort("name", "fsn_no", "rowers", "crew_class").to_dicts()
    ]


def _of_tow(rows: pl.DataFrame, line: Row) -> pl.DataFrame:
    return rows.filter(method=line["method"] or "", tow_id=line["tow_id"] or "")


def _powers(line: Row) -> list[tuple[float, float, float]]:
    """Speed, Cw and power per rower, from the A and B that are printed."""
    speed = np.array(SPEEDS) * line["declared_speed_m_s"]
    a, s = curve_of_lines(pl.DataFrame([{name: line[name] for name in CURVE}], schema=CURVE))
    resistance = cw(a, s, speed)
    power = power_per_rower_w(resistance, speed, np.full(speed.shape, line["rowers"]))
    return list(zip(speed.tolist(), resistance.tolist(), power.tolist(), strict=True))

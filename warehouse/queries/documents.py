"""What printed documents say: the lines of certificates, and a proposal against what counts now."""

from collections.abc import Sequence
from typing import Final

import numpy as np
import polars as pl

from pipeline.curve import cw
from pipeline.errors import MissingKnowledgeError
from pipeline.messages import say
from pipeline.races.power import find_line_curves
from pipeline.races.race import power_per_rower_w
from pipeline.register.register import LINE
from pipeline.tables.row import Row, pick_columns
from warehouse.queries.answers import add_peers, log_known
from warehouse.queries.views import DRAFT, Views
from warehouse.store.database import make_unknown_edition_error
from warehouse.store.editions import list_edition_names, read_edition

CURVE: Final = dict.fromkeys(("declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m"), pl.Float64())
OF_EDITION: Final = ("decision", "valid_from", "published_on", "code_version")
SPEEDS: Final = (0.85, 0.90, 0.95, 1.0, 1.05, 1.10, 1.15)
"""Speeds of the power table, as parts of the declared speed: where the curve holds."""
SMOOTH_SPEEDS: Final = tuple(np.linspace(SPEEDS[0], SPEEDS[-1], 31))
"""Speeds through which the curve is drawn."""


def read_certificate_lines(views: Views, edition: str, fsn_no: str | None) -> list[Row]:
    """Return the valid lines of an edition, of one boat or all, with what their certificates say.

    All of it comes from the edition's own folder; that of a draft from the database.

    Returns:
        Rows of `register` with the boat's `name` and `boat_type`, `basis` (None in a draft), the
        columns `OF_EDITION`, `new_log_known` (whether the interval holds the error of the log),
        `from_edition`, `old_cw_kg_m` with its interval and `old_log_known` (what held before, null
        where nothing did), `peers` (Cw of the other boats of its type and class) and `others`: the
        lines of the boat's other crews.

    Raises:
        MissingKnowledgeError: there is no such edition, or no valid line of that boat in it.
    """
    lines = add_peers(_read_lines(views, edition))
    wanted = lines.filter(pl.col("cw_kg_m").is_not_null())
    if fsn_no is not None:
        wanted = wanted.filter(pl.col("fsn_no").str.to_lowercase() == fsn_no.lower())
    if wanted.is_empty():
        raise MissingKnowledgeError(
            "edition {} has no valid line of {}", edition, fsn_no or say("any boat")
        )
    known = dict(log_known(views).rows())
    about = views.table("editions").filter(edition=edition)
    terms = about.select(OF_EDITION).to_dicts() or [dict.fromkeys(OF_EDITION)]
    crews = lines.sort("rowers", "crew_class").to_dicts()
    rows = []
    for line in wanted.sort("name", "fsn_no", "rowers", "crew_class").to_dicts():
        others = []
        for other in crews:
            is_same_line = pick_columns(other, LINE) == pick_columns(line, LINE)
            if other["fsn_no"] == line["fsn_no"] and not is_same_line:
                others.append(other)
        added = {
            "new_log_known": known.get(edition),
            "old_log_known": known.get(line["from_edition"]),
            "others": others,
        }
        rows.append(line | terms[0] | added)
    return rows


def _read_lines(views: Views, edition: str) -> pl.DataFrame:
    """Return the lines of an edition or draft with their boats, and what held before."""
    if not edition.startswith(DRAFT) and edition in list_edition_names(views.store):
        read = read_edition(views.store, edition)
        lines, previous = read.register, read.manifest.previous
        before = lines.clear() if previous is None else read_edition(views.store, previous).register
    else:
        drafts = views.register().with_columns(basis=pl.lit(None, pl.String))
        lines = drafts.filter(edition=edition)
        if lines.is_empty():
            raise make_unknown_edition_error(edition, drafts["edition"].unique())
        changes = views.table("register_changes").filter(to_edition=edition)
        before = drafts.join(changes, left_on="edition", right_on="from_edition", how="semi")
    held = before.select(
        pl.col(LINE),
        pl.col("cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m").name.prefix("old_"),
        from_edition="edition",
    )
    return lines.join(held, on=LINE, how="left", maintain_order="left")


def compute_line_curve(line: Row, speeds: Sequence[float]) -> pl.DataFrame:
    """Return the curve of a line: `speed_m_s`, `cw_kg_m` and `power_w` per rower.

    Args:
        line: with the columns of `CURVE` and `rowers`.
        speeds: where, as parts of the declared speed.
    """
    speed = np.array(speeds) * line["declared_speed_m_s"]
    a, s = find_line_curves(pl.DataFrame([pick_columns(line, CURVE)], schema=CURVE))
    resistance = cw(a, s, speed)
    power = power_per_rower_w(resistance, speed, np.full(speed.shape, line["rowers"]))
    return pl.DataFrame({"speed_m_s": speed, "cw_kg_m": resistance, "power_w": power})

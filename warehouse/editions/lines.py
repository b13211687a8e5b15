"""The lines that a method gives on a day: at publication, and when an edition is made again.

Which tow counts is decided in `pipeline.register`; here the facts of its tow are put beside it, and
numbers are left out where no valid curve is.
"""

import datetime as dt
from typing import Final

import polars as pl
from pydantic import TypeAdapter

from pipeline.blocks import stack_blocks
from pipeline.errors import MissingKnowledgeError
from pipeline.method import RegisterRule
from pipeline.recompute import recompute
from pipeline.register import LINE, draft_register
from warehouse import decisions as decided
from warehouse import intake
from warehouse.editions.folder import DECISIONS, Edition
from warehouse.editions.inputs import INPUTS_HASH, tows_of_today
from warehouse.store import Store
from warehouse.tables import runs_with_windows

NUMBERS: Final = ("a_kg_m", "b_m_s", "cw_kg_m", "cw_lo_kg_m", "cw_hi_kg_m")
TOW_FACTS: Final = ("waterline_length_m", "beam_m", "bow_height_m", "weight_kg", INPUTS_HASH)
MEASURED: Final = "measured"


def method_lines(
    tables: dict[str, pl.DataFrame],
    crews: pl.DataFrame,
    valid_from: dt.date,
    rule: RegisterRule,
    decisions: pl.DataFrame,
) -> pl.DataFrame:
    """The lines of a method on a day, each with the facts of its tow; numbers only where valid."""
    draft = draft_register(tables["curves"], tables["tows"], crews, valid_from, rule, decisions)
    valid = pl.col("status") == "valid"
    return draft.join(
        tables["tows"].select("tow_id", *TOW_FACTS), on="tow_id", how="left"
    ).with_columns(
        *(pl.when(valid).then(pl.col(name)).alias(name) for name in NUMBERS),
        pl.when(valid).then(pl.lit(MEASURED)).alias("basis"),
    )


def lines_made_again(store: Store, edition: Edition) -> pl.DataFrame:
    """The lines of a published edition as archive and code of today give them.

    By its own method, decisions and day, on those of its tows that the warehouse still has.

    Raises:
        MissingKnowledgeError: it was printed, or there is no warehouse.
    """
    if edition.method is None or store.made_from("tows") is None:
        raise MissingKnowledgeError("there is no warehouse to make it from; run herijk rebuild")
    mine = edition.tables["tows"].select("tow_id")
    tows = tows_of_today(store).join(mine, on="tow_id", how="semi")
    runs = runs_with_windows(store).join(mine, on="tow_id", how="semi")
    blocks = stack_blocks(intake.all_blocks(store), runs)
    curves = recompute(edition.method, tows, blocks).curves
    nobody = pl.DataFrame(schema={name: edition.register.schema[name] for name in LINE})
    text = (store.editions / edition.about.edition / DECISIONS).read_text(encoding="utf-8")
    decisions = TypeAdapter(tuple[decided.Decision, ...]).validate_json(text)
    return method_lines(
        {"curves": curves, "tows": tows},
        nobody,
        edition.about.valid_from,
        edition.method.validity,
        decided.decision_table(decisions),
    )

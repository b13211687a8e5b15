"""The lines of an edition in time: those that it has, and the older ones that they replace."""

import polars as pl
from pydantic import TypeAdapter

from pipeline.register.register import CURVE_COLUMNS, LINE, list_lines_of_all_days
from warehouse.store import decisions as decided
from warehouse.store.editions import DECISIONS, Edition, get_edition_path, list_edition_names
from warehouse.store.store import Store


def read_decisions_of_edition(store: Store, edition: Edition) -> pl.DataFrame:
    """Return the decisions about tows with which an edition was made; for a draft those of now."""
    name = edition.manifest.edition
    if name not in list_edition_names(store):
        return decided.tabulate_decisions(decided.read_decisions(store.root / decided.FILE_NAME))
    text = (get_edition_path(store, name) / DECISIONS).read_text(encoding="utf-8")
    return decided.tabulate_decisions(TypeAdapter(tuple[decided.Decision, ...]).validate_json(text))


def list_lines_in_time(store: Store, edition: Edition) -> pl.DataFrame:
    """Return rows of `register_history`: the lines of an edition and those they replace.

    So a race of before the edition is computed with the tow that counted then.
    """
    lines = edition.register.drop_nulls("cw_kg_m")
    if edition.method is None:
        return tabulate_history(
            lines, edition.manifest.edition, lines["method"][0] if lines.height else ""
        )
    tows = edition.tables["tows"].filter(pl.col("tow_date") <= edition.manifest.valid_from)
    earlier = list_lines_of_all_days(
        edition.tables["curves"],
        tows,
        edition.method.validity,
        read_decisions_of_edition(store, edition),
    ).join(lines, on=LINE + ("tow_id",), how="anti")
    both = pl.concat([earlier, lines.select(earlier.columns)])
    return tabulate_history(both, edition.manifest.edition, edition.method.name)


def tabulate_history(lines: pl.DataFrame, edition: str, method: str) -> pl.DataFrame:
    """Return rows of `register_history`, in the order in which one line precedes another."""
    return lines.select(
        pl.lit(edition).alias("edition"),
        pl.lit(method).alias("method"),
        pl.col(LINE),
        pl.int_range(1, pl.len() + 1, dtype=pl.Int32).over(LINE).alias("position"),
        pl.col(CURVE_COLUMNS),
    ).sort(pl.col(LINE), "position")

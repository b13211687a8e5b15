"""Tables that sum up other tables: per season, per code, per second, and races replayed.

They are made after all others, so that what a page or command says of many tows together stands in
a table too. The sums are `pipeline.studies.summaries` and `pipeline.register.replay`.
"""

from collections.abc import Sequence
from typing import Final

import polars as pl

from herijk.pipeline.register.replay import RaceRules, race_changes, replay
from herijk.pipeline.studies import claims, summaries
from herijk.tables.schemas import TABLES, conform
from herijk.warehouse.archive import read_published_registers
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.store.store import Store, fingerprint, table_digest

SUMMARY_TABLES: Final = (
    "race_changes",
    "season_changes",
    "season_ladder",
    "option_summary",
    "quality_counts",
    "check_counts",
    "trace_seconds",
    "promise",
    "print_reproduction",
    "print_summary",
    "run_statistics",
)
SUMMED: Final = (
    *("tows", "register", "register_changes", "correction_steps", "option_effects"),
    "repeat_pairs",
)
SUMMED_OF_METHODS: Final = ("curves", "run_points", "assessments")
EDITIONS: Final = ("from_edition", "to_edition")


def summaries_made_from(store: Store, methods: Sequence[str]) -> str:
    """What the summaries are made from."""
    return fingerprint(
        {table: store.made_from(table) for table in SUMMED},
        {m: [store.made_from(table, m) for table in SUMMED_OF_METHODS] for m in methods},
        intake.blocks_made_from(store),
        [table_digest(store.read(table)) for table in ("listed_races", "listed_files")],
    )


def summaries_are_stale(store: Store, methods: Sequence[str]) -> bool:
    """Whether the summaries have to be made again."""
    made_from = summaries_made_from(store, methods)
    return any(store.made_from(table) != made_from for table in SUMMARY_TABLES)


def make_summaries(store: Store, methods: Sequence[str]) -> dict[str, int]:
    """Makes all summaries; the first method is the one that others are held against.

    Returns:
        Rows per table.
    """
    curves, run_points, assessments = (store.read_all(t, methods) for t in SUMMED_OF_METHODS)
    blocks, printed = intake.all_blocks(store), _printed(store, curves)
    found = {
        "race_changes": _race_changes(store),
        "season_changes": summaries.season_changes(curves, methods[0]),
        "season_ladder": summaries.season_ladder(
            store.read("correction_steps"), store.read("tows")
        ),
        "option_summary": summaries.option_summary(store.read("option_effects")),
        "quality_counts": summaries.quality_counts(curves, run_points),
        "check_counts": summaries.check_counts(assessments),
        "trace_seconds": summaries.second_means(blocks),
        "promise": claims.promise(curves, store.read("repeat_pairs")),
        "print_reproduction": printed,
        "print_summary": claims.print_summary(printed),
        "run_statistics": claims.run_statistics(blocks),
    }
    made_from = summaries_made_from(store, methods)
    for name, frame in found.items():
        store.write(name, conform(name, _cast(name, frame)), made_from)
    return {name: frame.height for name, frame in found.items()}


def _cast(name: str, frame: pl.DataFrame) -> pl.DataFrame:
    """With the declared dtypes: counts come wider than they are kept."""
    return frame.cast({c: column.dtype for c, column in TABLES[name].columns().items()})


def _printed(store: Store, curves: pl.DataFrame) -> pl.DataFrame:
    """Every printed tow under every method; no rows where the archive is not at hand."""
    root = intake.archive_root(store)
    if root is None:
        return TABLES["print_reproduction"].create_empty()
    registers, _ = read_published_registers(root)
    return claims.print_reproduction(registers, curves, store.read("tows"))


def _race_changes(store: Store) -> pl.DataFrame:
    """All races in the archive under both editions of every pair that is compared."""
    results = store.read("listed_races")
    pairs = store.read("register_changes").select(EDITIONS).unique().sort(EDITIONS)
    register = store.read("register")
    replayed = {
        edition: replay(register.filter(pl.col("edition") == edition), results, RaceRules())
        for edition in pairs.unpivot()["value"].unique()
    }
    frames = [
        race_changes(replayed[old], replayed[new]).with_columns(
            from_edition=pl.lit(old), to_edition=pl.lit(new)
        )
        for old, new in pairs.iter_rows()
    ]
    return pl.concat(frames) if frames else TABLES["race_changes"].create_empty()

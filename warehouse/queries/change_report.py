"""What changed since the last report: tows, what is set aside, log factors, lines of the drafts.

What is compared is kept beside the reports, in one small file with the hash of the database that it
is of, so a rebuild that was killed before its report is reported on by the next. Where and how a
report is shown is not decided here.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from functools import lru_cache
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.recompute.facts import with_boat_types, with_hand_windows
from pipeline.register.changes import NO_PARTS, register_changes, side_by_side
from pipeline.register.register import LINE, draft_name, with_empty_thwart
from pipeline.tables.row import Row
from pipeline.tables.schemas import TABLES
from warehouse.editions.compare import ground_of
from warehouse.editions.inputs import INPUTS_HASH, same_tows, with_input_hashes
from warehouse.store.database import open_database
from warehouse.store.files import file_sha256
from warehouse.store.store import (
    DamagedFileError,
    Store,
    metadata_of,
    read_parquet,
    write_parquet,
)

NEEDED: Final = (
    *("about", "boats", "tows", "tow_runs", "hand_windows", "quarantine"),
    *("log_factors", "methods", "register"),
)
REPORTED_ON: Final = "herijk.database"
"""What the summary says at its end: the hash of the database that it is of."""

FAULT: Final = ("path", "tow_id", "line", "reason_code", "message")
FACTOR: Final = ("method", "season")
SAME_FACTOR: Final = 5e-5
"""A log factor that moved by less did not move: it shows as 1.0000."""

Tables = dict[str, pl.DataFrame]

Inputs = tuple[dict[str, str], dict[str, str]]
"""What the tows are made from, by tow: then, and now."""


@dataclass(frozen=True)
class ChangeReport:
    """What changed since the last report.

    Attributes:
        first: there was no report before; then all tows are new and no line is compared.
        tows: `tow_id`, `fsn_no`, `season`, `what`: new, samples (its files changed), list (its row
            in a list changed) or gone.
        seasons_gone: seasons that had tows, and have none now.
        methods: `method` and `what`: new, or gone.
        set_aside: new faults (`what` is new) and those that are gone (mended).
        factors: log factors that moved: `method`, `season`, `old_factor`, `new_factor`, `ratio`.
        lines: lines of draft registers that changed, with the columns of `register_changes` and of
            `pipeline.register.changes.side_by_side`, and the boat's `name`.
    """

    first: bool
    tows: pl.DataFrame
    seasons_gone: list[int]
    methods: pl.DataFrame
    set_aside: pl.DataFrame
    factors: pl.DataFrame
    lines: pl.DataFrame

    @property
    def nothing(self) -> bool:
        """Whether nothing changed."""
        frames = (self.tows, self.methods, self.set_aside, self.factors, self.lines)
        return not self.first and all(frame.is_empty() for frame in frames)


@dataclass(frozen=True, kw_only=True)
class ChangeSummary:
    """A change report for a page, a mail or a program.

    Attributes:
        first: there was no report before.
        nothing_changed: whether that is so.
        tows, set_aside, register: how many (`number`) of each kind.
        tow_rows, set_aside_rows, factors, lines: rows of the change report.
        seasons_gone: seasons that had tows, and have none now.
        methods: those that are new or gone.
        beyond_interval: lines that move by more than both intervals.
    """

    first: bool
    nothing_changed: bool
    tows: list[Row]
    tow_rows: list[Row]
    set_aside: list[Row]
    set_aside_rows: list[Row]
    factors: list[Row]
    register: list[Row]
    beyond_interval: int
    lines: list[Row]
    seasons_gone: list[int] = field(default_factory=list)
    methods: list[Row] = field(default_factory=list)


def reported_path(store: Store) -> Path:
    """What the last report was about."""
    return store.root / "report" / "reported.parquet"


def change_report(store: Store) -> ChangeReport:
    """What changed in the database since the last report."""
    return _between(store, _reported_on(store), file_sha256(store.database))


@lru_cache(maxsize=1)
def _between(store: Store, reported_on: str | None, database: str) -> ChangeReport:
    """What changed from one database to another; kept by their hashes, as several ask."""
    now = _tables(store.database)
    was = now if reported_on == database else _reported(store)
    before = was or {name: frame.clear() for name, frame in now.items()}
    return ChangeReport(
        first=was is None,
        tows=_tows(before, now),
        seasons_gone=sorted({*before["tows"]["season"]} - {*now["tows"]["season"]}),
        methods=_came_and_went(before["methods"], now["methods"], ("method",), "gone"),
        set_aside=_came_and_went(before["quarantine"], now["quarantine"], FAULT, "mended"),
        factors=_factors(before["log_factors"], now["log_factors"]),
        lines=_lines(before, now),
    )


def is_reported(store: Store) -> bool:
    """Whether the database is the one that was reported on."""
    reported_on = _reported_on(store)
    return reported_on is not None and reported_on == file_sha256(store.database)


def _reported_on(store: Store) -> str | None:
    """Hash of the database that was reported on; None where there is none."""
    return metadata_of(reported_path(store), REPORTED_ON)


def remember(store: Store) -> None:
    """Keeps what the next report compares with: one row, in which each table is a list of rows."""
    if not is_reported(store):
        tables = {name: [frame.to_struct()] for name, frame in _tables(store.database).items()}
        about = {REPORTED_ON: file_sha256(store.database)}
        write_parquet(pl.DataFrame(tables), reported_path(store), about, {"compression": "zstd"})


def _reported(store: Store) -> Tables | None:
    """Tables of the last report; None where there is none, or it is damaged."""
    try:
        kept = read_parquet(reported_path(store))
    except (FileNotFoundError, DamagedFileError):
        return None
    tables = {name: kept[name][0].struct.unnest() for name in kept.columns}
    return tables | {"register": with_empty_thwart(tables["register"])}


def _tables(path: Path) -> Tables:
    """What a report compares, of a database."""
    with open_database(path) as db:
        db.execute("SET threads = 1")
        tables = {t: pl.DataFrame(db.sql(f'SELECT * FROM "{t}"').pl()) for t in NEEDED}  # noqa: S608
    windows, boats = tables.pop("hand_windows"), tables["boats"]
    return tables | {
        "boats": boats.select("fsn_no", "name"),
        "tows": with_boat_types(tables["tows"], boats),
        "tow_runs": with_hand_windows(tables["tow_runs"], windows),
        "quarantine": tables["quarantine"].select(FAULT),
        "log_factors": tables["log_factors"].select(*FACTOR, "factor"),
        "methods": tables["methods"].select("method", "content_hash"),
        "register": tables["register"].filter(pl.col("edition").str.starts_with(draft_name(""))),
    }


# Tows and what is set aside


def _tows(was: Tables, now: Tables) -> pl.DataFrame:
    same = same_tows(was, now)
    facts = ("tow_id", "fsn_no", "season")
    files = ("samples_sha256", "second_sha256")
    pairs = (
        was["tows"]
        .select(*facts, *files)
        .join(
            now["tows"].select(*facts, *files),
            on="tow_id",
            how="full",
            coalesce=True,
            maintain_order="left_right",
        )
        .filter(~pl.col("tow_id").is_in(list(same)))
    )
    same_files = pl.all_horizontal(pl.col(f).eq_missing(pl.col(f"{f}_right")) for f in files)
    what = (
        pl.when(pl.col("season").is_null())
        .then(pl.lit("new"))
        .when(pl.col("season_right").is_null())
        .then(pl.lit("gone"))
        .when(same_files)
        .then(pl.lit("list"))
        .otherwise(pl.lit("samples"))
    )
    return pairs.select(
        "tow_id",
        pl.coalesce("fsn_no_right", "fsn_no").alias("fsn_no"),
        pl.coalesce("season_right", "season").alias("season"),
        what.alias("what"),
    ).sort("tow_id")


def _came_and_went(
    was: pl.DataFrame, now: pl.DataFrame, key: Sequence[str], went: str
) -> pl.DataFrame:
    """Rows by their key that are new, and those that are there no more; `what` says which."""
    parts = ((now, was, "new"), (was, now, went))
    return pl.concat(
        mine.select(key)
        .join(other, on=key, how="anti", nulls_equal=True)
        .with_columns(pl.lit(what).alias("what"))
        for mine, other, what in parts
    ).sort("what", *key)


def _factors(was: pl.DataFrame, now: pl.DataFrame) -> pl.DataFrame:
    pairs = was.select(*FACTOR, old_factor="factor").join(
        now.select(*FACTOR, new_factor="factor"), on=FACTOR, maintain_order="left"
    )
    ratio = pl.col("new_factor") / pl.col("old_factor")
    return (
        pairs.with_columns(ratio.alias("ratio"))
        .filter((pl.col("ratio") - 1.0).abs() > SAME_FACTOR)
        .sort(FACTOR)
    )


# Lines of the draft registers


def _lines(was: Tables, now: Tables) -> pl.DataFrame:
    inputs = _input_hashes(was), _input_hashes(now)
    drafts = [_draft_lines(was, now, method, inputs) for method in now["methods"]["method"]]
    unknown = pl.lit(None, pl.Boolean).alias("exceeds_interval")
    none = TABLES["register_changes"].create_empty().with_columns(unknown)
    known = [draft for draft in drafts if draft is not None]
    return pl.concat(known or [none], how="diagonal_relaxed")


def _draft_lines(was: Tables, now: Tables, method: str, inputs: Inputs) -> pl.DataFrame | None:
    """Lines of a method's draft that changed; None where one of the two has no such draft."""
    edition = draft_name(method)
    old, new = (tables["register"].filter(edition=edition) for tables in (was, now))
    if old.is_empty() or new.is_empty():
        return None
    grounds = _grounds(
        was, now, method, inputs, old.join(new, on=LINE, suffix="_new", maintain_order="left")
    )
    names = now["boats"].select("fsn_no", "name")
    return (
        register_changes(old, new, NO_PARTS, grounds)
        .filter(pl.col("change") != "same")
        .join(side_by_side(old, new), on=LINE, maintain_order="left")
        .join(names, on="fsn_no", how="left", maintain_order="left")
        .sort(LINE)
    )


def _grounds(
    was: Tables, now: Tables, method: str, inputs: Inputs, pairs: pl.DataFrame
) -> pl.DataFrame:
    """Per line why it can have changed: another tow, its input, other tows, method or code."""
    hashes = [
        tables["methods"].filter(method=method)["content_hash"].to_list() for tables in (was, now)
    ]
    versions = [dict(tables["about"].rows())["code_version"] for tables in (was, now)]
    others = inputs[0] != inputs[1]
    redefined, new_code = hashes[0] != hashes[1], versions[0] != versions[1]
    grounds = [
        ground_of(inputs[0].get(new) != inputs[1].get(new), others, redefined, new_code)
        if old == new
        else "tow"
        for old, new in pairs.select("tow_id", "tow_id_new").rows()
    ]
    return pairs.select(LINE).with_columns(pl.Series("ground", grounds, pl.String))


def _input_hashes(tables: Tables) -> dict[str, str]:
    hashed = with_input_hashes(tables["tows"], tables["tow_runs"])
    return dict(hashed.select("tow_id", INPUTS_HASH).rows())


# The summary


def last_changes(store: Store) -> ChangeSummary | None:
    """What changed since the last report; where nothing did, what the last change was."""
    report = change_report(store)
    if not report.nothing:
        return summary_of(report)
    told = sorted((store.root / "report").glob("2*.json"))
    if not told:
        return None
    last = json.loads(told[-1].read_text(encoding="utf-8"))
    known = {f.name for f in fields(ChangeSummary)}
    return ChangeSummary(**{name: value for name, value in last.items() if name in known})


def summary_of(report: ChangeReport) -> ChangeSummary:
    """The report for a page, a mail or a program."""
    return ChangeSummary(
        first=report.first,
        nothing_changed=report.nothing,
        tows=_counted(report.tows, ["what"]),
        tow_rows=[] if report.first else report.tows.to_dicts(),
        set_aside=_counted(report.set_aside, ["what", "reason_code"]),
        set_aside_rows=report.set_aside.to_dicts(),
        factors=report.factors.to_dicts(),
        register=_counted(report.lines, ["to_edition", "change"]),
        beyond_interval=int(report.lines["exceeds_interval"].fill_null(False).sum()),
        lines=report.lines.to_dicts(),
        seasons_gone=report.seasons_gone,
        methods=[] if report.first else report.methods.to_dicts(),
    )


def _counted(frame: pl.DataFrame, by: Sequence[str]) -> list[Row]:
    return frame.group_by(by, maintain_order=True).agg(pl.len().alias("number")).sort(by).to_dicts()

"""What changed since the last report: tows, what is set aside, log factors, lines of the drafts.

The tables that were reported on are kept beside the reports, so a rebuild that was killed before
its report is reported on by the next. Where and how a report is shown is not decided here.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path
from typing import Final

import polars as pl

from pipeline.recompute.facts import add_boat_types, add_hand_windows
from pipeline.register.causes import name_grounds
from pipeline.register.changes import compare_lines
from pipeline.register.register import LINE, MEASURED, choose_default_method, name_draft
from pipeline.tables.row import Row
from warehouse.editions.inputs import find_same_tows
from warehouse.store.code import code_version
from warehouse.store.database import DATABASE_TABLE
from warehouse.store.files import write_folder_beside
from warehouse.store.store import DamagedFileError, Store, read_parquet, write_parquet

NEEDED: Final = (
    "about",
    "tows",
    "tow_runs",
    "quarantine",
    "log_factors",
    "methods",
    "editions",
    "register",
)
FAULT: Final = ("path", "tow_id", "line", "reason_code", "message")
FACTOR: Final = ("method", "season")
FILES: Final = ("samples_sha256", "second_sha256")
STATUSES: Final = ("accepted", "flagged", "rejected")
"""Statuses of a curve: sound, to be looked at, and without a number that counts."""
SAME_FACTOR: Final = 5e-5
"""A log factor that moved by less did not move: it shows as 1.0000."""

Tables = dict[str, pl.DataFrame]


@dataclass(frozen=True, kw_only=True)
class ChangeReport:
    """What changed since the last report, as rows for a page, a mail or a program.

    Attributes:
        first: there was no report before; then all tows are new and no line is compared.
        tows: `tow_id`, `fsn_no`, `season`, `what`: new, samples (its files changed), list (its row
            in a list changed) or gone.
        seasons_gone: seasons that had tows, and have none now.
        editions: `edition` and `what`: new, or gone; none in a first report.
        methods: `method` and `what`: new, or gone; none in a first report.
        set_aside: new faults (`what` is new) and those that are gone (mended).
        factors: log factors that moved: `method`, `season`, `old_factor`, `new_factor`, `ratio`.
        lines: lines of draft registers that changed, as `pipeline.register.changes.compare_lines`
            has them, with the boat's `name`.
        judged: the method that is shown first, as `method`, and how many of its tows are
            `accepted`, `flagged` and `rejected` now, changed or not; and the tows that a person
            accepted and a check doubts since, as `doubted`.
    """

    first: bool
    tows: list[Row]
    seasons_gone: list[int]
    editions: list[Row]
    methods: list[Row]
    set_aside: list[Row]
    factors: list[Row]
    lines: list[Row]
    judged: Row

    @property
    def nothing(self) -> bool:
        """Whether nothing changed."""
        changes = (self.tows, self.editions, self.methods, self.set_aside, self.factors, self.lines)
        return not self.first and not any(changes)

    @property
    def beyond_interval(self) -> list[Row]:
        """Lines that move by more than both intervals."""
        return [line for line in self.lines if line["exceeds_interval"]]


def get_reported_path(store: Store) -> Path:
    """Return the folder with the tables of the last report."""
    return store.root / "report" / "last"


def change_report(store: Store) -> ChangeReport:
    """Return the changes of the tables since the last report."""
    return _compare_states(store, _read_reported_state(store), store.contents(DATABASE_TABLE))


def is_reported(store: Store) -> bool:
    """Return whether the tables are those that were reported on."""
    return _read_reported_state(store) == store.contents(DATABASE_TABLE)


def remember(store: Store) -> None:
    """Keep what the next report compares with."""
    if not is_reported(store):
        with write_folder_beside(get_reported_path(store)) as beside:
            for name, frame in _read_today(store).items():
                write_parquet(frame, beside / f"{name}.parquet")


def _read_reported_state(store: Store) -> str | None:
    """Return the contents of the database that was reported on; None where nothing was."""
    reported = _read_reported(store, ("about",))
    return None if reported is None else str(reported["about"]["database"][0])


def _read_reported(store: Store, names: Sequence[str] = NEEDED) -> Tables | None:
    """Return tables of the last report; None where there is none, or it is damaged."""
    try:
        return {name: read_parquet(get_reported_path(store) / f"{name}.parquet") for name in names}
    except (FileNotFoundError, DamagedFileError):
        return None


def _read_today(store: Store) -> Tables:
    """Return the tables of the lake that a report compares."""
    tables = {n: store.read(n) for n in ("boats", "tows", "tow_runs", "hand_windows", "methods")}
    about = {"code_version": code_version(), "database": store.contents(DATABASE_TABLE)}
    is_draft = pl.col("edition").str.starts_with(name_draft(""))
    return {
        "about": pl.DataFrame([about]),
        "tows": add_boat_types(tables["tows"], tables["boats"]),
        "tow_runs": add_hand_windows(tables["tow_runs"], tables["hand_windows"]),
        "quarantine": store.read("quarantine", columns=FAULT),
        "log_factors": store.read("log_factors"),
        "methods": tables["methods"],
        "editions": store.read("editions", columns=["edition"]),
        "register": store.read("register").filter(is_draft),
    }


@lru_cache(maxsize=1)
def _compare_states(store: Store, was_state: object, now_state: object) -> ChangeReport:
    """Compare two states of the tables; cached, as several ask."""
    now = _read_today(store)
    was = now if was_state == now_state else _read_reported(store)
    before = was or {name: frame.clear() for name, frame in now.items()}
    methods = _list_new_and_gone(before["methods"], now["methods"], ("method",), "gone")
    editions = _list_new_and_gone(before["editions"], now["editions"], ("edition",), "gone")
    faults = _list_new_and_gone(before["quarantine"], now["quarantine"], FAULT, "mended")
    return ChangeReport(
        first=was is None,
        tows=_compare_tows(before, now).to_dicts(),
        seasons_gone=sorted(set(before["tows"]["season"]) - set(now["tows"]["season"])),
        editions=[] if was is None else editions.to_dicts(),
        methods=[] if was is None else methods.to_dicts(),
        set_aside=faults.to_dicts(),
        factors=_compare_factors(before["log_factors"], now["log_factors"]).to_dicts(),
        lines=_compare_drafts(before, now, store.read("boats").select("fsn_no", "name")),
        judged=count_statuses(store),
    )


def count_statuses(store: Store) -> Row:
    """Return how many tows the method that is shown first accepts, flags and rejects.

    And which tows that a person accepted it doubts since.
    """
    method = choose_default_method(store.read("methods")["method"].to_list())
    statuses = store.read("curves", method, columns=["status"])["status"]
    counts = {name: int((statuses == name).sum()) for name in STATUSES}
    acceptances = store.read("acceptances", method)
    doubted = acceptances.filter(pl.col("doubted_by").list.len() > 0)["tow_id"].to_list()
    return {"method": method} | counts | {"doubted": doubted}


def _compare_tows(was: Tables, now: Tables) -> pl.DataFrame:
    """Return tows that came, went, or are made from other files or facts."""
    facts = ("tow_id", "fsn_no", "season") + FILES
    pairs = (
        was["tows"]
        .select(facts)
        .join(
            now["tows"].select(facts),
            on="tow_id",
            how="full",
            coalesce=True,
            maintain_order="left_right",
        )
        .filter(~pl.col("tow_id").is_in(list(find_same_tows(was, now))))
    )
    same_files = pl.all_horizontal(pl.col(f).eq_missing(pl.col(f"{f}_right")) for f in FILES)
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
        fsn_no=pl.coalesce("fsn_no_right", "fsn_no"),
        season=pl.coalesce("season_right", "season"),
        what=what,
    ).sort("tow_id")


def _list_new_and_gone(
    was: pl.DataFrame, now: pl.DataFrame, key: Sequence[str], went: str
) -> pl.DataFrame:
    """Return the rows that are new and those that are gone, by their key; `what` says which."""
    new = now.select(key).join(was, on=key, how="anti", nulls_equal=True)
    gone = was.select(key).join(now, on=key, how="anti", nulls_equal=True)
    both = pl.concat([new.with_columns(what=pl.lit("new")), gone.with_columns(what=pl.lit(went))])
    return both.sort("what", pl.col(key))


def _compare_factors(was: pl.DataFrame, now: pl.DataFrame) -> pl.DataFrame:
    pairs = was.select(pl.col(FACTOR), old_factor="factor").join(
        now.select(pl.col(FACTOR), new_factor="factor"), on=FACTOR, maintain_order="left"
    )
    ratio = pl.col("new_factor") / pl.col("old_factor")
    moved = (ratio - 1.0).abs() > SAME_FACTOR
    return pairs.filter(moved).with_columns(ratio.alias("ratio")).sort(FACTOR)


def _compare_drafts(was: Tables, now: Tables, names: pl.DataFrame) -> list[Row]:
    """Return lines that changed, of every draft before or now, with the name of the boat."""
    same = find_same_tows(was, now)
    others = any(tables["tows"].height > len(same) for tables in (was, now))
    code = not was["about"]["code_version"].equals(now["about"]["code_version"])
    old_hashes = dict(was["methods"].select("method", "content_hash").iter_rows())
    new_hashes = dict(now["methods"].select("method", "content_hash").iter_rows())
    changed = []
    for method in now["methods"]["method"]:
        draft = name_draft(method)
        old = was["register"].filter(edition=draft)
        new = now["register"].filter(edition=draft)
        if old.is_empty() or new.is_empty():
            continue
        redefined = old_hashes.get(method) != new_hashes.get(method)
        old = old.with_columns(basis=pl.lit(MEASURED))
        new = new.with_columns(basis=pl.lit(MEASURED))
        ground = name_grounds(old, new, same, others=others, method=redefined, code=code)
        lines = compare_lines(old, new, grounds=ground).filter(pl.col("change") != "same")
        named = lines.join(names, on="fsn_no", how="left", maintain_order="left")
        changed += named.sort(LINE).to_dicts()
    return changed


def read_last_changes(store: Store) -> ChangeReport | None:
    """Return the changes since the last report or, where there are none, the last ones."""
    report = change_report(store)
    if not report.nothing:
        return report
    reports = sorted((store.root / "report").glob("2*.json"))
    if not reports:
        return None
    last = json.loads(reports[-1].read_text(encoding="utf-8"))
    known = {f.name: last.get(f.name, []) for f in fields(ChangeReport)}
    return ChangeReport(**known | {"judged": count_statuses(store)})

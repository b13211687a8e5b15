"""Making the tables of the contract from the lake, each with the fingerprint of what made it.

A function here reads tables, calls one thing in `pipeline`, checks the result against its schema
and writes it. `stale_*` and `*_made_from` say what has to be done again. Nothing is computed here.
"""

import dataclasses
import datetime as dt
from collections.abc import Mapping, Sequence
from typing import Final

import duckdb
import polars as pl

from herijk.pipeline.blocks.run_blocks import RunBlocks, stack_blocks
from herijk.pipeline.consistency import consistency_tables
from herijk.pipeline.errors import MissingKnowledgeError
from herijk.pipeline.method.definition import Method
from herijk.pipeline.recompute.recompute import recompute
from herijk.pipeline.recompute.results import Recomputed
from herijk.pipeline.register.changes import register_changes
from herijk.pipeline.register.register import LINE, draft_name, draft_register
from herijk.pipeline.steps.window import HAND_COLUMNS
from herijk.pipeline.studies.ladder import ladder
from herijk.pipeline.studies.options import beside_uncertainty, option_effects
from herijk.pipeline.uncertainty.ensemble import as_frame, register_ensemble
from herijk.tables.archive import Quarantine
from herijk.tables.schemas import TABLES, conform
from herijk.warehouse.archive import Fault, outside_run
from herijk.warehouse.build.due import due_made_from, due_rows
from herijk.warehouse.build.summaries import SUMMARY_TABLES
from herijk.warehouse.editions.published import published_made_from, published_tables
from herijk.warehouse.intake import seasons as intake
from herijk.warehouse.store.code import code_version
from herijk.warehouse.store.database import build_database, open_database
from herijk.warehouse.store.files import file_sha256
from herijk.warehouse.store.store import Store, fingerprint, table_digest

ARCHIVE_TABLES: Final = ("boats", "seasons", "tows", "tow_runs", "hand_windows", "quarantine")
METHOD_TABLES: Final = (
    "run_points",
    "curves",
    "log_factors",
    "season_links",
    "retow_choice",
    "season_steps",
    "uncertainty_budget",
    "curve_points",
    "assessments",
)
METHOD_FILES: Final = ("ensemble",)
"""Tables of a method that stay in the lake, next to the database: 200 rows a tow would make up most
of it, and few readers want them."""

STUDY_TABLES: Final = ("correction_steps", "option_effects")
STUDIED_METHOD: Final = "rebased"
"""The method whose options of judgement are studied."""

REGISTER_TABLES: Final = (
    "register",
    "due_list",
    "editions",
    "register_changes",
    "lineage",
    "methods",
)
CONSISTENCY_TABLES: Final = (
    "type_consistency",
    "type_lines",
    "type_line_points",
    "compared_tows",
    "hull_speed",
    "type_outliers",
    "type_homogeneity",
    "pooled_curves",
    "speed_trend",
    "slow_tows",
    "repeat_pairs",
    "era_shifts",
    "reproducibility",
    "variance_components",
    "predicted_cw",
    "prediction_error",
)

WHOLE_TABLES: Final = (
    *ARCHIVE_TABLES,
    *STUDY_TABLES,
    *REGISTER_TABLES,
    *CONSISTENCY_TABLES,
    *SUMMARY_TABLES,
)
"""Tables in one piece; those of `METHOD_TABLES` have a partition per method."""


def archive_made_from(store: Store) -> str:
    """What the tables about the archive are made from."""
    seasons = {s: store.made_from("season_index", s) for s in store.partitions("season_index")}
    read = ("listed_boats", "listed_windows", "list_faults")
    lists = [table_digest(store.read(t)) for t in read]
    return fingerprint(seasons, lists, code_version())


def archive_is_stale(store: Store) -> bool:
    """Whether boats, tows or set-aside rows have to be collected again."""
    made_from = archive_made_from(store)
    return any(store.made_from(t) != made_from for t in ARCHIVE_TABLES)


def collect_archive(store: Store, today: dt.date) -> dict[str, int]:
    """Boats, sound tows with their runs and windows, and everything that was set aside.

    Returns:
        Rows per table.

    Raises:
        MissingKnowledgeError: no tow is sound.
    """
    made_from = archive_made_from(store)
    if not store.partitions("season_index"):
        found = {"quarantine": _quarantine(store, [store.read("list_faults")], today)}
        raise _nothing_sound(store, found, made_from)
    index = store.read_all("season_index")
    sound = index.filter(pl.col("reason_code").is_null()).select("tow_id")
    tows = store.read_all("season_tows").join(sound, on="tow_id", how="semi")
    present = intake.present_runs(store)
    runs = store.read_all("season_runs").join(present, on=["tow_id", "run"], how="semi")
    windows = store.read("listed_windows").join(runs, on=["tow_id", "run"], how="semi")
    beyond = _as_faults(outside_run(windows, present))
    unsound = index.filter(pl.col("reason_code").is_not_null()).select(list(intake.FAULT_SCHEMA))
    found = {
        "boats": store.read("listed_boats"),
        "seasons": _seasons(store.read_all("season_tows"), sound),
        "tows": tows,
        "tow_runs": runs,
        "hand_windows": windows.join(
            beyond, left_on=_LISTED_AT, right_on=["path", "line"], how="anti"
        ),
        "quarantine": _quarantine(store, [store.read("list_faults"), beyond, unsound], today),
    }
    if tows.is_empty():
        raise _nothing_sound(store, found, made_from)
    for name, frame in found.items():
        store.write(name, conform(name, frame), made_from)
    return {name: frame.height for name, frame in found.items()}


def _seasons(listed: pl.DataFrame, sound: pl.DataFrame) -> pl.DataFrame:
    """How many tows each season lists, and how many of them can be used."""
    is_sound = pl.col("tow_id").is_in(sound["tow_id"].implode())
    return listed.group_by("season").agg(
        pl.len().cast(pl.Int32).alias("listed"), is_sound.sum().cast(pl.Int32).alias("tows")
    )


def _nothing_sound(
    store: Store, found: Mapping[str, pl.DataFrame], made_from: str
) -> MissingKnowledgeError:
    """Keeps what is set aside, also for readers of a first database, and gives the error."""
    faults = conform("quarantine", found["quarantine"])
    store.write("quarantine", faults, made_from)
    if not store.database.exists():
        kept = {name: conform(name, frame) for name, frame in found.items()}
        build_database(store.database, _all_empty() | kept | {"about": _about(store)})
    if faults.is_empty():
        return MissingKnowledgeError(
            "no tow can be used: the tow lists hold none in the seasons that were read; "
            "fill sleeplijsten/sleeplijst_<jaar>.csv, or widen --seasons"
        )
    causes = faults["reason_code"].value_counts(sort=True).sort("count", descending=True).rows()
    counted = ", ".join(f"{number} x {reason}" for reason, number in causes)
    first = faults.row(0, named=True)
    return MissingKnowledgeError(
        f"no tow can be used: {faults.height} rows or files are set aside ({counted}). "
        f"All stand in the table quarantine. See them by cause with: herijk check ARCHIVE. "
        f"The first: {first['path']}: {first['message']}"
    )


def _all_empty() -> dict[str, pl.DataFrame]:
    return {name: schema.create_empty() for name, schema in TABLES.items()}


_LISTED_AT: Final = ["list_path", "list_line"]


def _as_faults(faults: Sequence[Fault]) -> pl.DataFrame:
    return pl.DataFrame([dataclasses.asdict(f) for f in faults], schema=intake.FAULT_SCHEMA)


def _quarantine(store: Store, parts: Sequence[pl.DataFrame], today: dt.date) -> pl.DataFrame:
    """All faults; one that was there before keeps the day on which it was first seen."""
    key = ["path", "tow_id", "line", "reason_code"]
    first = _seen_before(store).group_by(key).agg(pl.col("first_seen").min())
    return (
        pl.concat(parts)
        .join(first, on=key, how="left", nulls_equal=True)
        .with_columns(pl.col("first_seen").fill_null(today))
    )


def _seen_before(store: Store) -> pl.DataFrame:
    """What was set aside before; from the database where the lake's table is lost."""
    if store.made_from("quarantine") is not None:
        return store.read("quarantine")
    try:
        with open_database(store.database) as db:
            return pl.DataFrame(db.sql("FROM quarantine").pl())
    except (MissingKnowledgeError, duckdb.Error):  # not made yet, or damaged too
        return Quarantine.create_empty()


def method_made_from(store: Store, method: Method) -> str:
    """What the tables of a method are made from."""
    return fingerprint(
        method.name,
        method.content_hash,
        store.made_from("tows"),
        intake.blocks_made_from(store),
        code_version(),
    )


def method_is_stale(store: Store, method: Method) -> bool:
    """Whether a method has to be applied again."""
    made_from = method_made_from(store, method)
    names = (*METHOD_TABLES, *METHOD_FILES)
    return any(store.made_from(t, method.name) != made_from for t in names)


def runs_with_windows(store: Store) -> pl.DataFrame:
    """The runs of all sound tows, with the windows that were given by hand."""
    windows = store.read("hand_windows").rename(HAND_COLUMNS)
    return store.read("tow_runs").join(windows, on=["tow_id", "run"], how="left")


def run_blocks(store: Store) -> RunBlocks:
    """The runs of all sound tows as arrays, with the windows that were given by hand."""
    return stack_blocks(intake.all_blocks(store), runs_with_windows(store))


def typed_tows(store: Store) -> pl.DataFrame:
    """All sound tows with the type of their boat."""
    types = store.read("boats").select("fsn_no", "boat_type")
    return store.read("tows").join(types, on="fsn_no", how="left")


def apply_method(store: Store, method: Method, blocks: RunBlocks) -> dict[str, pl.DataFrame]:
    """Run points, curves, log factors, assessments and members of all tows under one method.

    Returns:
        The tables written, by name.
    """
    made_from = method_made_from(store, method)
    result = recompute(method, typed_tows(store), blocks)
    tables = {name: getattr(result, name) for name in METHOD_TABLES}
    tables["ensemble"] = ensemble_of(method, result)
    found = {name: conform(name, frame) for name, frame in tables.items()}
    for name, frame in found.items():
        store.write(name, frame, made_from, method.name)
    return found


def ensemble_of(method: Method, result: Recomputed) -> pl.DataFrame:
    """Equally likely values of every curve's Cw, 200 rows a tow."""
    tows = result.curves.drop_nulls("cw_kg_m").select("tow_id", "cw_kg_m")
    members = register_ensemble(tows, result.uncertainty_budget, result.factors)
    return as_frame(tows, members).with_columns(pl.lit(method.name).alias("method"))


def studies_made_from(store: Store, methods: Sequence[Method]) -> str:
    """What the ladders and the option study are made from."""
    return fingerprint({m.name: method_made_from(store, m) for m in methods})


def studies_are_stale(store: Store, methods: Sequence[Method]) -> bool:
    """Whether ladders and option study have to be made again."""
    made_from = studies_made_from(store, methods)
    return any(store.made_from(t) != made_from for t in STUDY_TABLES)


def make_studies(store: Store, methods: Sequence[Method], blocks: RunBlocks) -> dict[str, int]:
    """The ladder from the first method to each other, and the study of judgement options.

    Returns:
        Rows per table.
    """
    tows, first = store.read("tows"), methods[0]
    links = {m.name: store.read("season_links", m.name) for m in methods}
    ladders = [
        ladder(first, other, tows, blocks, (links[first.name], links[other.name])).with_columns(
            pl.lit(first.name).alias("from_method"), pl.lit(other.name).alias("to_method")
        )
        for other in methods[1:]
    ]
    studied = [
        beside_uncertainty(
            option_effects(m, tows, blocks, links[m.name]), store.read("curves", m.name)
        ).with_columns(pl.lit(m.name).alias("method"))
        for m in methods
        if m.name == STUDIED_METHOD
    ]
    found = {
        "correction_steps": pl.concat(ladders) if ladders else _empty("correction_steps"),
        "option_effects": pl.concat(studied) if studied else _empty("option_effects"),
    }
    made_from = studies_made_from(store, methods)
    for name, frame in found.items():
        store.write(name, conform(name, frame), made_from)
    return {name: frame.height for name, frame in found.items()}


def consistency_made_from(store: Store, methods: Sequence[Method]) -> str:
    """What the statistics of boat types are made from: races too; not editions or decisions."""
    curves = {m.name: store.made_from("curves", m.name) for m in methods}
    archive = [store.made_from(t) for t in ("tows", "boats")]
    return fingerprint(curves, archive, table_digest(store.read("listed_races")), code_version())


def consistency_is_stale(store: Store, methods: Sequence[Method]) -> bool:
    """Whether the statistics of boat types have to be made again."""
    made_from = consistency_made_from(store, methods)
    return any(store.made_from(t) != made_from for t in CONSISTENCY_TABLES)


def make_consistency(store: Store, methods: Sequence[Method]) -> dict[str, int]:
    """Are equal boats equal: the statistics of every boat type under every method.

    Returns:
        Rows per table.
    """
    names = [m.name for m in methods]
    curves, run_points = (store.read_all(t, names) for t in ("curves", "run_points"))
    tows, boats, races = (store.read(t) for t in ("tows", "boats", "listed_races"))
    found = consistency_tables(curves, tows, boats, run_points, races)
    made_from = consistency_made_from(store, methods)
    for name in CONSISTENCY_TABLES:
        store.write(name, conform(name, found[name]), made_from)
    return {name: found[name].height for name in CONSISTENCY_TABLES}


def register_made_from(store: Store, methods: Sequence[Method]) -> str:
    """What the registers and comparisons of registers are made from."""
    curves = {m.name: [store.made_from("curves", m.name), str(m.validity)] for m in methods}
    archive = [store.made_from(t) for t in ("tows", "boats")]
    beside = [published_made_from(store), due_made_from(store)]
    return fingerprint(curves, archive, beside, code_version())


def register_is_stale(store: Store, methods: Sequence[Method]) -> bool:
    """Whether registers and comparisons of registers have to be made again."""
    made_from = register_made_from(store, methods)
    return any(store.made_from(t) != made_from for t in REGISTER_TABLES)


def make_registers(store: Store, methods: Sequence[Method]) -> dict[str, int]:
    """A draft register per method, its due list, what changes, and the published editions.

    Validity is judged on the day of the archive's last tow, not today: so the same archive gives
    the same tables. Drafts are compared with the first method's.

    Returns:
        Rows per table.
    """
    tows, crews = store.read("tows"), store.read("listed_boats")
    curves = store.read_all("curves", [m.name for m in methods])
    on_date = max(tows["tow_date"])
    drafts = [
        _as_edition(m, draft_register(_of(curves, m), tows, crews, on_date, m.validity))
        for m in methods
    ]
    register = pl.concat(drafts)
    published = published_tables(store)
    changes = [register_changes(drafts[0], draft) for draft in drafts[1:]]
    found = {
        "register": register,
        "due_list": due_rows(store, methods, curves),
        "register_changes": pl.concat(changes) if changes else _empty("register_changes"),
        "lineage": _lineage(register, tows, methods),
        "methods": _methods(methods),
        "editions": _empty("editions"),
    }
    made_from = register_made_from(store, methods)
    for name, frame in found.items():
        rows = conform(name, frame)
        if name in published:
            rows = conform(name, pl.concat([rows, published[name]]))
        store.write(name, rows, made_from)
    return {name: frame.height for name, frame in found.items()}


def _empty(name: str) -> pl.DataFrame:
    return TABLES[name].create_empty()


def _of(curves: pl.DataFrame, method: Method) -> pl.DataFrame:
    return curves.filter(pl.col("method") == method.name)


def _as_edition(method: Method, register: pl.DataFrame) -> pl.DataFrame:
    edition, name = pl.lit(draft_name(method.name)), pl.lit(method.name)
    code = pl.lit(None, pl.String).alias("verification_code")
    return register.select(edition.alias("edition"), name.alias("method"), pl.all(), code)


def _lineage(register: pl.DataFrame, tows: pl.DataFrame, methods: Sequence[Method]) -> pl.DataFrame:
    """The files behind every line that has a tow."""
    first = tows.select("tow_id", path="samples_path", sha256="samples_sha256")
    second = tows.select("tow_id", path="second_path", sha256="second_sha256").drop_nulls()
    hashes = pl.DataFrame(
        {"method": [m.name for m in methods], "method_hash": [m.content_hash for m in methods]}
    )
    lines = register.drop_nulls("tow_id").select("edition", *LINE, "tow_id", "method")
    return (
        lines.join(pl.concat([first, second]), on="tow_id")
        .join(hashes, on="method")
        .with_columns(pl.lit(code_version()).alias("code_version"))
    )


def _methods(methods: Sequence[Method]) -> pl.DataFrame:
    return pl.DataFrame(
        {
            "method": [m.name for m in methods],
            "title": [m.title for m in methods],
            "title_en": [m.title_en for m in methods],
            "content_hash": [m.content_hash for m in methods],
            "definition": [m.definition for m in methods],
        }
    )


def database_made_from(store: Store, methods: Sequence[Method]) -> str:
    """What the database is made from."""
    return fingerprint(
        {t: store.made_from(t) for t in WHOLE_TABLES},
        {m.name: [store.made_from(t, m.name) for t in METHOD_TABLES] for m in methods},
    )


def make_database(store: Store, methods: Sequence[Method]) -> dict[str, int]:
    """Puts all tables in one database file and swaps it in.

    Returns:
        Rows per table.
    """
    found = {t: store.read(t) for t in WHOLE_TABLES}
    for table in METHOD_TABLES:
        found[table] = conform(table, store.read_all(table, [m.name for m in methods]))
    found["about"] = _about(store)
    found["contents"] = _contents(found)
    build_database(store.database, found)
    made = pl.DataFrame({"sha256": [file_sha256(store.database)]})
    store.write("database", made, database_made_from(store, methods))
    return {name: frame.height for name, frame in found.items()}


def _about(store: Store) -> pl.DataFrame:
    about = {
        "simulated": str(store.read("about_archive")["simulated"][0]).lower(),
        "code_version": code_version(),
    }
    return pl.DataFrame({"key": list(about), "value": list(about.values())})


def _contents(found: Mapping[str, pl.DataFrame]) -> pl.DataFrame:
    """Every table with its rows and meaning, for those who open the database."""
    names = sorted(set(found) & set(TABLES))
    return pl.DataFrame(
        {
            "table": names,
            "rows": [found[name].height for name in names],
            "meaning": [TABLES[name].__doc__ for name in names],
        }
    )


def database_is_stale(store: Store, methods: Sequence[Method]) -> bool:
    """Whether the database has to be built again, also because it was damaged since."""
    if not store.database.exists():
        return True
    if store.made_from("database") != database_made_from(store, methods):
        return True
    return store.read("database")["sha256"].to_list() != [file_sha256(store.database)]


def unaccounted_tows(store: Store) -> list[str]:
    """Listed tows of the seasons read that are neither accepted nor set aside: there are none."""
    listed = store.read_all("season_tows")
    known = pl.concat([store.read(t).select("tow_id") for t in ("tows", "quarantine")])
    lost: list[str] = listed.join(known, on="tow_id", how="anti")["tow_id"].to_list()
    return lost


def ladders_multiply(steps: pl.DataFrame) -> bool:
    """Whether the factors of every ladder multiply to its total, within 1e-10."""
    ends = (
        steps.sort("position")
        .group_by("from_method", "to_method", "tow_id")
        .agg(
            pl.col("factor").product(),
            (pl.col("cw_kg_m").last() / pl.col("cw_kg_m").first()).alias("total"),
        )
    )
    worst = (ends["factor"] / ends["total"] - 1.0).abs().max()
    return worst is None or float(str(worst)) < 1e-10

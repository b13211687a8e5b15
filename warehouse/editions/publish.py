"""Publishing: from the tables of a method, or from a printed register, to a frozen edition.

Which tow counts is decided in `pipeline.register`, how sheets look in `sheets`, how a folder
appears whole or not at all in `folder`. Only a person publishes: the name, the day from which it
counts and the decision are handed in, and so is the day of publication.
"""

import datetime as dt
import hashlib
import io
import json
from dataclasses import dataclass
from typing import Final

import numpy as np
import polars as pl

from pipeline.curve import cw, rebase, s_of_b
from pipeline.errors import MissingKnowledgeError
from pipeline.method import Method, RegisterRule, method_text
from pipeline.register import LINE, valid_until
from warehouse import decisions as decided
from warehouse.archive import read_published_registers
from warehouse.code import code_version
from warehouse.editions import notes, sheets
from warehouse.editions.compare import compare
from warehouse.editions.folder import (
    ABOUT,
    CHANGES,
    CSV,
    DECISIONS,
    INPUTS,
    METHOD,
    NOTES,
    PACKAGE,
    TABLES,
    XLSX,
    About,
    Edition,
    TableDigest,
    check_new_name,
    edition_names,
    read_about,
    read_edition,
    write_folder,
)
from warehouse.editions.inputs import (
    INPUTS_HASH,
    REGISTER,
    archive_root,
    input_files,
    inputs_digest,
    tows_of_today,
)
from warehouse.editions.lines import TOW_FACTS, method_lines
from warehouse.schemas import Register, conform
from warehouse.storage import Place
from warehouse.store import Store, fingerprint, table_digest
from warehouse.tables import method_is_stale, runs_with_windows

BOAT_FACTS: Final = ("ht_no", "name", "boat_type")
AS_PRINTED, REBASED = "printed", "printed_rebased"
PRINTED_METHOD: Final = "as-printed"
NO_VALID_CURVE: Final = "no_valid_curve"
LINE_SCHEMA: Final = {
    **{name: column.dtype for name, column in Register.columns().items()},
    **dict.fromkeys(BOAT_FACTS, pl.String()),
    **dict.fromkeys(TOW_FACTS[:-1], pl.Float64()),
    INPUTS_HASH: pl.String(),
    "basis": pl.String(),
}
"""What an edition says of a line, but for its verification code."""


@dataclass(frozen=True)
class Terms:
    """What a person decides about an edition.

    Attributes:
        edition: its name.
        valid_from: the day from which it counts; validity of tows is judged on it.
        decision: by whom and where it was decided.
        published_on: the day of publication.
    """

    edition: str
    valid_from: dt.date
    decision: str
    published_on: dt.date


def publish(store: Store, method: Method, terms: Terms, carry: str | None = None) -> Place:
    """Freezes the register of a method as an edition.

    Args:
        store: the data folder; its tables must be those of the archive and code of today.
        method: a method that the last rebuild applied.
        terms: what a person decided.
        carry: a printed edition of which lines are taken over, re-based in closed form, for boats
            and crews without a valid tow in the warehouse.

    Returns:
        The folder.

    Raises:
        BrokenPromiseError: the name is taken, or the folder could not be written.
        MissingKnowledgeError: the tables are not up to date, a name or decision cannot be used.
    """
    check_new_name(store, terms.edition)
    _check_decision(terms)
    edition = recomputed_edition(store, method, terms, carry)
    decisions = _decisions(store, terms)
    texts = {
        METHOD: method_text(method),
        DECISIONS: json.dumps([d.model_dump(mode="json") for d in decisions], indent=1),
    }
    return _write(store, edition, input_files(store, edition.tables["tows"]), texts)


def publish_printed(store: Store, season: int, terms: Terms) -> Place:
    """Freezes a register of the archive, as printed that year, as an edition.

    Raises:
        BrokenPromiseError: the name is taken, or the folder could not be written.
        MissingKnowledgeError: the archive holds no such register, or it names a line twice.
    """
    check_new_name(store, terms.edition)
    _check_decision(terms)
    lines, files = _printed_lines(store, season)
    register = _complete(store, lines, terms.edition, PRINTED_METHOD, None)
    about = _about(store, terms, None, inputs_digest="")
    return _write(store, Edition(about, {"register": register}, None), files, {})


def recomputed_edition(
    store: Store, method: Method, terms: Terms, carry: str | None = None
) -> Edition:
    """The edition that would be published, not yet written; see `publish`."""
    if store.made_from("tows") is None or method_is_stale(store, method):
        raise MissingKnowledgeError(
            f"the tables of method {method.name} are not those of the archive and code of today; "
            f"run: herijk rebuild --archive DIR --data {store.root} --method {method.name}"
        )
    tows = tows_of_today(store)
    decisions = decided.decision_table(_decisions(store, terms))
    _check_decided_tows(decisions, tows)
    tables = {
        "tows": tows,
        "tow_runs": runs_with_windows(store),
        **{name: store.read(name, method.name) for name in ("curves", "run_points", "log_factors")},
    }
    crews = store.read("listed_boats")
    lines = method_lines(tables, crews, terms.valid_from, method.validity, decisions)
    if carry is not None:
        printed = _carried(read_edition(store, carry), tables["log_factors"], method.validity)
        counts = pl.lit(terms.valid_from).is_between("tow_date", "valid_until")
        lines = _with_carried(lines, printed.filter(counts & pl.col("cw_kg_m").is_finite()))
    tables["register"] = _complete(store, lines, terms.edition, method.name, method.content_hash)
    about = _about(store, terms, method, inputs_digest(tows))
    return Edition(about, tables, method)


def latest_before(store: Store, valid_from: dt.date, published_on: dt.date) -> str | None:
    """The edition that counted last before a day; None if there is none."""
    known = [read_about(store.editions / name) for name in edition_names(store)]
    earlier = [a for a in known if (a.valid_from, a.published_on) <= (valid_from, published_on)]
    if not earlier:
        return None
    return max(earlier, key=lambda a: (a.valid_from, a.published_on, a.edition)).edition


def _check_decision(terms: Terms) -> None:
    if not terms.decision.strip():
        raise MissingKnowledgeError(
            "an edition needs a decision: say who decided it and where, with --decision"
        )


def _decisions(store: Store, terms: Terms) -> tuple[decided.Decision, ...]:
    """Decisions about tows taken up to the day of publication."""
    found = decided.read_decisions(store.root / decided.FILE_NAME)
    return tuple(d for d in found if d.datum <= terms.published_on)


def _check_decided_tows(decisions: pl.DataFrame, tows: pl.DataFrame) -> None:
    unknown = decisions.join(tows, on="tow_id", how="anti")["tow_id"].to_list()
    if unknown:
        raise MissingKnowledgeError(
            f"{decided.FILE_NAME} decides about {', '.join(unknown)}, which is no tow of the "
            "warehouse; mend the sleep_id, or take the decision out"
        )


def _about(store: Store, terms: Terms, method: Method | None, inputs_digest: str) -> About:
    return About(
        edition=terms.edition,
        kind="as_printed" if method is None else "recomputed",
        method=None if method is None else method.name,
        method_hash=None if method is None else method.content_hash,
        code_version=code_version(),
        valid_from=terms.valid_from,
        published_on=terms.published_on,
        decision=terms.decision,
        simulated=bool(store.read("about_archive")["simulated"][0]),
        inputs_digest=inputs_digest,
        previous=latest_before(store, terms.valid_from, terms.published_on),
    )


def _complete(
    store: Store, lines: pl.DataFrame, edition: str, method: str, method_hash: str | None
) -> pl.DataFrame:
    """Lines with the facts of their boats and their verification codes, checked and sorted."""
    named = lines.join(
        store.read("boats").select("fsn_no", *BOAT_FACTS), on="fsn_no", how="left"
    ).with_columns(pl.lit(edition).alias("edition"), pl.lit(method).alias("method"))
    missing = [pl.lit(None).alias(name) for name in LINE_SCHEMA if name not in named.columns]
    full = (
        named.with_columns(missing)
        .select(pl.col(name).cast(dtype) for name, dtype in LINE_SCHEMA.items())
        .sort(LINE)
    )
    conform("register", full)
    codes = sheets.verification_codes(full, method_hash)
    return full.with_columns(pl.Series(sheets.CODE_FIELD.column, codes, pl.String))


def _write(store: Store, edition: Edition, files: pl.DataFrame, texts: dict[str, str]) -> Place:
    """Writes an edition's folder: tables, sheets, texts, and last what it says of itself."""
    about = edition.about
    tables = dict(edition.tables)
    previous = None
    if about.previous is not None:
        previous = compare(store, read_edition(store, about.previous), edition)
        tables[CHANGES] = previous.lines
    text = notes.release_notes(edition, previous)
    fields = [*sheets.REGISTER_FIELDS, sheets.CODE_FIELD]
    contents = {
        CSV: sheets.csv_bytes(edition.register, fields),
        XLSX: sheets.xlsx_bytes(edition.register, fields, about),
        INPUTS: sheets.csv_bytes(files, sheets.INPUT_FIELDS),
        NOTES: text.encode("utf-8"),
        **{name: content.encode("utf-8") for name, content in texts.items()},
        **{f"{name}.parquet": _parquet(tables[name]) for name in TABLES if name in tables},
    }
    contents[PACKAGE] = sheets.package_bytes(about, contents, notes.summary(edition))
    sealed = about.model_copy(
        update={
            "tables": {
                name: TableDigest(rows=frame.height, digest=table_digest(frame))
                for name, frame in tables.items()
            },
            "files": {n: hashlib.sha256(c).hexdigest() for n, c in sorted(contents.items())},
        }
    ).sealed()
    contents[ABOUT] = (sealed.model_dump_json(indent=1) + "\n").encode("utf-8")
    return write_folder(store, about.edition, contents)


def _parquet(frame: pl.DataFrame) -> bytes:
    target = io.BytesIO()
    frame.write_parquet(target, compression="zstd")
    return target.getvalue()


# Printed registers


def _printed_lines(store: Store, season: int) -> tuple[pl.DataFrame, pl.DataFrame]:
    """Lines of the register printed in a season, and the file they come from."""
    root = archive_root(store)
    if root is None:
        raise MissingKnowledgeError(
            "the archive is not where it was at the last rebuild; rebuild with --archive DIR"
        )
    found = read_published_registers(root)[0]
    printed = found.filter(pl.col("season") == season)
    if printed.is_empty():
        known = ", ".join(str(s) for s in found["season"].unique().sort()) or "none"
        raise MissingKnowledgeError(
            f"the archive holds no register printed in {season}; it holds: {known}"
        )
    _refuse_doubles(printed)
    lines = printed.select(
        *LINE,
        *("tow_date", "declared_speed_m_s", "a_kg_m", "b_m_s", "cw_kg_m"),
        pl.when("has_valid_curve")
        .then(pl.lit("valid"))
        .otherwise(pl.lit(NO_VALID_CURVE))
        .alias("status"),
        pl.when("has_valid_curve").then(pl.lit(AS_PRINTED)).alias("basis"),
        _row_hashes(printed),
    )
    path = printed["path"][0]
    files = store.read("listed_files").filter(pl.col("path") == path)
    return lines, files.select("path", "sha256", pl.lit(REGISTER).alias("kind"))


def _refuse_doubles(printed: pl.DataFrame) -> None:
    double = printed.filter(pl.struct(LINE).is_duplicated())
    if double.height:
        row = double.row(0, named=True)
        raise MissingKnowledgeError(
            f"{row['path']}, line {row['line']}: {row['fsn_no']} stands there twice for "
            f"{row['rowers']}{row['crew_class']}; take one of the lines out"
        )


def _row_hashes(lines: pl.DataFrame) -> pl.Series:
    values = lines.drop("path", "line")
    return pl.Series(INPUTS_HASH, [fingerprint(row) for row in values.rows()], pl.String)


def _carried(printed: Edition, log_factors: pl.DataFrame, rule: RegisterRule) -> pl.DataFrame:
    """Printed lines re-based in closed form: A / y^2 and B y with the log factor y of the season.

    Raises:
        MissingKnowledgeError: the edition is not a printed one.
    """
    if printed.about.kind != "as_printed":
        raise MissingKnowledgeError(
            f"edition {printed.about.edition} was recomputed; only lines of an edition as printed "
            "can be carried over"
        )
    usable = ("tow_date", "declared_speed_m_s", "a_kg_m", "b_m_s")
    lines = (
        printed.register.drop_nulls(usable)
        .with_columns(pl.col("tow_date").dt.year().alias("season"))
        .join(log_factors.select("season", "factor"), on="season", how="left")
    )
    y = lines["factor"].fill_null(1.0).to_numpy()
    a, b = rebase(lines["a_kg_m"], lines["b_m_s"], y)
    return lines.select(
        *LINE,
        *("tow_date", "declared_speed_m_s", "status", INPUTS_HASH),
        valid_until(pl.col("tow_date"), rule).alias("valid_until"),
        pl.Series("a_kg_m", a),
        pl.Series("b_m_s", b),
        pl.Series("cw_kg_m", cw(a, s_of_b(b), lines["declared_speed_m_s"])),
        pl.Series("basis", np.where(y == 1.0, AS_PRINTED, REBASED), pl.String),
    )


def _with_carried(lines: pl.DataFrame, printed: pl.DataFrame) -> pl.DataFrame:
    """Lines of the warehouse, with a printed one in place of each that is not valid."""
    taken = printed.join(lines.filter(pl.col("status") == "valid"), on=LINE, how="anti")
    return pl.concat([lines.join(taken, on=LINE, how="anti"), taken], how="diagonal_relaxed")

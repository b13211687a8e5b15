"""Publishing: from the tables of a method, or from a printed register, to a frozen edition.

Which tow counts is decided in `pipeline.register.register`, how sheets look in `sheets`, how a
folder appears whole or not at all in `warehouse.store.editions`. Only a person publishes, who gives
the name, the day from which it counts, the decision and the day of publication.
"""

import datetime as dt
from dataclasses import dataclass, replace
from pathlib import Path

import polars as pl

from pipeline.errors import BrokenPromiseError, MissingKnowledgeError
from pipeline.method.definition import Method
from pipeline.recompute.recompute import recompute
from pipeline.register.register import DOUBTED, LINE
from pipeline.tables.row import Row
from warehouse.derive.graph import METHOD as METHOD_STEP
from warehouse.derive.inputs import Scope
from warehouse.editions.chain import chain_head
from warehouse.editions.contents import contents_of, decisions_of
from warehouse.editions.inputs import (
    REGISTER,
    input_files,
    inputs_digest,
    listed_inputs,
    tows_of_today,
)
from warehouse.editions.lines import (
    MADE,
    NUMBERS,
    SAME_NUMBER,
    completed,
    method_lines,
)
from warehouse.editions.printed import (
    printed_lines,
    printed_path,
    with_carried,
)
from warehouse.intake.seasons import run_blocks, runs_with_windows, typed_tows
from warehouse.store import decisions as decided
from warehouse.store.code import code_version
from warehouse.store.editions import (
    About,
    Edition,
    check_new_name,
    edition_names,
    read_about,
    read_edition,
    write_folder,
)
from warehouse.store.ensemble import read_ensemble
from warehouse.store.store import Store


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


def publish(store: Store, method: Method, terms: Terms, carry: str | None = None) -> Path:
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
    _check_terms(store, terms)
    edition = recomputed_edition(store, method, terms, carry)
    files = input_files(edition.tables["tows"], listed_inputs(store))
    return _write(store, edition, files)


def publish_printed(store: Store, season: int, terms: Terms) -> Path:
    """Freezes a register of the archive, as printed that year, as an edition.

    Raises:
        BrokenPromiseError: the name is taken, or the folder could not be written.
        MissingKnowledgeError: the archive holds no such register, it names a line twice, or a line
            of it cannot be read.
    """
    _check_terms(store, terms)
    path = printed_path(store, season)
    files = store.read("listed_files").filter(pl.col("path") == path)
    files = files.select("path", "sha256", pl.lit(REGISTER).alias("kind"))
    about = _about(store, terms, None, inputs_digest="")
    register = completed(store, printed_lines(store, path), about, None)
    return _write(store, Edition(about, {"register": register}, None), files)


def recomputed_edition(
    store: Store, method: Method, terms: Terms, carry: str | None = None
) -> Edition:
    """The edition that would be published, not yet written; see `publish`."""
    if store.made_from("tows") is None or METHOD_STEP.is_stale(Scope(store, [method], method)):
        raise MissingKnowledgeError(
            "the tables of method {} are not those of the archive and code of today; "
            "run: herijk rebuild --archive DIR --data {} --method {}",
            method.name,
            store.root,
            method.name,
        )
    tows = tows_of_today(store)
    decisions = decided.decision_table(decisions_of(store, terms.published_on))
    _check_decided_tows(decisions, tows)
    tables = {
        "tows": tows,
        "tow_runs": runs_with_windows(store),
        **{name: store.read(name, method.name) for name in MADE},
    }
    _check_made(store, method, tables["curves"])
    crews = store.read("listed_boats")
    lines = method_lines(tables, crews, terms.valid_from, method.validity, decisions)
    if carry is not None:
        printed = read_edition(store, carry)
        factors = tables["log_factors"]
        lines = with_carried(lines, printed, factors, terms.valid_from, method)
    tables["ensemble"] = read_ensemble(store, method.name).join(
        lines.drop_nulls("cw_kg_m"), on="tow_id", how="semi"
    )
    about = _about(store, terms, method, inputs_digest(tows), carry)
    tables["register"] = completed(store, lines, about, method)
    return Edition(about, tables, method)


def _check_made(store: Store, method: Method, curves: pl.DataFrame) -> None:
    """Refuses curves that are not those that the method makes of the blocks."""
    made = recompute(method, typed_tows(store), run_blocks(store), with_bands=False).curves
    pairs = curves.join(made, on="tow_id", how="full", suffix="_made", maintain_order="left_right")
    same = [
        (pl.col(name) / pl.col(f"{name}_made") - 1.0).abs().fill_null(0.0) < SAME_NUMBER
        for name in NUMBERS
    ]
    null = [pl.col(name).is_null() == pl.col(f"{name}_made").is_null() for name in NUMBERS]
    status = pl.col("status").eq_missing(pl.col("status_made"))
    unequal = pairs.filter(~pl.all_horizontal(*same, *null, status))
    if unequal.height:
        raise BrokenPromiseError(
            "the curve of tow {}, and {} more, are not what {} makes of its samples: "
            "a table of the data folder was changed. Remove {} and run herijk "
            "rebuild",
            unequal["tow_id"][0],
            unequal.height - 1,
            method.name,
            store.root / "lake",
        )


def latest_before(store: Store, valid_from: dt.date, published_on: dt.date) -> str | None:
    """The edition that counted last before a day; None if there is none."""
    known = [read_about(store.editions / name) for name in edition_names(store)]
    earlier = [a for a in known if (a.valid_from, a.published_on) <= (valid_from, published_on)]
    if not earlier:
        return None
    return max(earlier, key=lambda a: (a.valid_from, a.published_on, a.edition)).edition


@dataclass(frozen=True)
class Published:
    """An edition that was just published.

    Attributes:
        about: what it is.
        folder: where it is.
        statuses: how many lines have each.
        to_look_at: rows of the register to look at.
    """

    about: About
    folder: str
    statuses: dict[str, int]
    to_look_at: list[Row]


def published(store: Store, folder: Path) -> Published:
    """What there is to say about an edition that was just published."""
    edition = read_edition(store, folder.name)
    counts = edition.register["status"].value_counts().sort("count", "status", descending=True)
    return Published(edition.about, str(folder), dict(counts.rows()), lines_to_look_at(edition))


def lines_to_look_at(edition: Edition) -> list[Row]:
    """Lines with flags, and those left without numbers because their tows are doubted."""
    to_look_at = (pl.col("flags").list.len() > 0) | (pl.col("status") == DOUBTED)
    lines = edition.register.filter(to_look_at)
    return lines.select(*LINE, "status", "tow_id", "flags").to_dicts()


def _check_terms(store: Store, terms: Terms) -> None:
    check_new_name(store, terms.edition)
    if not terms.decision.strip():
        raise MissingKnowledgeError(
            "an edition needs a decision: say who decided it and where, with --decision"
        )


def _check_decided_tows(decisions: pl.DataFrame, tows: pl.DataFrame) -> None:
    unknown = decisions.join(tows, on="tow_id", how="anti")["tow_id"].to_list()
    if unknown:
        raise MissingKnowledgeError(
            "{} decides about {}, which is not a tow of the warehouse; mend the "
            "sleep_id, or take the decision out",
            decided.FILE_NAME,
            ", ".join(unknown),
        )


def _about(
    store: Store, terms: Terms, method: Method | None, inputs_digest: str, carry: str | None = None
) -> About:
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
        carried_from=carry,
        previous=latest_before(store, terms.valid_from, terms.published_on),
    )


def _write(store: Store, edition: Edition, files: pl.DataFrame) -> Path:
    """Writes an edition's folder as the next of the chain."""
    name = edition.about.edition
    return write_folder(store, name, lambda: contents_of(store, _chained(store, edition), files))


def _chained(store: Store, edition: Edition) -> Edition:
    """The edition with its place in the chain, after the one published last."""
    head = chain_head(store)
    number, seal = (0, None) if head is None else (head.number or 0, head.seal)
    about = edition.about.model_copy(update={"number": number + 1, "after_seal": seal})
    return replace(edition, about=about)

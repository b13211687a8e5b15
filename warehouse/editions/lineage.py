"""From a printed line of an edition to the files, runs and seconds behind it.

Everything is read from the edition itself, so it holds however archive and warehouse have changed.
"""

from dataclasses import dataclass
from typing import Final

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.register.register import LINE
from pipeline.tables.row import Row
from warehouse.editions.sheets import CODE_FIELD, REGISTER_FIELDS, printed
from warehouse.store.boats import choose_boat, find_boats
from warehouse.store.editions import Edition, Manifest, edition_path, read_edition
from warehouse.store.store import Store

SAID: Final = Manifest.model_fields.keys() - {"files"}


@dataclass(frozen=True)
class Lineage:
    """What the lines of a boat in an edition were made from.

    Attributes:
        about: what the edition says of itself, but for hashes of its tables and files.
        folder: where it lies.
        lines: the boat's lines, each with the `line` itself, as it is `printed` by header, its
            verification `code`, its `tow`, `path` and `sha256` of its samples `files`, its `runs`
            (rows of `run_points`) and its `curve`. Where no tow of the archive is behind it the tow
            and curve are None and the lists empty.
    """

    about: Row
    folder: str
    lines: list[Row]


def lineage(store: Store, edition: str, boat: str) -> Lineage:
    """What the lines of a boat, by number or name, were made from.

    Raises:
        MissingKnowledgeError: there is no such edition, the boat is not in it, or several boats
            have that name.
    """
    published = read_edition(store, edition)
    boats = published.register.select("fsn_no", "name").unique()
    if not find_boats(boats, boat):
        raise MissingKnowledgeError(
            "boat {} is not in edition {}; its register.csv lists the boats", boat, edition
        )
    lines = published.register.filter(pl.col("fsn_no") == choose_boat(boats, boat))
    return Lineage(
        about=published.manifest.model_dump(mode="json", include=SAID),
        folder=str(edition_path(store, edition)),
        lines=[_line(published, row) for row in lines.sort(LINE).iter_rows(named=True)],
    )


def _line(edition: Edition, row: Row) -> Row:
    def of_tow(table: str) -> list[Row]:
        frame = edition.tables.get(table)
        return [] if frame is None else frame.filter(tow_id=row["tow_id"]).to_dicts()

    frame = pl.DataFrame([row], schema=edition.register.schema)
    tow = next(iter(of_tow("tows")), None)
    files = [(tow[f"{n}_path"], tow[f"{n}_sha256"]) for n in ("samples", "second")] if tow else []
    return {
        "line": row,
        "printed": printed(frame, REGISTER_FIELDS).row(0, named=True),
        "code": row[CODE_FIELD.column],
        "tow": tow,
        "files": [{"path": path, "sha256": sha256} for path, sha256 in files if path],
        "runs": of_tow("run_points"),
        "curve": next(iter(of_tow("curves")), None),
    }

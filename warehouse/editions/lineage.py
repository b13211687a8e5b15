"""From a line of an edition to the files, runs and seconds behind it.

Everything is read from the edition itself, so it holds however archive and warehouse have changed.
"""

from dataclasses import dataclass

import polars as pl

from pipeline.errors import MissingKnowledgeError
from pipeline.register.register import LINE
from pipeline.tables.row import Row
from warehouse.editions.sheets import CODE_FIELD, REGISTER_FIELDS, print_cells
from warehouse.store.boats import choose_boat, find_boats
from warehouse.store.editions import Manifest, get_edition_path, read_edition
from warehouse.store.store import Store


@dataclass(frozen=True)
class Lineage:
    """What the lines of a boat in an edition were made from.

    Attributes:
        about: what the edition says of itself, but for the hashes of its files.
        folder: where it lies.
        lines: the boat's lines, each with the `line` itself, as it is `print_cells` by header, its
            verification `code`, its `tow`, `path` and `sha256` of its samples `files`, its `runs`
            (rows of `run_points`) and its `curve`. Where no tow of the archive is behind it the tow
            and curve are None and the lists empty.
    """

    about: Row
    folder: str
    lines: list[Row]


def lineage(store: Store, edition: str, boat: str) -> Lineage:
    """Return the sources of the lines of a boat, by number or name.

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

    def rows_of_tow(table: str, tow_id: str | None) -> list[Row]:
        frame = published.tables.get(table)
        return [] if frame is None else frame.filter(tow_id=tow_id).to_dicts()

    own = published.register.filter(pl.col("fsn_no") == choose_boat(boats, boat)).sort(LINE)
    lines = []
    for line, cells in zip(
        own.to_dicts(), print_cells(own, REGISTER_FIELDS).to_dicts(), strict=True
    ):
        tow = next(iter(rows_of_tow("tows", line["tow_id"])), None)
        files = [
            {"path": tow[f"{kind}_path"], "sha256": tow[f"{kind}_sha256"]}
            for kind in ("samples", "second")
            if tow and tow[f"{kind}_path"]
        ]
        lines.append(
            {
                "line": line,
                "printed": cells,
                "code": line[CODE_FIELD.column],
                "tow": tow,
                "files": files,
                "runs": rows_of_tow("run_points", line["tow_id"]),
                "curve": next(iter(rows_of_tow("curves", line["tow_id"])), None),
            }
        )
    said = Manifest.model_fields.keys() - {"files"}
    about = published.manifest.model_dump(mode="json", include=said)
    return Lineage(about, str(get_edition_path(store, edition)), lines)

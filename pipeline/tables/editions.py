"""Published editions, the methods, and the files that lines were made from."""

from pipeline.tables import column
from pipeline.tables.bases import PerMethod
from pipeline.tables.declare import dy


class Editions(dy.Schema):
    """The published editions: what each is and by whose decision."""

    edition = column.text("edition", primary_key=True)
    kind = column.text("recomputed, or as_printed", regex="^(recomputed|as_printed)$")
    method = column.text("name of the method; empty as printed", nullable=True)
    method_hash = column.sha256("its content hash", nullable=True)
    interval = column.text("what its intervals hold, as in `methods`", nullable=True)
    valid_from = column.day("day from which it counts")
    published_on = column.day("day of publication")
    decision = column.text("by whom and where it was decided")
    previous = column.text("edition that it was compared with", nullable=True)
    code_version = column.text("version of the code that made it")
    seal = column.sha256("SHA-256 over all that the edition says of itself")


class Methods(PerMethod):
    """The methods that made the tables."""

    title = column.text("title for people")
    title_en = column.text("title in English; the same where the method has one title")
    interval = column.text(
        "complete: its intervals hold 95 %; runs_alone: they are the spread of the runs alone, the "
        "log's error is not in it",
        regex="^(complete|runs_alone)$",
    )
    content_hash = column.sha256("SHA-256 of the definition")
    definition = column.text("the options of every season, as canonical JSON")


class Lineage(dy.Schema):
    """What a register line was made from: one row per line and samples file."""

    edition = column.text("edition", primary_key=True)
    fsn_no = column.fsn_no(primary_key=True)
    rowers = column.rowers(primary_key=True)
    crew_class = column.crew_class(primary_key=True)
    tow_id = column.tow_id()
    path = column.text("file in the archive", primary_key=True)
    sha256 = column.sha256("its content hash")
    method = column.method()
    method_hash = column.sha256("content hash of the method")
    code_version = column.text("version of the code that made the line")

"""What the database says of itself."""

from pipeline.tables import column
from pipeline.tables.declare import dy


class About(dy.Schema):
    """What the database says of itself."""

    key = column.text(
        "simulated: made by a simulator, or measured; code_version: of the code that made it; "
        "publisher, licence, crew_names, languages: as the archive declares them; objections_to, "
        "objections_until, objection_grounds: as beheer.toml says",
        primary_key=True,
    )
    value = column.text("its value")


class Contents(dy.Schema):
    """The tables of the database."""

    table = column.text("name of the table", primary_key=True)
    rows = dy.Int64(description="rows in it", min=0)
    meaning = column.text("what the table is")

"""The plots beside a page of `herijk audit`: one SVG each, readable without a network.

They draw what the tables say. Does not belong here: what a figure looks like
(`dashboards.figures`), and the words of the page (`cli.audit_text`).
"""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

import polars as pl
from markupsafe import Markup

from dashboards import drawn, labels
from pipeline.messages import speaker
from pipeline.register.register import default_method
from warehouse.queries.audit import BoatAudit, TypesAudit
from warehouse.queries.views import Views
from warehouse.store.files import write_beside
from warehouse.store.store import Store

SCATTERS: Final = ("a_weight", "b_weight", "cw_standard_weight", "b_speed", "cw_standard_speed")


class Plot(NamedTuple):
    """A figure with its rows, and which type they are of, if they are of one."""

    figure: str
    rows: pl.DataFrame
    of: str = ""


def write_audit_plots(
    store: Store, report: BoatAudit | TypesAudit, folder: Path, language: str
) -> list[Path]:
    """Writes the plots of a report of `warehouse.queries.audit`, replacing those of the same name.

    In Dutch (nl) or English (en). Beside them `index.html` shows all.

    Returns:
        The plots; one without rows is left out.
    """
    with Views(store) as views:
        plots = (
            _of_boat(views, report) if isinstance(report, BoatAudit) else _of_types(views, report)
        )
        files = [_write(plot, report, folder, language) for plot in plots if plot.rows.height]
    title = ", ".join(_about(report))
    pictures = Markup("\n").join(_PICTURE.format(f.name, f.stem) for f in files)
    with write_beside(folder / "index.html") as beside:
        beside.write_text(_INDEX.format(language, title, title, pictures), encoding="utf-8")
    return files


_INDEX: Final = Markup(
    '<!doctype html><html lang="{}"><meta charset="utf-8"><title>{}</title>'
    '<meta name="viewport" content="width=device-width, initial-scale=1">'
    '<body style="font-family:sans-serif"><h1>{}</h1>\n{}\n</body></html>\n'
)
_PICTURE: Final = Markup('<p><img src="{}" alt="{}" style="max-width:100%"></p>')


def _about(report: BoatAudit | TypesAudit) -> list[str]:
    return [report.boat["fsn_no"]] if isinstance(report, BoatAudit) else _types(report)


def _of_types(views: Views, report: TypesAudit) -> Iterator[Plot]:
    """Eras and repeats under all methods; the rest side by side before and after correction."""
    methods, types = report.methods, _types(report)
    own = pl.col("boat_type").is_in(types) & pl.col("method").is_in(methods)
    shifts = views.table("era_shifts").filter(own, pl.col("shift_ratio").is_not_null())
    for boat_type in types:
        yield Plot("eras", shifts.filter(boat_type=boat_type), boat_type)
    boats = views.ask("type_tows").filter(own, "newest")
    yield Plot(
        "repeats",
        boats.select("method", "fsn_no")
        .unique()
        .sort("method", "fsn_no")
        .join(views.ask("repeat_pairs"), on=["method", "fsn_no"], maintain_order="left"),
    )
    compared = pl.col("method").is_in([methods[0], default_method(methods)])
    for name in SCATTERS:
        yield Plot(name, boats.filter(compared))


def _of_boat(views: Views, report: BoatAudit) -> Iterator[Plot]:
    """Its history under all methods, and its place in its type by the default method."""
    methods, boat = report.methods, report.boat
    own = (pl.col("fsn_no") == boat["fsn_no"]) & pl.col("method").is_in(methods)
    tow = pl.format("{} · {}{}", "tow_date", "rowers", "crew_class")
    yield Plot("history", views.ask("curves").filter(own).with_columns(tow=tow))
    yield Plot("repeats", views.ask("repeat_pairs").filter(own))
    like = views.ask("type_tows").filter("newest", pl.col("boat_type") == (boat["boat_type"] or ""))
    for name in SCATTERS:
        yield Plot(name, like.filter(method=default_method(methods)))


def _write(plot: Plot, report: BoatAudit | TypesAudit, folder: Path, language: str) -> Path:
    """One SVG, its title saying of what and whether it was simulated; a boat stands out."""
    say = speaker(language)
    about = _about(report)
    of = [plot.of] if plot.of else about
    caption = say(labels.FIGURES[plot.figure])
    spec = drawn.specification(plot.figure, language)
    spec["title"] = {
        "text": f"{caption} · {', '.join(of)}",
        "subtitle": [say(labels.SIMULATED)] if report.simulated else [],
    }
    for parameter in spec.get("params", []):
        if parameter["name"] == "chosen":
            parameter["value"] = about[0]
    path = folder / f"{file_name(f'{plot.figure} {plot.of}')}.svg"
    with write_beside(path) as beside:
        beside.write_text(drawn.svg(spec, plot.rows, language), encoding="utf-8")
    return path


def _types(report: TypesAudit) -> list[str]:
    return [one["boat_type"] for one in report.types]


def file_name(text: str) -> str:
    """A text as the name of a file: letters, digits and dashes."""
    return re.sub(r"[^\w-]+", "-", text.strip())

"""`herijk fit`: a curve for anybody with speeds and forces."""

from pathlib import Path
from typing import Annotated, Any

import typer

from herijk.cli.arguments import AsJson, show
from herijk.words import tell


def fit(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Table with a header: speeds, forces or Cw.")
    ],
    speed: Annotated[str | None, typer.Option(metavar="COLUMN", help="Column of speeds.")] = None,
    force: Annotated[str | None, typer.Option(metavar="COLUMN", help="Column of forces.")] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the picture here, as SVG.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """A curve with its interval from speeds and forces; B only where the points determine it."""
    from herijk.library.curves import fit as fit_curve
    from herijk.pipeline.errors import MissingKnowledgeError
    from herijk.warehouse.archive.points import read_points

    if not file.is_file():
        raise MissingKnowledgeError("there is no file {}", file)
    points = read_points(file, speed, force)
    fitted = fit_curve(points["speed_m_s"], cw_kg_m=points["cw_kg_m"])
    speeds = points["speed_m_s"].unique().sort().to_list()
    report = {
        "file": str(file),
        "points": points.height,
        "a_kg_m": fitted.curve.a_kg_m,
        "b_m_s": fitted.b._asdict(),
        "b_is_determined": fitted.b_is_determined,
        "cw_kg_m": [{"speed_m_s": v, **fitted.cw(v)._asdict()} for v in speeds],
    }
    if plot is not None:
        from herijk.dashboards.fit_plot import write_fit_plot

        write_fit_plot(fitted, plot)
    show(report, _text, as_json)


def _text(report: dict[str, Any]) -> str:
    """The curve, its B in words, and Cw at the speeds that were measured."""
    rows = [
        tell(
            "  {:8.3f}  {:8.3f}  {} to {}",
            r["speed_m_s"],
            r["value"],
            _number(r["lo"]),
            _number(r["hi"]),
        )
        for r in report["cw_kg_m"]
    ]
    return "\n".join(
        [
            tell("{}: {} points", report["file"], report["points"]),
            tell("A = {:.3f} kg/m; {}", report["a_kg_m"], _b_in_words(report)),
            tell("Cw [kg/m] with its 95 % interval, from the scatter of the points alone:"),
            tell("  v [m/s]       Cw  interval"),
            *rows,
        ]
    )


def _b_in_words(report: dict[str, Any]) -> str:
    b = report["b_m_s"]
    low = (
        tell("B above {:.2f} m/s is possible", b["lo"])
        if b["lo"] is not None
        else tell("any B is possible")
    )
    if b["value"] is None:
        return tell("the points show no bend, so there is no B ({})", low)
    if not report["b_is_determined"]:
        return tell("B is not determined: the best fit has {:.2f} m/s, but {}", b["value"], low)
    return tell("B = {:.3f} m/s ({:.3f} to {:.3f})", b["value"], b["lo"], b["hi"])


def _number(value: float | None) -> str:
    return tell("without bound") if value is None else tell("{:.3f}", value)

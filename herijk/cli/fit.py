"""`herijk fit`: a curve for anybody with speeds and forces."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from herijk.cli.arguments import AsJson, as_json_text
from pipeline.messages import LANGUAGE, tell

if TYPE_CHECKING:
    from herijk.library.curves import Estimate, Fit


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
    from pipeline.errors import MissingKnowledgeError
    from warehouse.archive.lists.curve_points import read_points

    if not file.is_file():
        raise MissingKnowledgeError("there is no file {}", file)
    points = read_points(file, speed, force)
    fitted = fit_curve(points["speed_m_s"], cw_kg_m=points["cw_kg_m"])
    speeds = points["speed_m_s"].unique().sort().to_list()
    cw = {speed: fitted.cw(speed) for speed in speeds}
    if plot is not None:
        from dashboards.fit_plot import write_fit_plot

        write_fit_plot(fitted, plot, LANGUAGE.get())
    if not as_json:
        typer.echo("\n".join([tell("{}: {} points", file, points.height), *_text(fitted, cw)]))
        return
    report = {
        "file": str(file),
        "points": points.height,
        "a_kg_m": fitted.curve.a_kg_m,
        "b_m_s": fitted.b._asdict(),
        "b_is_determined": fitted.b_is_determined,
        "cw_kg_m": [{"speed_m_s": v, **estimate._asdict()} for v, estimate in cw.items()],
    }
    typer.echo(as_json_text(report))


def _text(fitted: "Fit", cw: dict[float, "Estimate"]) -> list[str]:
    """The curve, its B in words, and Cw at the speeds that were measured."""
    rows = [
        tell("  {:8.3f}  {:8.3f}  {} to {}", speed, value, _number(lo), _number(hi))
        for speed, (value, lo, hi) in cw.items()
    ]
    return [
        tell("A = {:.3f} kg/m; {}", fitted.curve.a_kg_m, _b_in_words(fitted)),
        tell("Cw [kg/m] with its 95 % interval, from the scatter of the points alone:"),
        tell("  v [m/s]       Cw  interval"),
        *rows,
    ]


def _b_in_words(fitted: "Fit") -> str:
    b = fitted.b
    low = (
        tell("B above {:.2f} m/s is possible", b.lo)
        if b.lo is not None
        else tell("any B is possible")
    )
    if b.value is None:
        return tell("the points show no bend, so there is no B ({})", low)
    if not fitted.b_is_determined:
        return tell("B is not determined: the best fit has {:.2f} m/s, but {}", b.value, low)
    return tell("B = {:.3f} m/s ({:.3f} to {:.3f})", b.value, b.lo, b.hi)


def _number(value: float | None) -> str:
    return tell("without bound") if value is None else tell("{:.3f}", value)

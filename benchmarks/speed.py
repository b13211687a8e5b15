"""How fast everything is, against only reading the same files and against other ways to do it.

    PYTHONPATH=. python -m benchmarks.speed [--tows-per-season 60] [--compared 60] [--repeats 5]

With `--write DIR` the summary (performance.md), all figures (performance.json) and the chart
(performance.svg) are put there.
"""

import argparse
import datetime as dt
import json
import subprocess
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import altair as alt
import numpy as np
import polars as pl

from benchmarks.harness import Figures, Task, machine, measure, median_seconds
from benchmarks.world import RATE_HZ, World

TOOLS = ("pandas", "duckdb", "polars")
AT_LEAST_THAT = " (one method)"
SCALE = (100, 300, 1000)
SAME_CURVE = 1e-6
"""Largest relative difference in A and, on the scale of 4 m2/s2, in 1/B^2: the others fit with
tolerances of their own, and text is held in 32 bits."""

AT_MOST = {
    ("blocks from Parquet", "decode Parquet, pyarrow"): 1.5,
    ("blocks from Parquet", "decode Parquet, polars"): 1.5,
    ("blocks from text", "parse text, write Parquet"): 1.6,
    ("curves from text", "curves from text, duckdb"): 1.0,
    ("curves from text", "curves from text, polars"): 1.0,
    ("curves from Parquet", "curves from Parquet, duckdb"): 1.0,
    ("curves from Parquet", "curves from Parquet, polars"): 1.0,
}
AT_LEAST = {
    ("curves from text, pandas", "curves from text"): 2.5,
    ("curves from Parquet, pandas", "curves from Parquet"): 8.0,
    ("changed method, pandas", "changed method, computation"): 100.0,
}
"""What the project asks of the ratio of two tasks."""

WITHIN_S = {"rebased, computation": 1.0, "herijk rebase": 4.0}
QUICK_COMMANDS = ("--help", "methods", "audit --help", "diff --help", "lineage --help")


def stages(tows_per_season: int, compared: int, results: Path) -> list[Task]:
    """Single stages and whole ways, all on the same tows."""
    same: dict[str, Any] = {"tows_per_season": tows_per_season, "count": compared}

    def way(label: str, function: str, **more: Any) -> Task:
        kept = {"result": str(results / f"{label}.parquet")}
        return Task(label, f"benchmarks.tasks.{function}", same | more | kept)

    def stage(label: str, function: str, **more: Any) -> Task:
        return Task(label, f"benchmarks.tasks.{function}", same | more)

    return [
        stage("parse text", "parse_text", write=False),
        stage("parse text, write Parquet", "parse_text", write=True),
        stage("blocks from text", "read_text"),
        stage("decode Parquet, pyarrow", "decode", tool="pyarrow"),
        stage("decode Parquet, polars", "decode", tool="polars"),
        stage("blocks from Parquet", "add_up"),
        way("curves from text", "herijk_from_text"),
        way("curves from Parquet", "herijk_from_parquet", plain_text=True),
        *(
            way(f"curves from {form}, {t}{least}", function, tool=t, text=form == "text")
            for least, function in (("", "other"), (AT_LEAST_THAT, "other_at_least"))
            for form in ("text", "Parquet")
            for t in TOOLS
        ),
    ]


def of_history(tows_per_season: int, count: int, results: Path) -> list[Task]:
    """A changed method over everything; the others have no blocks and read the samples again."""
    same: dict[str, Any] = {"tows_per_season": tows_per_season, "count": count}
    read = {"text": False, "plain_text": False, "side": "changed"}
    return [
        Task(label, f"benchmarks.tasks.{function}", same | more)
        for label, function, more in (
            ("changed method, computation", "apply_method", {"method": "changed"}),
            ("changed method", "herijk_changed", {"result": str(results / "changed.parquet")}),
            ("rebased, computation", "apply_method", {"method": "rebased"}),
        )
    ] + [
        Task(
            f"changed method, {tool}",
            "benchmarks.tasks.other_at_least",
            same | read | {"tool": tool, "result": str(results / f"changed, {tool}.parquet")},
        )
        for tool in TOOLS
    ]


def of_size(tows_per_season: int, counts: list[int]) -> list[Task]:
    """Cost against number of tows."""
    return [
        Task(f"{label}, {n}", f"benchmarks.tasks.{function}", arguments | {"count": n})
        for n in counts
        for label, function, arguments in (
            (
                "blocks from Parquet, written",
                "add_up_and_write",
                {"tows_per_season": tows_per_season},
            ),
            (
                "rebased, computation",
                "apply_method",
                {"tows_per_season": tows_per_season, "method": "rebased"},
            ),
        )
    ]


def check_same(results: Path) -> int:
    """Every way gave the same curves; returns how many curves were compared."""
    compared = 0
    for other in sorted(results.glob("*, *.parquet")):
        mine = pl.read_parquet(results / f"{other.stem.rpartition(', ')[0]}.parquet")
        both = mine.select("tow_id", "a_kg_m", "b_m_s", "runs_used").join(
            pl.read_parquet(other), on="tow_id", how="full", suffix="_other"
        )
        assert both.null_count().select("tow_id", "tow_id_other").sum_horizontal().item() == 0
        s = np.nan_to_num(1.0 / both["b_m_s"].fill_null(float("inf")).to_numpy() ** 2)
        curved = np.isfinite(both["b_m_s"].fill_null(float("inf")).to_numpy())
        in_a = np.abs(both["a_kg_m"].to_numpy() / both["a_kg_m_other"].to_numpy() - 1.0)
        in_s = 4.0 * np.abs(s - both["s_s2_m2"].to_numpy())[curved]
        assert max(in_a.max(), in_s.max(initial=0.0)) < SAME_CURVE, (other.name, in_a.max())
        compared += both.height
    return compared


def deviation_from_line(seconds: dict[int, float]) -> float:
    """Largest relative distance of the costs from the straight line through them."""
    n, cost = np.array(list(seconds), float), np.array(list(seconds.values()))
    slope, start = np.polyfit(n, cost, 1)
    return float(np.abs(cost / (start + slope * n) - 1.0).max())


def start_up(repeats: int) -> dict[str, float]:
    """Seconds of commands that need no Dagster."""
    python = [sys.executable, "-m", "herijk"]
    return {
        f"herijk {command}": median_seconds(
            lambda c=command: subprocess.run(
                [*python, *c.split()], check=True, stdout=subprocess.DEVNULL
            ),
            repeats,
        )
        for command in QUICK_COMMANDS
    }


def run(tows_per_season: int, compared: int, repeats: int) -> dict[str, Any]:
    """All figures of a run."""
    world = World(tows_per_season)
    world.make()
    all_tows = world.tows().height
    compared = min(compared, world.tows(plain=True).height)
    counts = [n for n in SCALE if n <= all_tows] or [all_tows]
    with tempfile.TemporaryDirectory() as folder:
        results = Path(folder)
        found = measure(stages(tows_per_season, compared, results), repeats)
        found |= measure(of_history(tows_per_season, all_tows, results), min(repeats, 3))
        curves = check_same(results)
    sizes = measure(of_size(tows_per_season, counts), repeats)
    whole = {"tows_per_season": tows_per_season}
    found |= measure([Task("herijk rebase", "benchmarks.tasks.whole_rebase", whole)], 1)
    return {
        "date": dt.datetime.now(dt.UTC).date().isoformat(),
        "machine": machine("numpy", "numba", "polars", "duckdb", "pandas", "scipy", "pyarrow"),
        "tows": all_tows,
        "compared_tows": compared,
        "curves_compared": curves,
        "rate_hz": RATE_HZ,
        "repeats": repeats,
        "tasks": {label: asdict(figures) for label, figures in found.items()},
        "sizes": {label: asdict(figures) for label, figures in sizes.items()},
        "start_up_s": start_up(repeats),
    }


# Showing


def ratios(tasks: dict[str, Figures]) -> list[tuple[str, str, float, float, str, bool]]:
    """Of, to, ratio by the clock, ratio by processor, what is asked, and whether it holds."""
    rows = []
    for limits, sign in ((AT_MOST, "at most"), (AT_LEAST, "at least")):
        for (of, to), limit in limits.items():
            clock = tasks[of].seconds / tasks[to].seconds
            processor = tasks[of].processor_s / tasks[to].processor_s
            holds = clock <= limit if sign == "at most" else clock >= limit
            rows.append((of, to, clock, processor, f"{sign} {limit:g}", holds))
    return rows


def summary(report: dict[str, Any], command: str) -> str:
    """The page of the documentation."""
    tasks = {label: Figures(**figures) for label, figures in report["tasks"].items()}
    samples = report["compared_tows"] * 300_000
    about = ", ".join(f"{key} {value}" for key, value in report["machine"].items())
    lines = [
        "# Performance",
        "",
        f"Made by `{command}` on {report['date']}. Machine: {about}. Simulated archive of "
        f"{report['tows']} tows at {report['rate_hz']} Hz, 2009-2025. Medians of "
        f"{report['repeats']} repeats in turn; each task in a process of its own, two threads. "
        "All figures: [performance.json](performance.json). Whole rebuilds and other commands, "
        "from the shell: [commands.md](commands.md).",
        "",
        "The others keep the samples as Parquet, make the same sums of every second and the same "
        "curves by the same method (whole runs, oblique wind, free curve); "
        f"{report['curves_compared']} curves agreed within {SAME_CURVE:g}. Ours checks every file "
        "besides; the archive has been indexed, so no file is hashed here. *One method* is the "
        "least a script can do for the same curves: five columns, one method, nothing kept; so "
        "the others also do it for a changed method. Load is that of the machine when the run "
        "ended: above the number of cores, other work was going on "
        "and the column *processor* is the more reliable one.",
        "",
        "## Asked and found",
        "",
        "| of | to | ratio | by processor time | asked | holds |",
        "| --- | --- | --- | --- | --- | --- |",
        *(
            f"| {of} | {to} | {clock:.2f} | {processor:.2f} | {asked} | {_yes(holds)} |"
            for of, to, clock, processor, asked, holds in ratios(tasks)
        ),
        "",
        "| what | seconds | processor | asked below | holds |",
        "| --- | --- | --- | --- | --- |",
        *(
            f"| {label} | {tasks[label].seconds:.2f} | {tasks[label].processor_s:.2f} | "
            f"{limit:g} | {_yes(tasks[label].seconds < limit)} |"
            for label, limit in WITHIN_S.items()
        ),
        *(
            f"| `{command}` | {seconds:.2f} | | 0.5 | {_yes(seconds < 0.5)} |"
            for command, seconds in report["start_up_s"].items()
        ),
        "",
        f"## Stages and ways, {report['compared_tows']} tows",
        "",
        *_figures(tasks, [t for t in tasks if not _whole(t)], samples),
        "",
        f"## All {report['tows']} tows",
        "",
        *_figures(tasks, [t for t in tasks if _whole(t)], report["tows"] * 300_000),
        "",
        "## Cost against number of tows",
        "",
        "![Cost against number of tows](performance.svg)",
        "",
        *_sizes(report["sizes"]),
    ]
    return "\n".join(lines) + "\n"


def _yes(holds: bool) -> str:
    return "yes" if holds else "**no**"


def _whole(label: str) -> bool:
    return label.startswith(("changed", "rebased", "herijk"))


def _figures(tasks: dict[str, Figures], labels: list[str], samples: int) -> list[str]:
    return [
        "| task | seconds | processor s | million samples/s | peak MiB |",
        "| --- | --- | --- | --- | --- |",
        *(
            f"| {label} | {tasks[label].seconds:.2f} | {tasks[label].processor_s:.2f} | "
            f"{samples / tasks[label].seconds / 1e6:.1f} | {tasks[label].peak_mib:.0f} |"
            for label in labels
        ),
    ]


def _by_size(sizes: dict[str, Any], figure: str) -> dict[str, dict[int, float]]:
    found: dict[str, dict[int, float]] = {}
    for label, figures in sizes.items():
        what, _, tows = label.rpartition(", ")
        found.setdefault(what, {})[int(tows)] = figures[figure]
    return found


def _sizes(sizes: dict[str, Any]) -> list[str]:
    seconds, processor, peak = (
        _by_size(sizes, figure) for figure in ("seconds", "processor_s", "peak_mib")
    )
    return [
        "| task | tows | seconds | processor s | peak MiB |",
        "| --- | --- | --- | --- | --- |",
        *(
            f"| {what} | {n} | {seconds[what][n]:.2f} | {processor[what][n]:.2f} | "
            f"{peak[what][n]:.0f} |"
            for what in seconds
            for n in seconds[what]
        ),
        "",
        *(
            f"Largest distance of {what} from a straight line: {deviation_from_line(cost):.1%} "
            f"by the clock, {deviation_from_line(processor[what]):.1%} by processor time "
            "(asked: 15 %)."
            for what, cost in seconds.items()
            if len(cost) > 2
        ),
    ]


def chart(sizes: dict[str, Any]) -> alt.Chart:
    """Cost against number of tows, with the straight line to the largest."""
    rows = [
        {"task": what, "tows": n, "seconds": s}
        for what, costs in _by_size(sizes, "seconds").items()
        for n, s in costs.items()
    ]
    base = alt.Chart(alt.Data(values=rows)).encode(
        alt.X("tows:Q", title="tows"),
        alt.Y("seconds:Q", title="time [s]"),
        alt.Color("task:N", title=None, scale=alt.Scale(range=["#0072B2", "#D55E00"])),
    )
    points = base.mark_point(filled=True, size=70).encode(alt.Shape("task:N", title=None))
    return (base.mark_line(strokeDash=[4, 3]) + points).properties(width=420, height=260)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tows-per-season", type=int, default=60)
    parser.add_argument("--compared", type=int, default=60, help="tows of the comparisons")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--write", type=Path, metavar="DIR", help="write the summary here")
    chosen = parser.parse_args()
    report = run(chosen.tows_per_season, chosen.compared, chosen.repeats)
    command = (
        f"python -m benchmarks.speed --tows-per-season {chosen.tows_per_season} "
        f"--compared {chosen.compared} --repeats {chosen.repeats}"
    )
    print(summary(report, command))
    if chosen.write:
        (chosen.write / "performance.json").write_text(json.dumps(report, indent=1) + "\n")
        (chosen.write / "performance.md").write_text(summary(report, command), encoding="utf-8")
        chart(report["sizes"]).save(chosen.write / "performance.svg")


if __name__ == "__main__":
    main()

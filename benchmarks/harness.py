"""Measuring: every task in a process of its own, repeats in turn, medians.

A child process reports the seconds of its work alone (imports and preparation are not counted), the
processor seconds of all its threads and its own peak memory. Repeats of different tasks take
turns, so that a slow minute of the machine meets them all.
"""

import argparse
import importlib
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

THREADS = 2
"""What every contestant may use: polars, DuckDB, pyarrow and the lake's own workers."""


@dataclass(frozen=True)
class Task:
    """A function `module.function` to be timed, with its arguments (as JSON can hold them).

    The function prepares and returns the work; calling that is timed.
    """

    label: str
    function: str
    arguments: dict[str, Any]


@dataclass(frozen=True)
class Figures:
    """Medians of a task's repeats.

    Attributes:
        seconds: elapsed.
        processor_s: of all threads together.
        peak_mib: memory of the whole process.
        repeats: how many.
    """

    seconds: float
    processor_s: float
    peak_mib: float
    repeats: int


def measure(tasks: Sequence[Task], repeats: int) -> dict[str, Figures]:
    """Figures of each task by its label; the tasks take turns."""
    found: dict[str, list[dict[str, float]]] = {task.label: [] for task in tasks}
    for _ in range(repeats):
        for task in tasks:
            found[task.label].append(_in_child(task))
            print(f"  {task.label:44} {found[task.label][-1]['seconds']:8.3f} s", file=sys.stderr)
    return {
        label: Figures(
            *(
                statistics.median(run[name] for run in runs)
                for name in ("seconds", "processor_s", "peak_mib")
            ),
            repeats,
        )
        for label, runs in found.items()
    }


def _in_child(task: Task) -> dict[str, float]:
    called = [sys.executable, "-m", "benchmarks.harness", task.function, json.dumps(task.arguments)]
    limits = {"POLARS_MAX_THREADS": THREADS, "OMP_NUM_THREADS": THREADS}
    environment = os.environ | {name: str(threads) for name, threads in limits.items()}
    done = subprocess.run(called, env=environment, stdout=subprocess.PIPE, check=True, text=True)
    figures: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return figures


def _child(function: str, arguments: str) -> None:
    module, name = function.rsplit(".", 1)
    work: Callable[[], object] = getattr(importlib.import_module(module), name)(
        **json.loads(arguments)
    )
    start, processor = time.perf_counter(), time.process_time()
    work()
    figures = {
        "seconds": time.perf_counter() - start,
        "processor_s": time.process_time() - processor,
        "peak_mib": _peak_mib(),
    }
    print(json.dumps(figures))


def _peak_mib() -> float:
    """Peak memory of this process (Linux); `ru_maxrss` would hold that of the parent too."""
    status = Path("/proc/self/status").read_text(encoding="ascii")
    line = next(line for line in status.splitlines() if line.startswith("VmHWM:"))
    return int(line.split()[1]) / 1024


def both(function: Callable[..., Any], rows: Iterable[Any]) -> list[Any]:
    """The function of every row, `THREADS` at a time."""
    with ThreadPoolExecutor(THREADS) as pool:
        return list(pool.map(function, rows))


def median_seconds(work: Callable[[], object], repeats: int) -> float:
    """Median time of something small, in this process."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def machine(*modules: str) -> dict[str, str]:
    """What the figures were measured on, with the versions of the given modules."""
    versions = {name: str(importlib.import_module(name).__version__) for name in modules}
    return {
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "load": f"{os.getloadavg()[0]:.1f}",
        "python": platform.python_version(),
    } | versions


def _processor() -> str:
    about = Path("/proc/cpuinfo")
    if about.exists():
        for line in about.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Runs one task and prints its figures.")
    parser.add_argument("function")
    parser.add_argument("arguments")
    chosen = parser.parse_args()
    _child(chosen.function, chosen.arguments)

"""Faults to put into an archive: each damages one tow in a way that cannot be right."""

import random
from collections.abc import Callable
from pathlib import Path

Lines = list[str]
ROWS = 1000
"""Samples of a run: 50 s at 20 Hz."""

CHANNELS = range(1, 6)
"""Columns of log 1, log 2, force, wind speed and wind angle in a file without GPS."""


def _cells(lines: Lines, column: int, first: int, last: int, value: Callable[[str], str]) -> Lines:
    rows = [line.split(";") for line in lines]
    for row in rows[first:last]:
        row[column] = value(row[column])
    return [";".join(row) for row in rows]


def _anywhere(chosen: random.Random, lines: Lines) -> int:
    return chosen.randrange(1, len(lines))


def bad_cell(chosen: random.Random, lines: Lines) -> Lines:
    """Something that is no number."""
    words = ("abc", "NaN", "", "-", "1,2,3", "1e999", "0x1F", "1 2", "=A1", "inf", "12:30", "١٢")
    row = _anywhere(chosen, lines)
    word = chosen.choice(words)
    return _cells(lines, chosen.randrange(6), row, row + 1, lambda _: word)


def absurd_cell(chosen: random.Random, lines: Lines) -> Lines:
    """A number far outside what can be."""
    row, column = _anywhere(chosen, lines), chosen.choice((1, 2, 3, 4, 5))
    word = chosen.choice(("99999", "-4000", "1e6", "123456,7"))
    return _cells(lines, column, row, row + 1, lambda _: word)


def wrong_width(chosen: random.Random, lines: Lines) -> Lines:
    """A row with a field too many or too few."""
    row = _anywhere(chosen, lines)
    cells = lines[row].split(";")
    if chosen.random() < 0.5:
        del cells[chosen.randrange(6)]
    else:
        cells.insert(chosen.randrange(7), "1,0")
    return [*lines[:row], ";".join(cells), *lines[row + 1 :]]


def cut_off(chosen: random.Random, lines: Lines) -> Lines:
    """The file ends early, in a run."""
    row = chosen.randrange(2, len(lines) - 60)
    return [*lines[:row], lines[row][: chosen.randrange(len(lines[row]))]]


def lost_run(chosen: random.Random, lines: Lines) -> Lines:
    """A run is not there."""
    run = f"{chosen.randrange(1, 7)};"
    return [line for line in lines if not line.startswith(run)]


def short_run(chosen: random.Random, lines: Lines) -> Lines:
    """Seconds of a run are not there."""
    run, gone = chosen.randrange(6), chosen.randrange(40, 900)
    begin = 1 + run * ROWS + chosen.randrange(ROWS - gone)
    return lines[:begin] + lines[begin + gone :]


def other_run(chosen: random.Random, lines: Lines) -> Lines:
    """A run number that does not exist."""
    row = _anywhere(chosen, lines)
    word = chosen.choice(("0", "7", "-1", "1,5", "99"))
    return _cells(lines, 0, row, row + 1, lambda _: word)


def torn_run(chosen: random.Random, lines: Lines) -> Lines:
    """Rows of a run stand elsewhere."""
    row = 1 + chosen.randrange(2) * ROWS + chosen.randrange(100, 900)
    return [*lines[:row], *lines[row + 50 :], *lines[row : row + 50]]


def dropout(chosen: random.Random, lines: Lines) -> Lines:
    """A log is zero for seconds."""
    begin = 1 + chosen.randrange(6) * ROWS + chosen.randrange(700)
    return _cells(lines, chosen.choice((1, 2)), begin, begin + chosen.randrange(100, 250), _zero)


def _zero(_: str) -> str:
    return "0,000"


def stuck(chosen: random.Random, lines: Lines) -> Lines:
    """A channel holds one value for half a run or more."""
    column, run = chosen.choice((1, 2, 3)), chosen.randrange(6)
    begin = 1 + run * ROWS + chosen.randrange(200)
    held = lines[begin].split(";")[column]
    return _cells(lines, column, begin, begin + chosen.randrange(500, 780), lambda _: held)


def negative_force(chosen: random.Random, lines: Lines) -> Lines:
    """The load cell pushes."""
    run = chosen.randrange(6)
    begin = 1 + run * ROWS
    return _cells(lines, 3, begin, begin + ROWS, lambda cell: f"-{cell.lstrip('-')}")


def other_unit(chosen: random.Random, lines: Lines) -> Lines:
    """Speeds in km/h under a header of m/s."""
    factor = chosen.choice((3.6, 1.943844, 2.5, 0.25))
    for column in (1, 2):
        lines = _cells(lines, column, 1, len(lines), lambda cell: _times(cell, factor))
    return lines


def _times(cell: str, factor: float) -> str:
    return f"{float(cell.replace(',', '.')) * factor:.3f}".replace(".", ",")


def header(chosen: random.Random, lines: Lines) -> Lines:
    """A header that is not one: a name lost, doubled, exchanged, or with another unit."""
    names = lines[0].split(";")
    column = chosen.randrange(6)
    how = chosen.randrange(4)
    if how == 0:
        names[column] = chosen.choice(("", "x", "speed", "log3 [m/s]"))
    elif how == 1:
        names[column] = names[(column + 1) % 6]
    elif how == 2:
        one, other = chosen.choice(((1, 3), (0, 1), (3, 4), (2, 3), (0, 3)))
        names[one], names[other] = names[other], names[one]
    else:
        names[chosen.choice((1, 2))] = f"log{chosen.choice((1, 2))} [{chosen.choice(('mph', 'x'))}]"
    return [";".join(names), *lines[1:]]


LINES = (
    *(bad_cell, absurd_cell, wrong_width, cut_off, lost_run, short_run, other_run, torn_run),
    *(dropout, stuck, negative_force, other_unit, header),
)


def spoil_samples(chosen: random.Random, file: Path) -> str:
    """Puts one fault in a samples file; returns what it is."""
    fault = chosen.choice(LINES)
    lines = fault(chosen, file.read_text("utf-8").rstrip("\n").split("\n"))
    file.write_text("\n".join(lines) + "\n", "utf-8")
    return fault.__name__


def spoil_bytes(chosen: random.Random, file: Path) -> str:
    """Damages a samples file as a whole."""
    content = file.read_bytes()
    begin = chosen.randrange(len(content) // 2)
    how, damaged = chosen.choice(
        (
            ("empty", b""),
            ("blank", b"\n" * chosen.randrange(1, 99)),
            ("utf-16", content.decode().encode("utf-16")),
            ("zero bytes", content[:begin] + bytes(50) + content[begin:]),
            ("no end", content[: len(content) // 3]),
            ("not text", chosen.randbytes(20_000)),
            ("one line", content.replace(b"\n", b" ")),
        )
    )
    file.write_bytes(damaged)
    return how


def spoil_row(chosen: random.Random, row: str) -> tuple[str, str]:
    """Puts one fault in a row of a tow list; returns the row and what it is."""
    cells = row.split(";")
    place, words = chosen.choice(
        (
            (1, ("", "yesterday", "2009-02-30", "2031-01-01", "08/05/2009")),
            (2, ("", "FSN99999", "=cmd", "../FSN100")),
            (3, ("", "no such file", "../meetdata_2014/x", "/etc/passwd", "..", "a\\b", "C:\\x")),
            (5, ("", "0", "-8", "8,5", "abc", "999")),
            (6, ("", "X", "HD")),
            (7, ("", "0", "-2", "26", "NaN", "abc")),
            (8, ("", "-9", "0", "908", "x")),
            (11, ("-1", "0", "abc", "1e9")),  # empty is unknown, and makes the interval wider
            (16, ("9", "a", "1,2,b4", "1,1,1", "7")),
            (18, ("-20", "0", "abc", "999999999", "40")),
        )
    )
    word = chosen.choice(words)
    cells[place] = word
    return ";".join(cells), f"cell {place} = {word!r}"

"""Every limit of every column that comes from a list: one step outside is set aside, inside not.

The limits are those of the declared tables; nothing here repeats one.
"""

from dataclasses import replace

import pytest

from pipeline.tables.frames import limits
from warehouse.archive import kinds as list_kinds
from warehouse.archive.columns import Column
from warehouse.archive.files import ArchiveFile
from warehouse.archive.list_rules import read_races
from warehouse.archive.lists import read_lists
from warehouse.archive.profile import Profiles

TEXTS = {
    list_kinds.BOATS: """
fsn_nr;ht_nr;sloep;type;roeiers;klasse;lengte [m];breedte [m];hoogte [m];gewicht [kg]
FSN1;1;een;;8;H;8;2;1;600""",
    list_kinds.TOWS: """
sleep_id;datum;fsn_nr;meetfile;roeiers;klasse;roeisnelheid [m/s];meetfrequentie [Hz];correctie [%]
2014-001;2014-03-08;FSN1;a;8;H;2.5;1000;0
lengte [m];breedte [m];hoogte [m];gewicht [kg];gewicht na [kg];bemanning [kg];watertemperatuur [C]
8;2;1;600;600;700;8
vrijboord laagst [m];vrijboord boeg [m];vrijboord achter [m]
0.4;0.5;0.5
doft 1 [m];doft 8 [m];roer hoogte [m];roer breedte [m];roer dikte [m]
1.8;7;0.7;0.3;0.04""",
    list_kinds.WINDOWS: """
sleep_id;run;van [s];tot [s];reden
2014-001;1;5;45;zwaan""",
    list_kinds.FORCE_CHECKS: """
datum;gewicht [kg];aflezing [N]
2014-03-08;100;981""",
    list_kinds.LAMPS: """
sleep_id;run;van [s];tot [s]
2014-001;1;5;45""",
    list_kinds.RACES: """
wedstrijd;datum;afstand [m];fsn_nr;roeiers;klasse;roeitijd;stroom [m];straf [W]
a;2014-06-01;9000;FSN1;8;H;1:00:00;0;0""",
    list_kinds.REGISTERS: """
fsn_nr;roeiers;klasse;A;B [m/s];Cw;roeisnelheid [m/s];sleepdatum
FSN1;8;H;30;5;40;2.5;2014-03-08""",
}
"""A list of each kind with one row; of a wide one in parts below each other."""


def cells_of(text):
    """The cells of the row by their header."""
    heads, cells = (";".join(text.strip().split("\n")[i::2]).split(";") for i in (0, 1))
    return dict(zip(heads, cells, strict=True))


LISTS = {kind.name: (kind, cells_of(text)) for kind, text in TEXTS.items()}


def has_numbers(kind):
    """Whether a list has a column with limits; one of names, days and words has none."""
    declared = kind.table.columns()
    return any(declared[c.key].dtype.is_numeric() for c in kind.columns if c.key in declared)


def test_every_kind_of_list_is_tried():
    assert {kind.name for kind, _ in LISTS.values()} == {
        k.name for k in list_kinds.LIST_KINDS if has_numbers(k)
    }


def read_rows(name, rows, folder):
    """What a list of these rows is read as, by line, and what is wrong on each line."""
    path = folder / "list.csv"
    lines = [";".join(cells) for cells in (rows[0], *(row.values() for row in rows))]
    path.write_text("\n".join([*lines, ""]))
    kind = LISTS[name][0]
    file = ArchiveFile("list.csv", path, kind, 2014, inside=True)
    found = read_lists([file], kind, Profiles())
    values = {row.pop("line"): row for row in found.frame.drop("cells").iter_rows(named=True)}
    return values, {fault.line: fault for fault in found.faults}


def limited(kind, cells):
    """Every limit of a column that a list has: column, header, sign and limit."""
    for column in kind.columns:
        header = next((h for h in cells if h.split(" [")[0] == column.header), None)
        if header is None or column.key not in kind.table.column_names():
            continue
        declared = kind.table.columns()[column.key]
        if not (declared.dtype.is_numeric() and column.key != "run"):
            continue
        for sign, limit in zip((-1, 1), limits(kind.table, column.key), strict=True):
            if limit is not None:
                yield column.key, header, sign, limit


def cell_of(header, value):
    return f"{value * 100 if '%' in header else value:.9g}"


@pytest.mark.parametrize("name", LISTS)
def test_one_step_outside_is_set_aside_and_inside_accepted(name, tmp_path):
    kind, cells = LISTS[name]
    tried = list(limited(kind, cells))
    assert tried
    rows, insides = [], []
    for key, header, sign, limit in tried:
        whole = kind.table.columns()[key].dtype.is_integer()
        step = 1 if whole else 1e-3 * max(1.0, abs(limit))
        usual = dict(cells)
        if key == "end_s":  # a window ends after it begins
            usual["van [s]"] = "0"
        elif key == "start_s":
            usual["tot [s]"] = f"{limits(kind.table, 'end_s')[1]:g}"
        inside = limit if whole and kind is not list_kinds.WINDOWS else limit - sign * step
        insides.append(inside)
        rows += [
            usual,
            usual | {header: cell_of(header, inside)},
            usual | {header: cell_of(header, limit + sign * step)},
        ]
    values, faults = read_rows(name, rows, tmp_path)
    outside_lines = range(4, 2 + len(rows), 3)
    assert faults.keys() == set(outside_lines)
    for (key, *_), inside, line in zip(tried, insides, outside_lines, strict=True):
        assert "can be right" in faults[line].message
        assert faults[line].reason_code == kind.reason_code
        usual, accepted = values[line - 2], values[line - 1]
        assert accepted[key] == pytest.approx(inside), key
        assert accepted | {key: None} == usual | {key: None}


@pytest.mark.parametrize(("season", "fits"), [(1989, False), (1990, True), (2100, True)])
def test_a_season_outside_its_limits_is_set_aside_with_a_sentence(season, fits, tmp_path):
    (tmp_path / "wedstrijden").mkdir()
    race = LISTS[list_kinds.RACES.name][1] | {"datum": f"{season}-06-01"}
    (tmp_path / f"wedstrijden/a_{season}.csv").write_text(
        ";".join(race) + "\n" + ";".join(race.values()) + "\n"
    )
    races, faults = read_races(tmp_path)
    assert (len(races), len(faults)) == (int(fits), int(not fits))
    sentence = f"the year is {season}; 1990 to 2100 can be right."
    assert all(sentence in fault.message for fault in faults)


def test_a_tow_list_of_an_impossible_year_is_set_aside(archive):
    """The rest of the archive is read all the same."""
    lists = archive.root / "sleeplijsten"
    text = (lists / "sleeplijst_2014.csv").read_text("utf-8")
    (lists / "sleeplijst_1985.csv").write_text(
        text.replace("2014-0", "1985-0").replace(";2014-", ";1985-"), "utf-8"
    )
    found = archive.scan()
    assert len(found.good) == 3
    assert {f.path for f in found.faults} == {"sleeplijsten/sleeplijst_1985.csv"}


def test_a_column_that_its_table_cannot_hold_is_refused():
    columns = (*list_kinds.TOWS.columns, Column("boatman", "bootsman", required=False))
    with pytest.raises(LookupError, match=r"ListedTows has no column boatman: .*pipeline/tables/"):
        replace(list_kinds.TOWS, columns=columns)

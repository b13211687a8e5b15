"""Every limit of every column that comes from a list: one step outside is set aside, inside not.

The limits are those of the declared tables; nothing here repeats one.
"""

import pytest

from pipeline.tables.frames import limits
from warehouse.archive.files import list_kinds
from warehouse.archive.files.finding import ArchiveFile
from warehouse.archive.lists.races import read_races
from warehouse.archive.profile.definition import Profiles
from warehouse.archive.sheets.reading import read_list
from warehouse.archive.sheets.rows import faults_of

TOW = {
    "sleep_id": "2014-001",
    "datum": "2014-03-08",
    "fsn_nr": "FSN1",
    "meetfile": "a",
    "roeiers": "8",
    "klasse": "H",
    "roeisnelheid [m/s]": "2.5",
    "lengte [m]": "8",
    "breedte [m]": "2",
    "hoogte [m]": "1",
    "gewicht [kg]": "600",
    "gewicht na [kg]": "600",
    "bemanning [kg]": "700",
    "watertemperatuur [C]": "8",
    "correctie [%]": "0",
    "meetfrequentie [Hz]": "1000",
    "vrijboord laagst [m]": "0.4",
    "vrijboord boeg [m]": "0.5",
    "vrijboord achter [m]": "0.5",
}
BOAT = {
    "fsn_nr": "FSN1",
    "ht_nr": "1",
    "sloep": "een",
    "type": "",
    "roeiers": "8",
    "klasse": "H",
    **{k: TOW[k] for k in ("lengte [m]", "breedte [m]", "hoogte [m]", "gewicht [kg]")},
}
WINDOW = {"sleep_id": "2014-001", "run": "1", "van [s]": "5", "tot [s]": "45", "reden": "zwaan"}
CHECK = {"datum": "2014-03-08", "gewicht [kg]": "100", "aflezing [N]": "981"}
LAMP = {key: WINDOW[key] for key in ("sleep_id", "run", "van [s]", "tot [s]")}
RACE = {
    "wedstrijd": "a",
    "datum": "2014-06-01",
    "afstand [m]": "9000",
    "fsn_nr": "FSN1",
    "roeiers": "8",
    "klasse": "H",
    "roeitijd": "1:00:00",
    "stroom [m]": "0",
    "straf [W]": "0",
}
PRINTED = {
    "fsn_nr": "FSN1",
    "roeiers": "8",
    "klasse": "H",
    "A": "30",
    "B [m/s]": "5",
    "Cw": "40",
    "roeisnelheid [m/s]": "2.5",
    "sleepdatum": "2014-03-08",
}


LISTS = {
    "boats": (list_kinds.BOATS, BOAT),
    "tows": (list_kinds.TOWS, TOW),
    "windows": (list_kinds.WINDOWS, WINDOW),
    "checks": (list_kinds.FORCE_CHECKS, CHECK),
    "lamps": (list_kinds.LAMPS, LAMP),
    "races": (list_kinds.RACES, RACE),
    "registers": (list_kinds.REGISTERS, PRINTED),
}


def test_every_kind_of_list_is_tried():
    assert {kind.name for kind, _ in LISTS.values()} == {k.name for k in list_kinds.LIST_KINDS}


def values_of(name, cells, folder):
    """What a list of one row is read as, and what is wrong in it."""
    path = folder / "list.csv"
    path.write_text(";".join(cells) + "\n" + ";".join(cells.values()) + "\n")
    file = ArchiveFile("list.csv", path, "", 2014, inside=True)
    rows, found = read_list(file, LISTS[name][0], Profiles())
    return rows.drop("cells").row(0, named=True), faults_of(rows, found)


def limited():
    """Every limit of a column that a list has: list, column, header, sign and limit."""
    for name, (kind, cells) in LISTS.items():
        for column in kind.columns:
            header = next((h for h in cells if h.split(" [")[0] == column.header), None)
            if header is None or column.key not in kind.table.column_names():
                continue
            declared = kind.table.columns()[column.key]
            if not (declared.dtype.is_numeric() and column.key != "run"):
                continue
            for sign, limit in zip((-1, 1), limits(kind.table, column.key), strict=True):
                if limit is not None:
                    yield pytest.param(
                        name, column.key, header, sign, limit, id=f"{name}-{column.key}-{sign}"
                    )


def cell_of(header, value):
    return f"{value * 100 if '%' in header else value:.9g}"


@pytest.mark.parametrize(("name", "key", "header", "sign", "limit"), list(limited()))
def test_one_step_outside_is_set_aside_and_inside_accepted(
    name, key, header, sign, limit, tmp_path
):
    kind, cells = LISTS[name]
    whole = kind.table.columns()[key].dtype.is_integer()
    step = 1 if whole else 1e-3 * max(1.0, abs(limit))
    others = dict(cells)
    if key in ("start_s", "end_s"):  # a window ends after it begins
        others |= {"van [s]": "0"} if key == "end_s" else {"tot [s]": "600"}
    inside = limit if whole and name != "windows" else limit - sign * step
    accepted, faults = values_of(name, others | {header: cell_of(header, inside)}, tmp_path)
    assert faults == []
    assert accepted[key] == pytest.approx(inside)
    usual, _ = values_of(name, others, tmp_path)
    assert {k: v for k, v in accepted.items() if k != key} == {
        k: v for k, v in usual.items() if k != key
    }
    outside = others | {header: cell_of(header, limit + sign * step)}
    _, (fault,) = values_of(name, outside, tmp_path)
    assert "can be right" in fault.message
    assert (fault.reason_code, fault.line) == (kind.reason_code, 2)


@pytest.mark.parametrize(("season", "fits"), [(1989, False), (1990, True), (2100, True)])
def test_a_season_outside_its_limits_is_set_aside_with_a_sentence(season, fits, tmp_path):
    (tmp_path / "wedstrijden").mkdir()
    race = RACE | {"datum": f"{season}-06-01"}
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

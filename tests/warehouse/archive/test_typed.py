"""An archive as a volunteer keeps it: three rounds of `check`, and nothing to rename or convert."""

import polars as pl
import xlsxwriter

from tests.warehouse.archive.conftest import BOATS, FIRST, HEADER, RATE_HZ, TOWS, Archive, Scan
from warehouse.archive.check import check_archive

SECOND = "meetdata_2014/tweede boot 6d 2014.csv"
THIRD = "meetdata_2014/derde boot 12h 2014.csv"
TWO_HEADER_ROWS = (
    "Sleepproef;;;;;;\nRun;Log 1;Log 2;GPS;Trekkracht;Wind;Windhoek\n;m/s;m/s;m/s;kg;m/s;graden"
)
ROUNDS = (
    {
        '"lijsten/boten.csv"': '[files]\n"lijsten/boten.csv" = "sloependata"',
        '"lijsten/slepen.csv"': '"lijsten/slepen.csv" = "sleeplijst_2014"',
        '"metingen" = "?"': '"metingen" = "meetdata_2014"',
    },
    {
        '"nr" = "?"': '[headers]\n"nr" = "sleep_id"',
        '"ploeg" = "?"': '"ploeg" = "roeiers"',
        '"boeg" = "?"': '"boeg" = "hoogte"',
        '"kilo" = "?"': '"kilo" = "gewicht"',
        'columns.log1 = "?"  # "snelheid"': (
            '[[profile]]\nseasons = "2014"\ncolumns.log1 = "snelheid"'
        ),
    },
    {
        f"sample_rate_hz = {RATE_HZ}": f"sample_rate_hz = {RATE_HZ}",
        '"tweede sloep" = "?"': '[words]\n"tweede sloep" = "tweede boot"',
    },
)
"""What is typed in each round, by what `check` prints of it."""


def type_by_hand(archive: Archive) -> None:
    """Lists and samples under other names, in five ways of writing."""
    root = archive.root
    (root / "lijsten").mkdir()
    pl.read_csv(root / TOWS, separator=";", infer_schema=False).select(
        pl.Series("boot", ["EERSTE  BOOT", "tweede sloep", "Derde boot"]),
        "datum",
        pl.col("roeisnelheid [m/s]", "lengte [m]", "breedte [m]").name.map(
            lambda name: name.partition(" ")[0]
        ),
        nr="sleep_id",
        bestand="meetfile",
        ploeg=pl.col("roeiers") + pl.col("klasse"),
        boeg="hoogte [m]",
        kilo="gewicht [kg]",
    ).write_csv(root / "lijsten/slepen.csv", separator=";")
    (root / TOWS).unlink()
    (root / BOATS).rename(root / "lijsten/boten.csv")
    for path in (FIRST, SECOND, THIRD):
        archive.cells(4, lambda cell, _: in_kgf(cell), 2, 6 * 50 * RATE_HZ + 1, path)
    archive.edit(FIRST, lambda text: with_clock(text.replace("log1 [m/s]", "snelheid")))
    archive.replace(SECOND, HEADER, TWO_HEADER_ROWS)
    rows = [line.split(";") for line in (root / THIRD).read_text("utf-8").splitlines()]
    with xlsxwriter.Workbook(root / "meetdata_2014/proeven.xlsx") as book:
        sheet = book.add_worksheet("derde boot 12h 2014")
        sheet.write_row(0, 0, ["run", "log1", "log2", "gps", "kracht [kg]", "wind", "windhoek"])
        for line, row in enumerate(rows[1:], 1):
            sheet.write_row(line, 0, [float(cell.replace(",", ".")) for cell in row])
    (root / THIRD).unlink()
    (root / "meetdata_2014").rename(root / "metingen")


def in_kgf(cell: str) -> str:
    return f"{float(cell.replace(',', '.')) / 9.80665:.6f}".replace(".", ",")


def with_clock(text: str) -> str:
    header, *rows = text.replace("kracht [N]", "kracht [kg]").replace(";", "\t").splitlines()
    clocks = (
        f"10:{i // 1200:02d}:{i % 1200 / RATE_HZ:05.2f}".replace(".", ",") for i in range(len(rows))
    )
    return "\n".join(["tijd\t" + header, *map("\t".join, zip(clocks, rows, strict=True)), ""])


def test_three_rounds_of_check_make_it_ready(archive: Archive, good_scan: Scan) -> None:
    type_by_hand(archive)
    profile = archive.root / "archief.toml"
    for answers in ROUNDS:
        causes = check_archive(archive.root).causes
        offered = "\n".join(line for cause in causes for line in cause.settings)
        assert [asked for asked in answers if asked not in offered] == []
        typed = profile.read_text("utf-8") if profile.exists() else ""
        profile.write_text("\n".join([typed, *answers.values()]), "utf-8")
    checked = check_archive(archive.root)
    assert [cause.sentence for cause in checked.causes] == []
    scan = archive.scan()
    assert not scan.faults
    assert checked.tows == len(scan.good) == 3
    for tow, samples in scan.good.items():
        force = good_scan.good[tow]["force_n"]
        assert abs(samples["force_n"] - force).max() < 1e-2

"""An empty archive to begin with: folders, spreadsheets that check what is filled in, a page."""

import datetime as dt
from pathlib import Path
from typing import Final

from pipeline.errors import MissingKnowledgeError
from pipeline.tables.declare import dy
from pipeline.toml_text import decode_toml
from warehouse.archive.columns import Column
from warehouse.archive.kinds import BOATS, LIST_KINDS, TOWS, ListKind
from warehouse.archive.profile import PROFILE_FILE, Profiles, parse_profiles

FOLDERS: Final = ("sloepregister", "sleeplijsten", "meetdata_2025", "wedstrijden")
MOST_ROWS: Final = 500
README: Final = """\
# Een sleeparchief voor Herijk

1. Vul `sloepregister/sloependata.xlsx` in: een rij per sloep. Een tweede ploeg of een nieuwe naam
   van dezelfde sloep is een tweede rij met hetzelfde `fsn_nr`.
2. Vul per seizoen een sleeplijst in: kopieer `sleeplijsten/sleeplijst_2025.xlsx` en zet het jaar in
   de naam. Een rij per sleepproef. `meetfile` is de naam van het bestand met metingen.
3. Zet de metingen in `meetdata_<jaar>/`, een bestand per sleepproef (CSV, TXT of Parquet), met de
   kolommen

       run; log1 [m/s]; log2 [m/s]; gps [m/s]; kracht [N]; wind [m/s]; wind [gra]

   Is het bij u anders? Zeg dat dan een keer per reeks seizoenen in `archief.toml`:

   - elke run een eigen bestand: `runs = "file"`, en in `run_files` hoe die bestanden heten;
   - alle runs in een opname: `runs = "windows"`, en begin en eind van elke run in
     `sleeplijsten/vensters_<jaar>.csv`;
   - een instrument niet aan boord: `absent = ["wind"]` (of "log2", "gps");
   - een trage gps, met lege cellen ertussen: `hold = ["gps"]`;
   - een kolom die anders heet: `columns = { log1 = "Snelheid A" }`; een eenheid die niet in de kop
     staat: `units = { force = "kgf" }`.

   Bestanden van LabVIEW (.lvm) worden niet gelezen: exporteer ze als .tdms of CSV.
4. Kijk wat er nog mis is, zonder iets te veranderen:

       herijk check MAP

   Wat Herijk niet kent, vraagt het bij naam, met de regel voor `archief.toml`. Het raadt nooit.
5. Reken alles uit: `herijk rebuild --archive MAP`.

De rijen met VOORBEELD in de lijsten zijn een voorbeeld: haal ze weg. Wat niet
kan kloppen weigeren ze bij het invullen. Alles staat op de bladzijde docs/nl/archive.md van Herijk.
"""
PROFILE: Final = """\
# Wat in dit archief anders is dan gewoon. Alles mag weg; haal de # weg van wat u nodig hebt.

# ignore = ["Weer"]                    # kolommen die niet gebruikt worden

# [publication]
# publisher = "Federatie ..."          # wie de uitkomsten uitgeeft
# licence = "CC-BY-4.0"                # wat anderen ermee mogen: een SPDX-naam of een webadres

# [words]
# hrn = "H"                            # wat in een lijst staat = wat het betekent

# [headers]
# "Proef" = "sleep_id"                 # kop in een lijst = naam die Herijk kent

# [[profile]]
# seasons = "2025"
# columns = { log1 = "Snelheid A" }    # kop in de metingen
# absent = ["wind"]                    # wat niet gemeten is: wind, log2, gps
# runs = "file"                        # elke run een bestand; "windows": alle runs in een opname
# sample_rate_hz = 500

# [[plan]]
# seasons = "2025"
# targets = [0.9, 0.9, 1.0, 1.0, 1.1, 1.1]
# directions = ["out", "back", "out", "back", "out", "back"]
# seconds = 50
"""
EXAMPLE_BOAT: Final = {
    "fsn_no": "FSN999", "name": "VOORBEELD", "boat_type": "Kromhout", "waterline_length_m": 8.05,
    "beam_m": 2.25, "bow_height_m": 0.9, "weight_kg": 980, "rowers": 8, "crew_class": "H",
}  # fmt: skip
EXAMPLE_TOW: Final = {
    "tow_id": "VOORBEELD", "tow_date": "2025-03-01", "fsn_no": "FSN999",
    "file": "voorbeeld 8h 2025",
    "rowers": 8, "crew_class": "H", "declared_speed_m_s": 2.45, "weight_kg": 980,
    "crew_weight_kg": 760, "water_temperature_c": 8.5, "use_runs": "1-6", "altered": "nee",
}  # fmt: skip
DUTCH: Final = ("Kan dit kloppen?", "Verwacht wordt {:g} tot {:g}.")
ENGLISH: Final = ("Can this be right?", "{:g} to {:g} is expected.")
"""Title and text of what a spreadsheet says of a number outside its limits."""
YES_OR_NO: Final = ("ja", "nee")


def write_templates(root: Path, profile: Path | None = None) -> None:
    """Make an empty archive.

    Args:
        root: its folder.
        profile: an `archief.toml`, with whose names of files, columns and classes it is made; it
            is copied. Without one the archive is that of the Dutch federation.

    Raises:
        MissingKnowledgeError: there is something in the folder already, or the profile cannot be
            understood.
    """
    if root.exists() and any(root.iterdir()):
        raise MissingKnowledgeError("{} is not empty; name a folder that is new", root)
    if profile is not None:
        _write_own_templates(root, profile)
        return
    for folder in FOLDERS:
        (root / folder).mkdir(parents=True, exist_ok=True)
    (root / "LEESMIJ.md").write_text(README, encoding="utf-8")
    (root / PROFILE_FILE).write_text(PROFILE, encoding="utf-8")
    _write_list(root / "sloepregister/sloependata.xlsx", BOATS, EXAMPLE_BOAT, Profiles())
    _write_list(root / "sleeplijsten/sleeplijst_2025.xlsx", TOWS, EXAMPLE_TOW, Profiles())


def _write_own_templates(root: Path, profile: Path) -> None:
    """Make an empty archive with the names of a profile; its lists have no example."""
    try:
        text = decode_toml(profile.read_bytes())
    except (OSError, ValueError) as error:
        raise MissingKnowledgeError("{} cannot be read: {}", profile, error) from error
    profiles = parse_profiles(text)
    year = str(dt.date.today().year)
    (root / profiles.samples_place.replace("{year}", year)).mkdir(parents=True)
    for kind in LIST_KINDS:
        path = root / f"{profiles.find_place(kind).replace('{year}', year)}.xlsx"
        is_needed = kind in (BOATS, TOWS)
        if is_needed or kind.name in profiles.files:
            path.parent.mkdir(exist_ok=True)
        if is_needed:
            _write_list(path, kind, {}, profiles)
    (root / PROFILE_FILE).write_text(text, encoding="utf-8")


def _write_list(path: Path, kind: ListKind, example: dict[str, object], profiles: Profiles) -> None:
    """Write a spreadsheet with a header, an example, and a check on each column with limits."""
    import xlsxwriter  # type: ignore[import-untyped]  # noqa: PLC0415 - only here

    with xlsxwriter.Workbook(str(path)) as book:
        sheet = book.add_worksheet("lijst")
        bold = book.add_format({"bold": True, "bottom": 1})
        sheet.freeze_panes(1, 0)
        for place, column in enumerate(profiles.rename_columns(kind.columns)):
            sheet.set_column(place, place, max(10, len(column.named) + 2))
            sheet.write(0, place, column.named, bold)
            sheet.write(1, place, example.get(column.key, ""))
            rule = _rule(column, kind.table, profiles)
            if rule is not None:
                sheet.data_validation(1, place, MOST_ROWS, place, rule)


def _rule(column: Column, table: type[dy.Schema], profiles: Profiles) -> dict[str, object] | None:
    """Return the rule of a spreadsheet for a column: the limits that its table declares."""
    if column.key == "crew_class":
        return {"validate": "list", "source": profiles.crew_classes["crew_class"].to_list()}
    if column.key == "altered":
        own = [word for word, meant in profiles.words.items() if meant in YES_OR_NO]
        return {"validate": "list", "source": own or list(YES_OR_NO)}
    declared = table.columns().get(column.key)
    if not isinstance(declared, dy.Float64 | dy.Int32) or column.dimension == "ratio":
        return None
    title, message = DUTCH if profiles == Profiles() else ENGLISH
    lowest, highest = declared.min, declared.max
    if lowest is None or highest is None:
        return None
    return {
        "validate": "decimal" if isinstance(declared, dy.Float64) else "integer",
        "criteria": "between",
        "minimum": lowest,
        "maximum": highest,
        "error_title": title,
        "error_message": message.format(lowest, highest),
    }

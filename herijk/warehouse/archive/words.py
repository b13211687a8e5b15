"""Words that people use in the archive beside the project's own: names of columns and values.

Dutch, English and German. `archief.toml` extends both: `columns` of a profile and `[headers]` name
columns, `[words]` names values. What one word can mean in two ways is not here.
"""

from collections.abc import Mapping
from typing import Final

HEADERS: Final[Mapping[str, tuple[str, ...]]] = {
    # boats and tow lists
    "fsn_no": ("fsn", "fsn nummer", "fsn no", "sloepnummer", "boat number", "boat no",
               "bootsnummer", "bootnummer", "zeilnummer", "sail number", "hull number", "hull no"),
    "ht_no": ("ht", "ht nummer", "ht no"),
    "name": ("naam", "sloepnaam", "naam sloep", "boot", "bootnaam", "name", "boat", "boat name",
             "bootsname", "vessel", "vessel name"),
    "boat_type": ("sloeptype", "type sloep", "boottype", "soort", "model",
                  "boat type", "class of boat", "design",
                  "bootstyp", "typ"),
    "waterline_length_m": ("lengte waterlijn", "waterlijn", "waterlijnlengte", "lwl", "length",
                           "waterline length", "länge", "wasserlinie"),
    "beam_m": ("breed", "beam", "breadth", "width", "breite"),
    "bow_height_m": ("hoogte boeg", "boeghoogte", "height", "bow height", "höhe", "bughöhe"),
    "weight_kg": ("gewicht voor", "gewicht sloep", "sloepgewicht", "gewicht leeg", "leeggewicht",
                  "weight", "weight before", "boat weight", "gewicht boot", "hull weight",
                  "massa", "mass", "hull mass", "bootsgewicht", "leergewicht", "gewogen gewicht"),
    "rowers": ("aantal roeiers", "roeier", "riemen", "aantal riemen", "n roeiers", "rowers",
               "crew size", "oars", "ruderer", "roeiers", "personen", "pers", "man"),
    "crew_class": ("class", "crew class", "categorie", "category", "kategorie", "geslacht",
                   "gender", "sex", "geschlecht", "h/d", "m/v", "m/w"),
    "tow_id": ("sleep", "sleepnummer", "sleepnr", "sleep nummer", "proef", "proefnummer", "proefnr",
               "id",
               "tow", "tow id", "tow number", "test number", "test no", "test id", "schleppnummer",
               "versuch", "versuchsnummer"),
    "tow_date": ("datum sleepproef", "sleepdatum", "date", "tow date", "dag"),
    "file": ("meetbestand", "bestand", "bestandsnaam", "file", "filename", "file name", "datei",
             "messdatei", "bestand heen", "meetfile heen", "file out", "datei hin"),
    "second_file": ("meetbestand2", "bestand2", "tweede meetfile", "meetfile b", "file2",
                    "second file", "bestand terug", "meetfile terug", "file back", "datei zurück"),
    "declared_speed_m_s": ("opgegeven snelheid", "snelheid", "opgegeven roeisnelheid", "v0",
                           "declared speed", "rowing speed", "rudergeschwindigkeit",
                           "streefsnelheid", "doelsnelheid", "target speed", "design speed",
                           "sollgeschwindigkeit"),
    "weight_after_kg": ("gewicht na afloop", "gewicht achteraf", "weight after"),
    "crew_weight_kg": ("gewicht bemanning", "bemanningsgewicht", "gewicht ploeg", "ploeggewicht",
                       "crew weight", "crew mass", "mannschaftsgewicht"),
    "water_temperature_c": ("temperatuur", "temperatuur water", "temp", "water temp", "watertemp",
                            "water temperature", "temperature", "wassertemperatur"),
    "speed_correction_ratio": ("snelheidscorrectie", "correction", "speed correction",
                               "korrektur"),
    "use_runs": ("runs", "gebruikte runs", "te gebruiken runs", "runs gebruikt", "geldige runs",
                 "vaarten", "geldige vaarten", "use runs",
                 "runs to use", "läufe", "verwendete läufe"),
    "altered": ("verbouwing", "gewijzigd", "altered", "changed", "umgebaut"),
    "sample_rate_hz": ("frequentie", "bemonstering", "sample rate", "samplerate", "frequency",
                       "rate", "messfrequenz", "abtastrate"),
    "empty_thwart": ("doft leeg", "vrije doft", "empty thwart"),
    "freeboard_lowest_m": ("laagste vrijboord", "freeboard", "lowest freeboard"),
    "freeboard_bow_m": ("vrijboord voor", "freeboard bow"),
    "freeboard_stern_m": ("vrijboord spiegel", "freeboard stern"),
    "remark": ("opmerkingen", "bijzonderheden", "notitie", "remark", "remarks", "comment",
               "comments", "notes", "bemerkung", "bemerkungen"),
    # samples
    "run": ("runnr", "run nr", "run nummer", "run no", "run number", "vaart", "lauf"),
    "log1": ("log 1", "log a", "snelheid log1", "snelheid log 1", "speed log 1", "log"),
    "log2": ("log b", "snelheid log2", "snelheid log 2", "speed log 2"),
    "gps": ("dgps", "gnss", "dgnss", "gps snelheid", "snelheid gps", "gps speed", "sog",
            "speed over ground", "gps geschwindigkeit"),
    "force": ("trekkracht", "sleepkracht", "force", "tow force", "kraft", "zugkraft", "load",
              "load cell", "krachtopnemer"),
    "wind_speed": ("windsnelheid", "wind snelheid", "wind speed", "windgeschwindigkeit",
                   "apparent wind speed", "aws"),
    "wind_angle": ("windrichting", "windhoek", "wind richting", "wind hoek", "windvaan",
                   "wind direction", "wind angle", "windrichtung", "apparent wind angle", "awa"),
    "time": ("tijdstip", "time", "zeit", "x value", "timestamp", "klok", "clock", "utc",
             "utc time", "tijd utc", "datetime", "date time", "datumtijd"),
    # windows by hand, registers, races
    "start_s": ("start", "begin", "from"),
    "end_s": ("eind", "einde", "end", "to"),
    "reason": ("waarom", "why", "reason", "grund"),
    "race": ("race", "wedstrijdnaam", "evenement", "regatta", "rennen"),
    "race_date": ("date", "dag", "wedstrijddatum"),
    "distance_m": ("distance", "lengte baan", "strecke"),
    "rowing_time_s": ("tijd", "rowing time", "time", "zeit", "ruderzeit"),
    "stream_m": ("stream", "current", "stroming", "strömung"),
    "penalty_w": ("strafwatt", "straf watt", "penalty", "strafe"),
}  # fmt: skip
"""Other names of a column, by its key."""

NOTHING: Final = frozenset(
    {"-", "--", "---", "n.v.t.", "nvt", "n.v.t", "n/a", "na", "n.a.", "onbekend", "unknown",
     "unbekannt", "geen", "none", "?", "...", "niet gemeten", "entfällt"}
)  # fmt: skip
"""Values that say that there is none."""

CLASSES: Final[Mapping[str, str]] = {
    "h": "H", "heren": "H", "heer": "H", "mannen": "H", "man": "H", "men": "H", "herren": "H",
    "männer": "H", "male": "H",
    "d": "D", "dames": "D", "dame": "D", "vrouwen": "D", "vrouw": "D", "women": "D", "ladies": "D",
    "damen": "D", "frauen": "D", "female": "D",
}  # fmt: skip

YES: Final = frozenset({"ja", "wel", "j", "yes", "y", "x", "✓", "✔", "waar", "true", "wahr", "1"})
NO: Final = frozenset({"nee", "niet", "n", "neen", "no", "nein", "onwaar", "false", "falsch", "0"})
ALL_RUNS: Final = frozenset({"alle", "allemaal", "all", "alles"})

"""Words that people use in the archive beside the project's own: names of columns and values.

Dutch, English, German and French. `archief.toml` extends both: `columns` of a profile and
`[headers]` name columns, `[words]` names values. What one word can mean in two ways is not here.
"""

from collections.abc import Mapping
from typing import Final

HEADERS: Final[Mapping[str, tuple[str, ...]]] = {
    # boats and tow lists
    "fsn_no": ("fsn", "fsn nummer", "fsn no", "sloepnummer", "boat number", "boat no",
               "bootsnummer", "bootnummer", "zeilnummer", "sail number", "hull number", "hull no",
               "sloepnr", "bootnr", "boat nr", "n bateau", "n du bateau", "numéro bateau",
               "numéro du bateau"),
    "ht_no": ("ht", "ht nummer", "ht no"),
    "name": ("naam", "sloepnaam", "naam sloep", "boot", "bootnaam", "name", "boat", "boat name",
             "bootsname", "vessel", "vessel name", "nom", "nom du bateau", "bateau"),
    "boat_type": ("sloeptype", "type sloep", "boottype", "soort", "model", "boat type",
                  "class of boat", "design", "bootstyp", "typ", "type de bateau", "modèle"),
    "waterline_length_m": ("lengte waterlijn", "waterlijn", "waterlijnlengte", "lwl", "length",
                           "waterline length", "länge", "wasserlinie", "lengte wl",
                           "length at waterline", "length waterline", "longueur",
                           "longueur flottaison", "longueur à la flottaison",
                           "ligne de flottaison"),
    "beam_m": ("breed", "beam", "breadth", "width", "breite", "largeur",
               "grootste breedte"),
    "bow_height_m": ("hoogte boeg", "boeghoogte", "height", "bow height", "höhe", "bughöhe",
                     "hauteur", "hauteur d'étrave", "hauteur étrave"),
    "weight_kg": ("gewicht voor", "gewicht sloep", "sloepgewicht", "gewicht leeg", "leeggewicht",
                  "weight", "weight before", "boat weight", "gewicht boot", "hull weight", "massa",
                  "mass", "hull mass", "bootsgewicht", "leergewicht", "gewogen gewicht", "poids",
                  "poids du bateau", "poids avant", "masse"),
    "rowers": ("aantal roeiers", "roeier", "riemen", "aantal riemen", "n roeiers", "rowers",
               "crew size", "oars", "ruderer", "roeiers", "personen", "pers", "man",
               "number of rowers", "no of rowers", "rameurs", "nombre de rameurs"),
    "crew_class": ("class", "crew class", "categorie", "category", "kategorie", "geslacht",
                   "gender", "sex", "geschlecht", "h/d", "m/v", "m/w", "catégorie", "classe",
                   "sexe", "heren/dames"),
    "tow_id": ("sleep", "sleepnummer", "sleepnr", "sleep nummer", "proef", "proefnummer",
               "proefnr", "id", "tow", "tow id", "tow number", "test number", "test no", "test id",
               "schleppnummer", "versuch", "versuchsnummer", "proef nr", "test nr", "n essai",
               "numéro essai", "numéro d'essai", "essai"),
    "tow_date": ("datum sleepproef", "sleepdatum", "date", "tow date", "dag", "sleepdag",
                 "test date", "date de l'essai"),
    "file": ("meetbestand", "bestand", "bestandsnaam", "file", "filename", "file name", "datei",
             "messdatei", "bestand heen", "meetfile heen", "file out", "datei hin", "data",
             "data file", "datafile", "data folder", "databestand", "meetmap", "fichier",
             "fichier de mesure", "dossier"),
    "second_file": ("meetbestand2", "bestand2", "tweede meetfile", "meetfile b", "file2",
                    "second file", "bestand terug", "meetfile terug", "file back", "datei zurück",
                    "second fichier", "fichier 2", "fichier retour"),
    "declared_speed_m_s": ("opgegeven snelheid", "snelheid", "opgegeven roeisnelheid", "v0",
                           "declared speed", "rowing speed", "rudergeschwindigkeit",
                           "streefsnelheid", "doelsnelheid", "target speed", "design speed",
                           "sollgeschwindigkeit", "vitesse déclarée", "vitesse", "vitesse cible",
                           "vitesse d'aviron", "speed"),
    "weight_after_kg": ("gewicht na afloop", "gewicht achteraf", "weight after", "poids après"),
    "crew_weight_kg": ("gewicht bemanning", "bemanningsgewicht", "gewicht ploeg", "ploeggewicht",
                       "crew weight", "crew mass", "mannschaftsgewicht", "poids équipage",
                       "poids de l'équipage"),
    "water_temperature_c": ("temperatuur", "temperatuur water", "temp", "water temp", "watertemp",
                            "water temperature", "temperature", "wassertemperatur", "temp water",
                            "température", "température eau", "température de l'eau",
                            "t water"),
    "speed_correction_ratio": ("snelheidscorrectie", "correction", "speed correction",
                               "korrektur"),
    "use_runs": ("runs", "gebruikte runs", "te gebruiken runs", "runs gebruikt", "geldige runs",
                 "vaarten", "geldige vaarten", "use runs", "runs to use", "läufe",
                 "verwendete läufe", "passages", "passages utilisés", "passages valables"),
    "altered": ("verbouwing", "gewijzigd", "altered", "changed", "umgebaut", "modifié",
                "transformé"),
    "sample_rate_hz": ("frequentie", "bemonstering", "sample rate", "samplerate", "frequency",
                       "rate", "messfrequenz", "abtastrate", "fréquence", "fréquence de mesure"),
    "empty_thwart": ("doft leeg", "vrije doft", "empty thwart", "banc libre", "banc vide"),
    "freeboard_lowest_m": ("laagste vrijboord", "freeboard", "lowest freeboard"),
    "freeboard_bow_m": ("vrijboord voor", "freeboard bow"),
    "freeboard_stern_m": ("vrijboord spiegel", "freeboard stern"),
    "remark": ("opmerkingen", "bijzonderheden", "notitie", "remark", "remarks", "comment",
               "comments", "notes", "bemerkung", "bemerkungen", "remarques", "remarque",
               "commentaires"),
    # samples
    "run": ("runnr", "run nr", "run nummer", "run no", "run number", "vaart", "vaart nr", "vaartnr",
            "lauf", "passage", "parcours"),
    "log1": ("log 1", "log a", "snelheid log1", "snelheid log 1", "speed log 1", "log",
             "speed through water", "speed through water 1", "stw", "stw1", "water speed 1",
             "boat speed 1", "log port", "snelheid water", "snelheid door water", "vitesse eau",
             "vitesse eau 1", "vitesse loch 1", "loch 1", "fahrt durchs wasser"),
    "log2": ("log b", "snelheid log2", "snelheid log 2", "speed log 2", "speed through water 2",
             "stw2", "water speed 2", "boat speed 2", "log starboard", "log stb", "vitesse eau 2",
             "vitesse loch 2", "loch 2"),
    "gps": ("dgps", "gnss", "dgnss", "gps snelheid", "snelheid gps", "gps speed", "sog",
            "speed over ground", "gps geschwindigkeit", "vitesse gps", "vitesse fond",
            "fahrt über grund"),
    "force": ("trekkracht", "sleepkracht", "force", "tow force", "kraft", "zugkraft", "load",
              "load cell", "krachtopnemer", "trek", "sleeplijn", "pull", "tow line", "traction",
              "effort", "force de traction"),
    "wind_speed": ("windsnelheid", "wind snelheid", "wind speed", "windgeschwindigkeit",
                   "apparent wind speed", "aws", "vent vitesse", "vitesse vent",
                   "vitesse du vent"),
    "wind_angle": ("windrichting", "windhoek", "wind richting", "wind hoek", "windvaan",
                   "wind direction", "wind angle", "windrichtung", "apparent wind angle", "awa",
                   "vent direction", "vent angle", "direction vent", "direction du vent",
                   "angle du vent"),
    "time": ("tijdstip", "time", "zeit", "x value", "timestamp", "klok", "clock", "utc",
             "utc time", "tijd utc", "sec", "seconds", "seconden", "elapsed",
             "elapsed time", "datetime", "date time", "datumtijd", "temps", "heure", "horodatage"),
    # windows by hand, registers, races
    "start_s": ("start", "begin", "from"),
    "end_s": ("eind", "einde", "end", "to"),
    "reason": ("waarom", "why", "reason", "grund"),
    "race": ("race", "wedstrijdnaam", "evenement", "regatta", "rennen", "course", "régate"),
    "race_date": ("date", "dag", "wedstrijddatum"),
    "distance_m": ("distance", "lengte baan", "strecke"),
    "rowing_time_s": ("tijd", "rowing time", "time", "zeit", "ruderzeit"),
    "stream_m": ("stream", "current", "stroming", "strömung"),
    "penalty_w": ("strafwatt", "straf watt", "penalty", "strafe"),
}  # fmt: skip
"""Other names of a column, by its key."""

NOTHING: Final = frozenset(
    {"-", "--", "---", "n.v.t.", "nvt", "n.v.t", "n/a", "na", "n.a.", "onbekend", "unknown",
     "unbekannt", "geen", "none", "?", "...", "niet gemeten", "entfällt", "inconnu", "néant",
     "pas mesuré", "n.b.", "nb"}
)  # fmt: skip
"""Values that say that there is none."""

NO_TYPE: Final = frozenset(
    {"overig", "overige", "overigen", "anders", "andere", "divers", "diverse", "diversen",
     "eenling", "eigen ontwerp", "other", "others", "misc", "miscellaneous", "one-off", "sonstige",
     "sonstiges", "autre", "autres"}
)  # fmt: skip
"""Types of boats that say that a boat is of none: those named so are not alike."""

CLASSES: Final[Mapping[str, str]] = {
    "h": "H", "heren": "H", "heer": "H", "mannen": "H", "man": "H", "men": "H", "herren": "H",
    "männer": "H", "male": "H", "hommes": "H", "homme": "H", "messieurs": "H",
    "herrer": "H", "herrar": "H", "menn": "H", "mænd": "H", "män": "H",
    "d": "D", "dames": "D", "dame": "D", "vrouwen": "D", "vrouw": "D", "women": "D", "ladies": "D",
    "damen": "D", "frauen": "D", "female": "D", "femmes": "D", "femme": "D",
    "damer": "D", "kvinner": "D", "kvinder": "D", "kvinnor": "D",
}  # fmt: skip

YES: Final = frozenset(
    {"ja", "wel", "j", "yes", "y", "x", "✓", "✔", "waar", "true", "wahr", "oui", "1"}
)
NO: Final = frozenset(
    {"nee", "niet", "n", "neen", "no", "nein", "onwaar", "false", "falsch", "non", "0"}
)
ALL_RUNS: Final = frozenset({"alle", "allemaal", "all", "alles", "tous", "toutes"})

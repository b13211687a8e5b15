"""Every text of the workbench in Dutch and English: those of `pipeline.words`, and its own.

An option or value without a text here is shown by its name in the method file.
"""

from typing import Final

from pipeline.words.catalogue import WORDS, Words

TEXTS: Final[Words] = {
    **WORDS,
    "workbench": ("Werkbank", "Workbench"),
    "intro": (
        "Verander een keuze in de rekenmethode en zie meteen wat er met alle sloepen gebeurt. "
        "Er wordt niets gepubliceerd of in de tabellen bewaard.",
        "Change a choice in the method and see at once what happens to all boats. Nothing is "
        "published or stored in the tables.",
    ),
    "base": ("Begin met methode", "Start from method"),
    "open_file": ("of open een methodebestand", "or open a method file"),
    "against": ("Vergelijk met", "Compare with"),
    "group_methods": ("Rekenmethoden", "Methods"),
    "group_editions": ("Uitgegeven edities", "Published editions"),
    "group_saved": ("Zelf bewaard", "Saved here"),
    "options": ("Keuzes", "Options"),
    "all_seasons": ("Alle seizoenen", "All seasons"),
    "per_season": ("Per seizoen", "Per season"),
    "and_later": ("en later", "and later"),
    "no_tows": ("geen proeven", "no tows"),
    "differs": ("verschilt", "differs"),
    "fixed": ("alleen in het methodebestand", "only in the method file"),
    "nothing": ("niets", "nothing"),
    "changed_options": ("Veranderd", "Changed"),
    "nothing_changed": (
        "Nog niets: dit is de methode zelf.",
        "Nothing yet: this is the method itself.",
    ),
    "reset": ("Alles terug", "Reset all"),
    "busy": ("Bezig met herrekenen ...", "Recomputing ..."),
    "done_in": ("Herrekend en getekend in", "Recomputed and drawn in"),
    "tows_in_all": ("proeven", "tows"),
    "refused": ("Dit kan niet:", "Not possible:"),
    "refusal.greater_than": ("moet groter zijn dan", "has to be greater than"),
    "refusal.greater_than_equal": ("moet minstens zijn", "has to be at least"),
    "refusal.less_than": ("moet kleiner zijn dan", "has to be less than"),
    "refusal.less_than_equal": ("mag hoogstens zijn", "has to be at most"),
    "refusal.int_from_float": ("moet een heel getal zijn", "has to be a whole number"),
    "refusal.int_parsing": ("moet een heel getal zijn", "has to be a whole number"),
    "share": ("Kopieer een link naar deze wijziging", "Copy a link to this change"),
    "shared": ("De link staat in het klembord.", "The link is on the clipboard."),
    "not_shared": (
        "De link staat in de adresbalk; kopieer hem daar.",
        "The link is in the address bar; copy it there.",
    ),
    "explained": ("Wat deze getallen zeggen", "What these figures say"),
    "means.count_changed": (
        "Regels waarvan Cw verandert, van alle regels.",
        "Lines whose Cw changes, of all lines.",
    ),
    "means.count_gains": (
        "Ploegen die voor hetzelfde vermogen langer over een wedstrijd mogen doen.",
        "Crews that may take longer over a race for the same power.",
    ),
    "means.count_loses": (
        "Ploegen die voor hetzelfde vermogen sneller moeten zijn.",
        "Crews that have to be faster for the same power.",
    ),
    "means.count_added": (
        "Regels die nu wel een geldige kromme krijgen.",
        "Lines that gain a valid curve.",
    ),
    "means.count_removed": (
        "Regels die hun geldige kromme verliezen.",
        "Lines that lose their valid curve.",
    ),
    "means.median_cw": (
        "De middelste verhouding van nieuwe tot oude Cw over alle regels.",
        "The middle ratio of new to old Cw over all lines.",
    ),
    "means.within_1": (
        "Hoe vaak de Cw van een niet verbouwde sloep die opnieuw werd gesleept, hoogstens 1 % "
        "anders is. Hoger is beter.",
        "How often an unaltered boat that was towed again has a Cw within 1 % of the earlier one. "
        "Higher is better.",
    ),
    "means.within_2": ("Hetzelfde voor 2 %.", "The same for 2 %."),
    "means.sd_tow": (
        "Hoeveel één proef toevallig afwijkt, als standaardafwijking van Cw. Lager is beter.",
        "How far one tow is off by chance, as a standard deviation of Cw. Lower is better.",
    ),
    "failed": (
        "De werkbank gaf een fout; in het venster waar hij gestart is, staat meer.",
        "The workbench failed; the terminal it was started in says more.",
    ),
    "gone": (
        "De werkbank antwoordt niet meer. Start hem opnieuw met herijk workbench.",
        "The workbench no longer answers. Start it again with herijk workbench.",
    ),
    "left_out": (
        "Niet bij elke wijziging herrekend: de band om een kromme over het hele bereik (het "
        "interval bij de opgegeven snelheid wel), de rechte lijnen en uitschieters per type en de "
        "oorzaken van spreiding. Die staan op de site na een herrekening.",
        "Not recomputed at every change: the band around a curve over its whole range (its "
        "interval at the declared speed is), the lines and outliers per type and the causes of "
        "spread. They are on the site after a rebuild.",
    ),
    # Results
    "count_changed": ("regels gewijzigd", "lines changed"),
    "count_gains": ("winnen tijd", "gain time"),
    "count_loses": ("verliezen tijd", "lose time"),
    "count_added": ("regels erbij", "lines added"),
    "count_removed": ("regels vervallen", "lines removed"),
    "median_cw": ("mediaan Cw na / voor", "median Cw after / before"),
    "within_1": ("herhalingen binnen 1 %", "repeats within 1 %"),
    "within_2": ("herhalingen binnen 2 %", "repeats within 2 %"),
    "sd_tow": ("sd van één proef", "sd of one tow"),
    "was": ("was", "was"),
    "in_register": ("Het register", "The register"),
    "in_register_note": (
        "Elke regel tegen de gekozen methode, de grootste wijziging boven. Tijd: wat de nieuwe "
        "regel in een wedstrijd van twee uur geeft (+) of kost (-) bij gelijk vermogen.",
        "Every line against the chosen method, the largest change first. Time: what the new line "
        "gives (+) or costs (-) in a two-hour race at equal power.",
    ),
    "scatter_changes": (
        "Cw en tijd van elke gewijzigde regel; klik een punt aan voor de sloep",
        "Cw and time of every changed line; click a point for its boat",
    ),
    "season_changes": (
        "Cw na / voor per seizoen: mediaan en uitersten",
        "Cw after / before per season: median and range",
    ),
    "factors_caption": (
        "Ware snelheid / logsnelheid per seizoen, met 95 %-interval",
        "True speed / log speed per season, with its 95 % interval",
    ),
    "in_types": ("Typen: zijn gelijke sloepen gelijk?", "Types: are equal boats equal?"),
    "season_first": ("of van seizoen", "or from season"),
    "season_last": ("tot en met", "up to and including"),
    "boats_inside": ("Sloepen daarin:", "Boats inside:"),
    "in_types_note": (
        "De gekozen proeven, Cw bij de standaardsnelheid van het type. Sleep over een grafiek, of "
        "vul eronder van en tot in (Esc wist ze), om te zien welke sloepen daar liggen; kies er "
        "een om die boven te zien. De tabel toetst of sloepen van een type één B kunnen delen, "
        "met van elke ploeg de nieuwste van die proeven: een kleine p zegt van niet.",
        "The chosen tows, Cw at the standard speed of the type. Drag over a chart, or fill in from "
        "and to below it (Esc clears them), to see which boats lie there; choose one to see it "
        "above. The table tests whether boats of a type can share one B, with the newest of those "
        "tows of each crew: a small p says no.",
    ),
    "in_repeats": (
        "Herhaalbaarheid: dezelfde sloep nog eens",
        "Reproducibility: the same boat again",
    ),
    "in_repeats_note": (
        "Twee opeenvolgende proeven van een niet verbouwde sloep met dezelfde ploeg.",
        "Two consecutive tows of an unaltered boat with the same crew.",
    ),
    "in_boat": ("Een sloep", "A boat"),
    "in_boat_note": (
        "De kromme en de runs voor en na. Open tekens tellen niet mee. De streep bij de "
        "opgegeven snelheid is het 95 %-interval; een streepjeslijn is alleen de spreiding van de "
        "runs, zonder de fout van de log.",
        "The curve and the runs before and after. Open marks do not count. The bar at the "
        "declared speed is the 95 % interval; a dashed bar is the spread of the runs alone, "
        "without the error of the log.",
    ),
    "choose_boat": ("Kies sloep", "Choose boat"),
    "figure_curve": ("Weerstandskrommen van deze proef", "Resistance curves of this tow"),
    "figure_repeats": ("Standaardafwijking van één proef", "Standard deviation of one tow"),
    # Saving
    "save": ("Bewaren als methodebestand", "Save as a method file"),
    "save_note": (
        "In het bestand staat alleen wat anders is dan de methode waarvan het uitgaat. Het "
        "komt in de map methods van de datamap; herijk rebase kan ermee rekenen.",
        "The file holds only what differs from the method it starts from. It goes into the folder "
        "methods of the data folder; herijk rebase can compute with it.",
    ),
    "name": (
        "Naam (kleine letters, cijfers, streepjes)",
        "Name (lower-case letters, digits, hyphens)",
    ),
    "title": ("Titel", "Title"),
    "reason": ("Waarom", "Reason"),
    "save_button": ("Bewaar in de datamap", "Save in the data folder"),
    "download_button": ("Download", "Download"),
    "saved_as": ("Bewaard. Alle gevolgen op een rij:", "Saved. To see all its effects:"),
    # Columns
    "column.old_cw_kg_m": ("Cw voor [kg/m]", "Cw before [kg/m]"),
    "column.new_cw_kg_m": ("Cw na [kg/m]", "Cw after [kg/m]"),
    "column.gain_in_two_hours_s": ("Tijd in 2 uur [s]", "Time in 2 h [s]"),
    "column.old_rank": ("Plaats voor", "Rank before"),
    "column.new_rank": ("Plaats na", "Rank after"),
    "column.exceeds_interval": ("Meer dan on\u00adzeker", "Beyond un\u00adcer\u00adtainty"),
    # Steps
    "step.speed": ("Snelheid", "Speed"),
    "step.calibration": ("IJking op gps", "Calibration on GPS"),
    "step.window": ("Venster (knippen)", "Window"),
    "step.wind": ("Wind", "Wind"),
    "step.run_point": ("Gemiddelde per run", "Run point"),
    "step.temperature": ("Watertemperatuur", "Water temperature"),
    "step.runs": ("Runs die tellen", "Runs that count"),
    "step.curve": ("Kromme", "Curve"),
    "step.assessment": ("Beoordeling", "Assessment"),
    # Options
    "speed.source": ("Welke log", "Which log"),
    "speed.correction": ("Fout van de log", "Error of the log"),
    "speed.correction_ratio": (
        "Voorgeschreven correctie (0,06 is 6 %)",
        "Prescribed correction (0.06 is 6 %)",
    ),
    "speed.operation": ("Hoe de correctie werkt", "How the correction works"),
    "calibration.rule": ("Gps-factor", "GPS factor"),
    "calibration.without_gps": ("Proef zonder gps", "Tow without GPS"),
    "window.rule": ("Welk deel van een run", "Which part of a run"),
    "window.minimum_s": ("Kortste venster", "Shortest window"),
    "window.speed_drift_m_s": (
        "Verschil van snelheid, begin en eind",
        "Difference in speed between the ends",
    ),
    "window.force_ends_ratio": (
        "Verschil van kracht, begin en eind",
        "Difference in force between the ends",
    ),
    "window.wind_ends_m_s": (
        "Verschil van wind, begin en eind",
        "Difference in wind between the ends",
    ),
    "window.ramp_m_s": ("Kleinste aanloop die eraf gaat", "Smallest ramp that is cut"),
    "window.peak_sd": ("Grens voor een krachtpiek", "Limit for a force peak"),
    "window.gust_sd": ("Grens voor een windvlaag", "Limit for a gust"),
    "wind.model": ("Windmodel", "Wind model"),
    "wind.coefficients": ("Omstroomcoëfficiënten", "Drag coefficients"),
    "wind.ahead": ("Coëfficiënt van voren", "Coefficient from ahead"),
    "wind.behind": ("Coëfficiënt van achteren", "Coefficient behind"),
    "wind.side": ("Coëfficiënt van opzij", "Coefficient from the side"),
    "wind.averaging_s": ("Wind gemiddeld over", "Wind averaged over"),
    "wind.anemometer": ("Windmeter", "Anemometer"),
    "wind.unmeasured": ("Wind die niet gemeten is", "Wind that was not measured"),
    "wind.reading": ("Hoe de wind gelezen is", "How the wind was read"),
    "run_point.estimator": ("Gemiddelde van een run", "Mean of a run"),
    "run_point.inertia": ("Versnelling van de sloep verrekenen", "Correct for acceleration"),
    "run_point.added_mass_ratio": ("Meegesleept water", "Added mass"),
    "temperature.rule": ("Watertemperatuur verrekenen", "Correct for water temperature"),
    "temperature.reference_c": ("Naar water van", "To water of"),
    "temperature.unrecorded": ("Temperatuur die niemand noteerde", "Temperature nobody recorded"),
    "runs.highest_target_ratio": (
        "Snelste run / opgegeven snelheid",
        "Fastest run / declared speed",
    ),
    "runs.minimum": ("Minimumaantal runs", "Minimum number of runs"),
    "curve.b": ("B van de kromme", "B of the curve"),
    "curve.cap_hull_speeds": ("B hoogstens, in rompsnelheden", "B at most, in hull speeds"),
    "assessment.reject": ("Keurt een proef af", "Rejects a tow"),
    # Values
    "choice.log1": ("log 1", "log 1"),
    "choice.log2": ("log 2", "log 2"),
    "choice.mean": ("beide", "both"),
    "choice.none": ("niet", "none"),
    "choice.prescribed": ("voorgeschreven", "prescribed"),
    "choice.estimated": ("geschat", "estimated"),
    "choice.no_curve": ("geen kromme", "no curve"),
    "choice.multiply": ("maal 1 + p", "times 1 + p"),
    "choice.divide": ("gedeeld door 1 - p", "divided by 1 - p"),
    "choice.gps_per_tow": ("per proef", "per tow"),
    "choice.gps_per_season": ("per seizoen", "per season"),
    "choice.all": ("alles", "all"),
    "choice.steady": ("het rustige deel", "the steady part"),
    "choice.by_hand": ("met de hand", "by hand"),
    "choice.head": ("tegenwind", "head wind"),
    "choice.oblique": ("schuine wind", "oblique wind"),
    "choice.fixed": ("vast", "fixed"),
    "choice.per_run": ("per run gezocht", "searched per run"),
    "choice.per_tow": ("per proef gezocht", "searched per tow"),
    "choice.archive": ("één uit alle proeven", "one from all tows"),
    "choice.still_air": ("stil weer", "still air"),
    "choice.expected": ("zoals bij andere proeven", "as in other tows"),
    "choice.unchanged": ("zoals gesleept", "as towed"),
    "choice.as_read": ("zoals afgelezen", "as it reads"),
    "choice.as_felt": ("zoals gevoeld", "as felt"),
    "choice.cw_vac_2014": ("'Cw vac' van 2014", "'Cw vac' of 2014"),
    "choice.cw_opt_2014": ("'Cw opt' van 2014", "'Cw opt' of 2014"),
    "choice.mean_of_ratios": ("gemiddelde van quotiënten", "mean of ratios"),
    "choice.ratio_of_means": ("quotiënt van gemiddelden", "ratio of means"),
    "choice.end_speeds": ("uit de eindsnelheden", "from the end speeds"),
    "choice.ittc57": ("ITTC-57", "ITTC-57"),
    "choice.free": ("vrij", "free"),
    "choice.capped": ("begrensd", "capped"),
    "choice.hull_speed": ("de rompsnelheid", "the hull speed"),
}

"""Every text that people read, in Dutch and English, in one table.

A code of the warehouse (a status, a flag, a step) has a line too; a code without one is shown as
it is. Names of boats, methods and editions are data and never translated.
"""

from collections.abc import Callable
from typing import Final

LANGUAGES: Final = ("nl", "en")

Say = Callable[[str], str]
"""Gives the text of a key in one language."""

WORDS: Final[dict[str, tuple[str, str]]] = {
    # Pages and frame
    "site": ("Sleepproeven herijkt", "Tow tests re-based"),
    "index": ("Begin", "Start"),
    "register": ("Register", "Register"),
    "types": ("Typen", "Types"),
    "corrections": ("Correcties", "Corrections"),
    "reproducibility": ("Herhaalbaarheid", "Reproducibility"),
    "changes": ("Wijzigingen", "Changes"),
    "quality": ("Kwaliteit", "Quality"),
    "boat": ("Sloep", "Boat"),
    "skip": ("Naar de inhoud", "Skip to content"),
    "pages": ("Pagina's", "Pages"),
    "language": ("Taal", "Language"),
    "simulated": (
        "GESIMULEERD: deze sloepen bestaan niet. De getallen komen uit een nagebootst archief.",
        "SIMULATED: these boats do not exist. The numbers come from a simulated archive.",
    ),
    "no_script": (
        "Zonder JavaScript staan de tabellen er wel, maar de grafieken niet.",
        "Without JavaScript the tables are here, but the charts are not.",
    ),
    "made_by": ("Gemaakt met code", "Made by code"),
    "csv": ("CSV", "CSV"),
    "download": ("Download als CSV", "Download as CSV"),
    "search": ("Zoek", "Search"),
    "rows": ("regels", "rows"),
    "all": ("alle", "all"),
    "choose": ("Toon", "Show"),
    "clear": ("Wis keuze", "Clear selection"),
    "yes": ("ja", "yes"),
    "no": ("nee", "no"),
    # Index
    "index_intro": (
        "De weerstand van roeisloepen wordt gemeten met een sleepproef. Deze bladen laten zien wat "
        "er van alle proeven wordt als ze met dezelfde rekenmethode worden herrekend: het "
        "register, elke sloep met haar metingen, en wat elke stap verandert.",
        "The resistance of rowing sloops is measured with a tow test. These pages show what "
        "becomes of all tests when they are recomputed with one method: the register, every boat "
        "with its measurements, and what each step changes.",
    ),
    "index_pages": ("Wat waar staat", "What is where"),
    "about_register": (
        "Elke sloep en ploeg met A, B en Cw; zoeken, sorteren, downloaden.",
        "Every boat and crew with A, B and Cw; search, sort, download.",
    ),
    "about_types": (
        "Zijn gelijke sloepen gelijk? B en Cw tegen gewicht en sleepsnelheid, voor en na.",
        "Are equal boats equal? B and Cw against weight and tow speed, before and after.",
    ),
    "about_corrections": (
        "Logfactoren per seizoen, en wat elke stap van een methode met Cw doet.",
        "Log factors per season, and what each step of a method does to Cw.",
    ),
    "about_reproducibility": (
        "Hoe goed komen twee proeven van dezelfde, niet verbouwde sloep overeen?",
        "How well do two tests of one unaltered boat agree?",
    ),
    "about_changes": (
        "Wat er tussen twee edities van het register verandert, en waardoor.",
        "What changes between two editions of the register, and why.",
    ),
    "about_quality": (
        "Proeven die terzijde zijn gelegd, waarschuwingen, en tellingen van de herrekening.",
        "Tows set aside, flags, and counts of the rebuild.",
    ),
    "summary": ("In het kort", "Summary"),
    "methods": ("Rekenmethoden", "Methods"),
    "methods_note": (
        "Elk getal hangt af van een methode, en noemt die. Twee gelijke vingerafdrukken zijn "
        "twee gelijke methoden.",
        "Every number depends on a method, and names it. Two equal hashes are two equal methods.",
    ),
    "tables": ("Tabellen in de database", "Tables in the database"),
    "tables_note": (
        "Alles op deze bladen staat in warehouse.duckdb.",
        "Everything on these pages stands in warehouse.duckdb.",
    ),
    # Register
    "register_note": (
        "A, B en Cw gelden van 85 tot 115 % van de opgegeven roeisnelheid. Een editie die "
        "concept heet, is niet gepubliceerd.",
        "A, B and Cw hold from 85 to 115 % of the declared speed. An edition called concept is "
        "a draft: not published.",
    ),
    # Boat
    "facts": ("Maten", "Dimensions"),
    "boat_lines": ("In het register", "In the register"),
    "boat_curve": ("Weerstandskromme", "Resistance curve"),
    "boat_curve_note": (
        "De lijn is Cw = A / (1 - (v/B)^2) over het geldige bereik, 85 tot 115 % van de opgegeven "
        "snelheid; de band is het 95 %-interval uit de spreiding van de runs. De streep bij de "
        "opgegeven snelheid is het interval van het register. Open tekens tellen niet mee.",
        "The line is Cw = A / (1 - (v/B)^2) over the valid range, 85 to 115 % of the declared "
        "speed; the band is the 95 % interval from the scatter of the runs. The bar at the "
        "declared speed is the register's interval. Open marks do not count.",
    ),
    "boat_history": ("Door de jaren", "Through the years"),
    "boat_history_note": (
        "Cw bij de opgegeven snelheid van elke proef, onder elke methode, met 95 %-interval.",
        "Cw at the declared speed of every tow, under every method, with its 95 % interval.",
    ),
    "boat_traces": ("Wat de instrumenten zeiden", "What the instruments said"),
    "boat_traces_note": (
        "Gemiddelden per seconde; snelheid: doorgetrokken log 1, gestreept GPS. Het grijze vlak is het venster dat telt; de rest is weggesneden "
        "om de reden die in de tabel staat.",
        "Means per second; speed: solid log 1, dashed GPS. The grey area is the window that counts; the rest is cut for the "
        "reason in the table.",
    ),
    "boat_runs": ("Runs", "Runs"),
    "boat_out_back": ("Heen tegen terug, en de wind", "Out against back, and the wind"),
    "boat_out_back_note": (
        "Cw voor en na de luchtcorrectie, heen (runs 1-3) en terug (runs 4-6). Na de correctie "
        "horen heen en terug samen te vallen.",
        "Cw before and after the air correction, out (runs 1-3) and back (runs 4-6). After the "
        "correction out and back should coincide.",
    ),
    "boat_lineage": ("Herkomst", "Lineage"),
    "boat_lineage_note": (
        "De bestanden, de methode en de code achter elke registerregel.",
        "The files, the method and the code behind every register line.",
    ),
    # Types
    "types_charts": ("B en Cw per type", "B and Cw per type"),
    "types_note": (
        "Links en rechts dezelfde sloepen onder twee methoden. Sleep over een grafiek om sloepen "
        "te kiezen: de lijst eronder toont ze. Klik op een punt om naar de sloep te gaan.",
        "Left and right the same boats under two methods. Drag over a chart to select boats: the "
        "list below shows them. Click a point to go to the boat.",
    ),
    "types_list": ("Sloepen", "Boats"),
    "before": ("Voor", "Before"),
    "after": ("Na", "After"),
    "type_first": ("Eerste type", "First type"),
    "type_second": ("Tweede type", "Second type"),
    "types_lines": ("Hangt het af van gewicht of snelheid?", "Does it follow weight or speed?"),
    "types_lines_note": (
        "Een rechte lijn per type. Een helling waarvan het interval 0 bevat, is niet aangetoond.",
        "A straight line per type. A slope whose interval holds 0 is not shown to exist.",
    ),
    "types_homogeneity": ("Kan één B voor het type?", "Could one B serve the type?"),
    "types_outliers": ("Sloepen die afwijken van hun type", "Boats that differ from their type"),
    # Corrections
    "log_factors": ("Logfactor per seizoen", "Log factor per season"),
    "log_factors_note": (
        "Ware snelheid = logsnelheid x factor. Bij een factor zonder streep is geen interval "
        "bekend.",
        "True speed = log speed x factor. A factor without a bar has no known interval.",
    ),
    "ladder": ("Wat elke stap doet", "What each step does"),
    "ladder_note": (
        "Factor op Cw van elke stap, meetkundig gemiddeld over de proeven van een seizoen. De "
        "factoren van een seizoen vermenigvuldigen tot het totaal.",
        "Factor on Cw of each step, geometric mean over a season's tows. The factors of a season "
        "multiply to the total.",
    ),
    "season_change": ("Zoals gepubliceerd tegen herrekend", "As published against re-based"),
    "season_change_note": (
        "Cw onder de methode / Cw zoals gepubliceerd, van dezelfde proef: mediaan, en laagste tot "
        "hoogste.",
        "Cw under the method / Cw as published, of the same tow: median, and lowest to highest.",
    ),
    "options": ("Keuzen van oordeel", "Choices of judgement"),
    "options_note": (
        "Wat Cw verandert als één keuze anders was gemaakt: mediaan en de middelste 90 % van de "
        "proeven.",
        "What happens to Cw had one choice been made otherwise: median and the middle 90 % of "
        "tows.",
    ),
    # Reproducibility
    "repro": ("Spreiding van één proef", "Spread of one tow"),
    "repro_note": (
        "Standaardafwijking van een proef uit herhalingen van niet verbouwde sloepen, met "
        "95 %-interval. Lager is beter.",
        "Standard deviation of one tow from repeats of unaltered boats, with 95 % interval. "
        "Lower is better.",
    ),
    "repeats": ("Elk paar", "Every pair"),
    "repeats_note": (
        "ln(nieuwe Cw / oude Cw). Klik op een punt om naar de sloep te gaan.",
        "ln(new Cw / old Cw). Click a point to go to the boat.",
    ),
    "components": ("Waar de spreiding vandaan komt", "Where the spread comes from"),
    "predicted": ("Voorspeld zonder slepen", "Predicted without towing"),
    "predicted_note": (
        "Cw uit lengte, gewicht, breedte en type tegen Cw uit de proef. Op de lijn zijn ze gelijk.",
        "Cw from length, weight, beam and type against Cw from the tow. On the line they agree.",
    ),
    # Changes
    "changes_list": ("Gewijzigde regels", "Changed lines"),
    "changes_note": (
        "Verhouding nieuw / oud. Een tijd van 0,99 is 1 % sneller bij gelijk vermogen.",
        "Ratio new / old. A time of 0.99 is 1 % faster at equal power.",
    ),
    # Quality
    "statuses": ("Stand van de krommen", "Status of the curves"),
    "flags": ("Waarschuwingen", "Flags"),
    "flags_note": (
        "Een waarschuwing zegt waar iemand naar moet kijken; zij verandert geen getal.",
        "A flag says what a person should look at; it never changes a number.",
    ),
    "run_reasons": ("Runs die niet tellen", "Runs that do not count"),
    "set_aside": ("Terzijde gelegd", "Set aside"),
    "set_aside_note": (
        "Bestanden en proeven die niet gebruikt zijn, met de reden.",
        "Files and tows not used, with the reason.",
    ),
    "nothing_set_aside": ("Niets is terzijde gelegd.", "Nothing was set aside."),
    "no_changes": ("Er zijn geen gewijzigde regels.", "There are no changed lines."),
    "editions": ("Uitgegeven edities", "Published editions"),
    "races": ("Wedstrijden opnieuw gerekend", "Races computed again"),
    "season_links": ("Herhalingen tussen seizoenen", "Repeats between seasons"),
    "assessments": ("Controles", "Checks"),
    "uncertainty_budget": ("Waaruit de onzekerheid bestaat", "What the uncertainty is made of"),
    "hand_windows": ("Vensters met de hand", "Windows by hand"),
    # Figures
    "speed": ("Snelheid door het water [m/s]", "Speed through water [m/s]"),
    "speed_short": ("Snelheid [m/s]", "Speed [m/s]"),
    "force": ("Sleepkracht [N]", "Tow force [N]"),
    "wind": ("Schijnbare wind [m/s]", "Apparent wind [m/s]"),
    "wind_angle": ("Hoek van de wind [graden]", "Wind angle [deg]"),
    "time": ("Tijd in de run [s]", "Time in the run [s]"),
    "run": ("Run", "Run"),
    "cw": ("Cw [kg/m]", "Cw [kg/m]"),
    "cw_declared": ("Cw bij opgegeven snelheid [kg/m]", "Cw at the declared speed [kg/m]"),
    "a": ("A [kg/m]", "A [kg/m]"),
    "b": ("B [m/s]", "B [m/s]"),
    "weight": ("Gewicht [kg]", "Weight [kg]"),
    "tow_speed": ("Opgegeven snelheid [m/s]", "Declared speed [m/s]"),
    "season": ("Seizoen", "Season"),
    "date": ("Datum", "Date"),
    "method": ("Methode", "Method"),
    "tow": ("Proef", "Tow"),
    "edition": ("Editie", "Edition"),
    "type": ("Type", "Type"),
    "name": ("Naam", "Name"),
    "direction": ("Richting", "Direction"),
    "out": ("heen", "out"),
    "back": ("terug", "back"),
    "factor": ("Factor", "Factor"),
    "source": ("Bron", "Source"),
    "step": ("Stap", "Step"),
    "status": ("Stand", "Status"),
    "number": ("Aantal", "Number"),
    "option": ("Keuze", "Choice"),
    "ratio_cw": ("Cw na / Cw voor", "Cw after / Cw before"),
    "ln_ratio": ("ln(nieuw / oud)", "ln(new / old)"),
    "sd_ratio": ("Standaardafwijking / Cw", "Standard deviation / Cw"),
    "component": ("Oorzaak", "Cause"),
    "scope": ("Tijdvak", "Era"),
    "gross": ("zonder luchtcorrectie", "without air correction"),
    "net": ("in stille lucht", "in still air"),
    "predicted_cw": ("Voorspelde Cw [kg/m]", "Predicted Cw [kg/m]"),
    "tow_cw": ("Cw van de proef [kg/m]", "Cw of the tow [kg/m]"),
    "time_ratio": ("Tijd nieuw / oud", "Time new / old"),
    "window": ("Venster [s]", "Window [s]"),
    # Columns
    "column.edition": ("Editie", "Edition"),
    "column.method": ("Methode", "Method"),
    "column.fsn_no": ("FSN-nr", "FSN no"),
    "column.ht_no": ("HT-nr", "HT no"),
    "column.name": ("Naam", "Name"),
    "column.boat_type": ("Type", "Type"),
    "column.rowers": ("Roeiers", "Rowers"),
    "column.crew_class": ("Klasse", "Class"),
    "column.tow_id": ("Proef", "Tow"),
    "column.tow_date": ("Datum", "Date"),
    "column.valid_until": ("Geldig tot", "Valid until"),
    "column.status": ("Stand", "Status"),
    "column.season": ("Seizoen", "Season"),
    "column.declared_speed_m_s": ("v0 [m/s]", "v0 [m/s]"),
    "column.a_kg_m": ("A [kg/m]", "A [kg/m]"),
    "column.b_m_s": ("B [m/s]", "B [m/s]"),
    "column.b_lo_m_s": ("B laag [m/s]", "B low [m/s]"),
    "column.b_hi_m_s": ("B hoog [m/s]", "B high [m/s]"),
    "column.cw_kg_m": ("Cw [kg/m]", "Cw [kg/m]"),
    "column.cw_lo_kg_m": ("Cw laag [kg/m]", "Cw low [kg/m]"),
    "column.cw_hi_kg_m": ("Cw hoog [kg/m]", "Cw high [kg/m]"),
    "column.gross_cw_kg_m": ("Cw bruto [kg/m]", "Cw gross [kg/m]"),
    "column.air_cw_kg_m": ("lucht eraf [kg/m]", "air off [kg/m]"),
    "column.still_air_cw_kg_m": ("stille lucht erbij [kg/m]", "still air on [kg/m]"),
    "column.cw_sd": ("sd [kg/m]", "sd [kg/m]"),
    "column.power_w": ("Vermogen [W/roeier]", "Power [W/rower]"),
    "column.runs_used": ("Runs", "Runs"),
    "column.flags": ("Waarschuwingen", "Flags"),
    "column.waterline_length_m": ("Waterlijn [m]", "Waterline [m]"),
    "column.beam_m": ("Breedte [m]", "Beam [m]"),
    "column.bow_height_m": ("Boeghoogte [m]", "Bow height [m]"),
    "column.weight_kg": ("Gewicht [kg]", "Weight [kg]"),
    "column.altered": ("Verbouwd", "Altered"),
    "column.remark": ("Opmerking", "Remark"),
    "column.run": ("Run", "Run"),
    "column.direction": ("Richting", "Direction"),
    "column.speed_m_s": ("v [m/s]", "v [m/s]"),
    "column.window_start_s": ("Venster van [s]", "Window from [s]"),
    "column.window_end_s": ("tot [s]", "to [s]"),
    "column.cut_reason": ("Waarom gesneden", "Why cut"),
    "column.wind_m_s": ("Wind [m/s]", "Wind [m/s]"),
    "column.wind_angle_deg": ("Windhoek [graden]", "Wind angle [deg]"),
    "column.used": ("Telt", "Counts"),
    "column.reason": ("Waarom niet", "Why not"),
    "column.crew": ("Ploeg", "Crew"),
    "column.path": ("Bestand", "File"),
    "column.sha256": ("SHA-256", "SHA-256"),
    "column.method_hash": ("Vingerafdruk methode", "Method hash"),
    "column.content_hash": ("Vingerafdruk", "Hash"),
    "column.code_version": ("Code", "Code"),
    "column.title": ("Titel", "Title"),
    "column.table": ("Tabel", "Table"),
    "column.rows": ("Regels", "Rows"),
    "column.factor": ("Factor", "Factor"),
    "column.lo": ("laag", "low"),
    "column.hi": ("hoog", "high"),
    "column.source": ("Bron", "Source"),
    "column.number": ("Aantal", "Number"),
    "column.flag": ("Waarschuwing", "Flag"),
    "column.tows": ("Proeven", "Tows"),
    "column.step": ("Stap", "Step"),
    "column.option": ("Keuze", "Choice"),
    "column.median_ratio": ("Mediaan", "Median"),
    "column.lo_ratio": ("5 %", "5 %"),
    "column.hi_ratio": ("95 %", "95 %"),
    "column.lowest_ratio": ("Laagste", "Lowest"),
    "column.highest_ratio": ("Hoogste", "Highest"),
    "column.from_method": ("Van", "From"),
    "column.to_method": ("Naar", "To"),
    "column.from_edition": ("Van", "From"),
    "column.to_edition": ("Naar", "To"),
    "column.change": ("Wijziging", "Change"),
    "column.cw_ratio": ("Cw nieuw / oud", "Cw new / old"),
    "column.power_ratio": ("Vermogen nieuw / oud", "Power new / old"),
    "column.time_ratio": ("Tijd nieuw / oud", "Time new / old"),
    "column.causes": ("Oorzaken", "Causes"),
    "column.reason_code": ("Code", "Code"),
    "column.message": ("Reden", "Reason"),
    "column.line": ("Regel", "Line"),
    "column.first_seen": ("Voor het eerst", "First seen"),
    "column.quantity": ("Grootheid", "Quantity"),
    "column.explaining": ("Tegen", "Against"),
    "column.n": ("n", "n"),
    "column.n_boats": ("Sloepen", "Boats"),
    "column.n_pairs": ("Paren", "Pairs"),
    "column.slope": ("Helling", "Slope"),
    "column.slope_lo": ("laag", "low"),
    "column.slope_hi": ("hoog", "high"),
    "column.r2": ("R2", "R2"),
    "column.residual_sd_ratio": ("Restspreiding", "Residual spread"),
    "column.p_value": ("p", "p"),
    "column.shared_b_m_s": ("Gedeelde B [m/s]", "Shared B [m/s]"),
    "column.power_at_10pct": ("Kans 10 % te zien", "Power at 10 %"),
    "column.noise_share": ("Deel ruis", "Share of noise"),
    "column.value": ("Waarde", "Value"),
    "column.expected": ("Verwacht", "Expected"),
    "column.deviation_sd": ("Afwijking [sd]", "Deviation [sd]"),
    "column.candidates": ("Mogelijke verklaring", "Possible cause"),
    "column.scope": ("Tijdvak", "Era"),
    "column.sd_ratio": ("sd / Cw", "sd / Cw"),
    "column.share_within_1pct": ("Deel binnen 1 %", "Share within 1 %"),
    "column.share_within_2pct": ("Deel binnen 2 %", "Share within 2 %"),
    "column.component": ("Oorzaak", "Cause"),
    "column.share": ("Deel", "Share"),
    "column.season_before": ("Vorig seizoen", "Season before"),
    "column.ln_ratio": ("ln(nieuw / oud)", "ln(new / old)"),
    "column.e_n": ("E_n", "E_n"),
    "column.predicted_cw_kg_m": ("Voorspeld [kg/m]", "Predicted [kg/m]"),
    "column.disagrees": ("Verschilt", "Disagrees"),
    "column.check": ("Controle", "Check"),
    "column.severity": ("Ernst", "Severity"),
    "column.observed": ("Gezien", "Observed"),
    "column.limit": ("Grens", "Limit"),
    "column.unit": ("Eenheid", "Unit"),
    "column.flagged": ("Over de grens", "Beyond"),
    # Codes
    "code.accepted": ("goed", "accepted"),
    "code.flagged": ("nakijken", "flagged"),
    "code.rejected": ("afgekeurd", "rejected"),
    "code.valid": ("geldig", "valid"),
    "code.expired": ("verlopen", "expired"),
    "code.added": ("nieuw", "added"),
    "code.removed": ("vervallen", "removed"),
    "code.changed": ("gewijzigd", "changed"),
    "code.same": ("gelijk", "same"),
    "code.none": ("geen", "none"),
    "code.prescribed": ("voorgeschreven", "prescribed"),
    "code.estimated": ("geschat", "estimated"),
    "code.speed": ("snelheid", "speed"),
    "code.window": ("venster", "window"),
    "code.runs": ("runs", "runs"),
    "code.calibration": ("ijking", "calibration"),
    "code.run_point": ("runpunt", "run point"),
    "code.wind": ("wind", "wind"),
    "code.temperature": ("temperatuur", "temperature"),
    "code.curve": ("kromme", "curve"),
    "code.boat": ("sloep", "boat"),
    "code.season": ("seizoen", "season"),
    "code.boat_season": ("sloep in seizoen", "boat in season"),
    "code.run": ("run", "run"),
    "code.fleet": ("alle sloepen", "all boats"),
    "code.within_type": ("binnen een type", "within a type"),
    "code.weight": ("gewicht", "weight"),
    "code.length": ("lengte", "length"),
    "code.all": ("alle", "all"),
    "code.speed_drift": ("snelheid loopt", "speed drifts"),
    "code.ends_differ": ("begin en eind verschillen", "ends differ"),
    "code.force_peak": ("krachtpiek", "force peak"),
    "code.gust": ("windvlaag", "gust"),
    "code.by_hand": ("met de hand", "by hand"),
    "code.no_steady_window": ("geen rustig venster", "no steady window"),
    "code.above_target_speed": ("te snel gesleept", "above target speed"),
    "code.not_selected": ("niet gekozen in de lijst", "not selected in the list"),
    "code.not_calibrated": ("niet te ijken", "not calibrated"),
    "code.large_scatter_in_run": ("grote spreiding in een run", "large scatter in a run"),
    "code.few_runs": ("weinig runs", "few runs"),
    "code.off_target_speed": ("andere snelheid dan bedoeld", "off target speed"),
    "code.out_and_back_differ": ("heen en terug verschillen", "out and back differ"),
    "code.ln_cw_standard": ("Cw bij standaardsnelheid", "Cw at standard speed"),
    "code.cw_standard_kg_m": ("Cw bij standaardsnelheid", "Cw at standard speed"),
    "code.q": ("bocht q", "bend q"),
    "code.a_kg_m": ("A", "A"),
    "code.b_m_s": ("B", "B"),
    "code.cw_kg_m": ("Cw", "Cw"),
    "code.weight_kg": ("gewicht", "weight"),
    "code.displacement_kg": ("waterverplaatsing", "displacement"),
    "code.declared_speed_m_s": ("opgegeven snelheid", "declared speed"),
    "code.ln_displacement": ("ln waterverplaatsing", "ln displacement"),
    "code.few_boats": ("te weinig sloepen", "few boats"),
    "code.equal_values": ("gelijke waarden", "equal values"),
    "code.no_type": ("geen type", "no type"),
    "code.method": ("methode", "method"),
    "code.input": ("invoer", "input"),
    "code.code": ("code", "code"),
    "code.flag": ("nakijken", "flag"),
    "code.note": ("opmerking", "note"),
    "code.unknown": ("onbekend", "unknown"),
}


def both(key: str) -> tuple[str, str]:
    """A text in Dutch and English; a code or column without one stands for itself."""
    known = WORDS.get(key)
    if known is None and "." not in key:
        raise KeyError(key)
    bare = key.split(".", 1)[-1]
    return known or (bare, bare)


def speaker(language: str) -> Say:
    """The texts of one language."""
    place = LANGUAGES.index(language)
    return lambda key: both(key)[place]

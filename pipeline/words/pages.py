"""Titles, captions and notes of pages."""

from typing import Final

PAGES: Final[dict[str, tuple[str, str]]] = {
    # Pages and frame
    "site": ("Sleepproeven herijkt", "Tow tests re-based"),
    "index": ("Begin", "Start"),
    "register": ("Register", "Register"),
    "due": ("Weer slepen", "Due to tow"),
    "types": ("Typen", "Types"),
    "corrections": ("Correcties", "Corrections"),
    "reproducibility": ("Herhaalbaarheid", "Reproducibility"),
    "changes": ("Wijzigingen", "Changes"),
    "quality": ("Kwaliteit", "Quality"),
    "compare": ("Vergelijk", "Compare"),
    "races": ("Wedstrijden", "Races"),
    "words": ("Begrippen", "Glossary"),
    "guide_method": ("De rekenmethode", "The method"),
    "about_guide_method": (
        "Elke formule, van meting tot registerregel, met de bron.",
        "Every formula, from samples to a register line, with its source.",
    ),
    "guide_audit": ("Een controle lezen", "Reading an audit"),
    "about_guide_audit": (
        "Hoe een controle van een sloep of type gelezen wordt.",
        "How to read the audit of a boat or a type.",
    ),
    "guide_in_short": ("In het kort", "In short"),
    "guide_whole": ("De hele tekst", "The whole text"),
    "guide_note": (
        "Het document van het project, zoals het bij het programma hoort.",
        "The document of the project, as it is shipped with the program.",
    ),
    "edition_title": ("Editie", "Edition"),
    "notice": ("Bericht aan de leden", "Notice to the members"),
    "release_notes": ("Toelichting", "Release notes"),
    "boat": ("Sloep", "Boat"),
    "find": ("Zoek sloep, type of wedstrijd", "Find a boat, type or race"),
    "found": ("Gevonden", "Found"),
    "other_language": ("English", "Nederlands"),
    "cite": ("Bronvermelding", "Cite"),
    "how_made": ("Hoe deze getallen tot stand kwamen", "How these numbers were made"),
    "curve_caption": (
        "Cw tegen snelheid, uit A en B; de balk is de marge bij de opgegeven snelheid",
        "Cw against speed, from A and B; the bar is the interval at the declared speed",
    ),
    "skip": ("Naar de inhoud", "Skip to content"),
    "pages": ("Pagina's", "Pages"),
    "language": ("Taal", "Language"),
    "simulated": (
        "GESIMULEERD: deze sloepen bestaan niet. De getallen komen uit een nagebootst archief.",
        "SIMULATED: these boats do not exist. The numbers come from a simulated archive.",
    ),
    "simulated_short": ("GESIMULEERD", "SIMULATED"),
    "no_script": (
        "Zonder JavaScript staan de tabellen van de eerste keuze er, maar geen grafieken.",
        "Without JavaScript the tables of the first choice are here, but no charts.",
    ),
    "made_by": ("Gemaakt met code", "Made by code"),
    "download": ("Download als CSV", "Download as CSV"),
    "as_table": ("Als tabel", "As a table"),
    "search": ("Zoek", "Search"),
    "rows": ("Regels:", "Rows:"),
    "all": ("alle", "all"),
    "no_values": ("geen waarden", "no values"),
    "clear": ("Wis keuze", "Clear selection"),
    "from": ("van", "from"),
    "to": ("tot", "to"),
    "yes": ("ja", "yes"),
    "no": ("nee", "no"),
    # Index
    "index_intro": (
        "De weerstand van roeisloepen wordt gemeten met een sleepproef. Op deze pagina's ziet u "
        "wat alle proeven opleveren als ze met één methode worden herrekend: het register, elke "
        "sloep met de bijbehorende metingen, en wat elke stap verandert.",
        "The resistance of rowing sloops is measured with a tow test. These pages show the results "
        "of all tests, recomputed with one method: the register, every boat with its "
        "measurements, and what each step changes.",
    ),
    "index_pages": ("Waar u wat vindt", "Where to find what"),
    "about_register": (
        "Elke sloep en ploeg met A, B en Cw; zoeken, sorteren, downloaden.",
        "Every boat and crew with A, B and Cw; search, sort, download.",
    ),
    "about_due": (
        "Wie moet weer slepen, voor wanneer, en met welke snelheid?",
        "Who has to tow again, by when, and at what speed?",
    ),
    "about_types": (
        "Zijn gelijke sloepen gelijk? A, B en Cw tegen gewicht en sleepsnelheid, voor en na.",
        "Are equal boats equal? A, B and Cw against weight and tow speed, before and after.",
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
    "methods": ("Rekenmethoden", "Methods"),
    "methods_note": (
        "Elk getal hangt af van een methode, en noemt die. Twee gelijke vingerafdrukken zijn "
        "twee gelijke methoden.",
        "Every number depends on a method, and names it. Two equal hashes are two equal methods.",
    ),
    "tables": ("Tabellen in de database", "Tables in the database"),
    "about_compare": (
        "Twee sloepen vergeleken: welke loopt lichter, en bij welke snelheid?",
        "Two boats compared: which runs easier, and at what speed?",
    ),
    "about_races": (
        "Elke wedstrijd opnieuw berekend: wint een ander, en hoe waarschijnlijk is dat?",
        "Every race computed again: is there another winner, and how likely is that?",
    ),
    "about_words": ("Wat de woorden en tekens betekenen.", "What the words and signs mean."),
    "now": ("De stand van zaken", "The current state"),
    "years": ("Door de seizoenen", "Through the seasons"),
    "edition_in_force": ("Geldende editie", "Current edition"),
    "no_edition": ("nog geen: dit is een concept", "none yet: this is a draft"),
    "edition_from": ("{edition}, vanaf {day}", "{edition}, from {day}"),
    "boats_number": ("Sloepen", "Boats"),
    "tows_number": ("Sleepproeven", "Tows"),
    "compare_boats": ("Twee sloepen vergeleken", "Two boats compared"),
    "compare_note": (
        "De krommen volgens de beste methode, elk met de 95 %-band. Waar de banden elkaar raken, "
        "is niet te zeggen welke sloep lichter loopt.",
        "The curves under the best method, each with its 95 % band. Where bands touch, the data "
        "do not say which boat runs easier.",
    ),
    "types_pages": ("Een type", "One type"),
    "types_pages_note": (
        "Elk type heeft een pagina: zijn de sloepen gelijk, en hoe liggen ze?",
        "Every type has a page: are the boats equal, and how do they compare?",
    ),
    "type_verdict": ("Zijn deze sloepen gelijk?", "Are these boats equal?"),
    "type_note": (
        "Het oordeel gaat over de nieuwste proef van elke sloep en ploeg, grafieken en tabellen "
        "over de proeven die u kiest. Standaardsnelheid: de middelste opgegeven snelheid van het "
        "type, waarbij Cw te vergelijken is; de opgegeven snelheid verschilt per ploeg. De lijn is "
        "de best passende rechte met het 95 %-interval. Een doorgetrokken streep door een punt is "
        "het 95 %-interval; een gestreepte is alleen de spreiding van de runs: de fout van de log "
        "zit er niet in.",
        "The verdict is about the newest tow of each boat and crew, charts and tables about the "
        "tows that you choose. Standard speed: the median declared speed of the type, at which Cw "
        "can be compared; the declared speed differs by crew. The line is the best straight fit "
        "with its 95 % interval. A full bar through a point is its 95 % interval; a dashed one is "
        "the spread of the runs alone: the log's error is not in it.",
    ),
    "flagged_boats": ("Om welke proeven het gaat", "Which tows they are about"),
    "boat_runs_note": (
        "Hoe elke run op zijn Cw komt, van links naar rechts: bruto F/v², min versnelling, min "
        "wind, plus stille lucht, plus temperatuur.",
        "How each run comes to its Cw, from left to right: gross F/v², less acceleration, less "
        "wind, plus still air, plus temperature.",
    ),
    # Headlines
    "head_register": (
        "{known} van {lines} regels hebben een geldige kromme op {day}.",
        "{known} of {lines} lines have a valid curve on {day}.",
    ),
    "head_from_to": ("Van “{old}” naar “{new}”: ", "From “{old}” to “{new}”: "),
    "head_changes": (
        "{changed} van {lines} regels veranderen",
        "{changed} of {lines} lines change",
    ),
    "head_beyond": (
        "; {beyond} met meer dan de onzekerheid",
        "; {beyond} by more than the uncertainty",
    ),
    "head_beyond_some": (
        ", en van {unknown} is dat niet te zeggen",
        ", and of {unknown} that is not known",
    ),
    "head_beyond_unknown": (
        "; of dat meer is dan de onzekerheid, is van geen enkele te zeggen",
        "; whether by more than the uncertainty is not known of any",
    ),
    "head_printed": (
        "; waardoor is niet bekend, want hoe het gedrukte register is gerekend, staat nergens",
        "; why is not known, as how the printed register was computed is not recorded",
    ),
    "head_old_spread": (
        " In de onzekerheid van {editions} zit de fout van de log niet: in werkelijkheid is die "
        "groter.",
        " The uncertainty of {editions} leaves out the error of the log: it is really larger.",
    ),
    "and": (" en ", " and "),
    "head_mostly": ("; meestal vooral door: {cause}", "; most often mainly: {cause}"),
    "head_due": (
        "Ploegen die binnen een jaar na {day} moeten slepen: {soon}; proeven die op die dag al "
        "verlopen zijn: {over}.",
        "Crews that have to tow within a year of {day}: {soon}; tows that have expired by that "
        "day: {over}.",
    ),
    "head_retow": (
        "Deze proeven brengen de onzekerheid van de logfactoren van {before} naar {after} %.",
        "These tows bring the uncertainty of the log factors from {before} to {after} %.",
    ),
    "head_retow_not": (
        "Daarvoor alleen loont het niet: deze proeven brengen de onzekerheid van de logfactoren "
        "van {before} naar {after} %.",
        "For that alone it is not worth it: these tows bring the uncertainty of the log factors "
        "from {before} to {after} %.",
    ),
    "head_statuses": (
        "Van {curves} krommen zijn er {accepted} goed, {flagged} om na te kijken en {rejected} "
        "afgekeurd.",
        "Of {curves} curves {accepted} are sound, {flagged} need a look and {rejected} are "
        "rejected.",
    ),
    "head_reproducibility": (
        "De toevallige fout van één proef is {now} % ({method}; 95 %: {low} tot {high} %, uit "
        "{pairs} paren); die was {then} % ({first}).",
        "The random error of one tow is {now} % ({method}; 95 %: {low} to {high} %, from {pairs} "
        "pairs); it was {then} % ({first}).",
    ),
    "head_log": (
        "De log zat er het verst naast in {season}: {by}.",
        "The log was furthest off in {season}: {by}.",
    ),
    "head_log_interval": (
        "De log zat er het verst naast in {season}: {by} (95 %: {low} tot {high}).",
        "The log was furthest off in {season}: {by} (95 %: {low} to {high}).",
    ),
    "head_type_equal": (
        "Geen teken dat de krommen van deze {n} proeven in bocht verschillen (p = {p}).",
        "No sign that the bends of the curves of these {n} tows differ (p = {p}).",
    ),
    "head_type_differ": (
        "De krommen van deze {n} proeven verschillen in bocht, meer dan ruis verklaart (p = {p}).",
        "The bends of the curves of these {n} tows differ by more than noise explains (p = {p}).",
    ),
    "head_type_unknown": (
        "Of de krommen van deze {n} proeven in bocht verschillen, is niet te zeggen: de toets is "
        "te zwak.",
        "Whether the bends of the curves of these {n} tows differ cannot be told: the test is too "
        "weak.",
    ),
    "head_type_few": (
        "Te weinig sloepen om te zeggen of ze gelijk zijn.",
        "Too few boats to tell whether they are equal.",
    ),
    "head_winner_same": (
        "Bij de {people} wint {new}, net als eerst.",
        "Among the {people} {new} wins, as before.",
    ),
    "head_winner_other": (
        "Bij de {people} wint {new} in plaats van {old}.",
        "Among the {people} {new} wins instead of {old}.",
    ),
    "fatigue_stretched": (
        " Waar een ander wint, berust dat mede op de uitputtingscorrectie, die voor 2 tot 3 uur "
        "roeien is gemaakt en hier ook daarbuiten is gebruikt ({low} tot {high}).",
        " Where another wins, that rests in part on the correction for fatigue, which was made for "
        "2 to 3 hours and is used outside them here ({low} to {high}).",
    ),
    "head_no_places": (
        "Bij de {people} heeft geen van de {all} ploegen op die dag in beide edities een geldige "
        "regel: er zijn geen plaatsen te vergelijken. ",
        "Among the {people} none of {all} crews has a valid line on that day in both editions: "
        "there are no places to compare. ",
    ),
    "head_few_places": (
        "Bij de {people} hebben maar {number} van de {all} ploegen op die dag in beide edities een "
        "geldige regel; de plaatsen zijn onder hen. ",
        "Among the {people} only {number} of {all} crews have a valid line on that day in both "
        "editions; the places are among these. ",
    ),
    "head_chance": (
        " Kans dat een ander wint dan eerst: {chance}.",
        " Chance that another wins than before: {chance}.",
    ),
    # Words
    "words_list": ("Wat de woorden betekenen", "What the words mean"),
    "words_note": (
        "Nederlandse getallen hebben een komma. Een interval van 95 % bevat de ware waarde "
        "in 19 van de 20 gevallen, als alle oorzaken erin zitten; waar dat niet zo is, staat het "
        "erbij.",
        "A 95 % interval contains the true value in 19 of 20 cases if it includes all causes; "
        "where it does not, the page says so.",
    ),
    "term_tow": ("Sleepproef", "Tow"),
    "meaning_tow": (
        "Het meten van de weerstand door de sloep te slepen: zes runs, drie heen en drie terug.",
        "Measuring resistance by towing the boat: six runs, three out and three back.",
    ),
    "term_cw": ("Cw", "Cw"),
    "meaning_cw": (
        "Weerstandscoëfficiënt in kg/m: sleepkracht gedeeld door snelheid in het kwadraat. Hoe "
        "lager, hoe lichter de sloep loopt. Dit is niet de dimensieloze golfweerstand die "
        "scheepsbouwers Cw noemen.",
        "Resistance coefficient in kg/m: tow force divided by speed squared. The lower, the "
        "easier the boat runs. It is not the dimensionless wave-making coefficient that naval "
        "architects call Cw.",
    ),
    "term_a": ("A", "A"),
    "meaning_a": ("Cw bij zeer lage snelheid, in kg/m.", "Cw at very low speed, in kg/m."),
    "term_b": ("B", "B"),
    "meaning_b": (
        "De snelheid in m/s waarbij de weerstand volgens de kromme oneindig wordt: hoe lager, hoe "
        "sneller Cw met de snelheid oploopt. Cw = A / (1 - (v/B)²).",
        "The speed in m/s at which the curve's resistance becomes infinite: the lower, the faster "
        "Cw rises with speed. Cw = A / (1 - (v/B)²).",
    ),
    "term_declared": ("Opgegeven snelheid", "Declared speed"),
    "meaning_declared": (
        "De snelheid die de ploeg zegt te roeien; de kromme geldt van 85 tot 115 % ervan.",
        "The speed that the crew says it rows; the curve holds from 85 to 115 % of it.",
    ),
    "term_interval": ("95 %-interval", "95 % interval"),
    "meaning_interval": (
        "Waar de waarde met 95 % zekerheid ligt, gegeven alles wat in de onzekerheid zit.",
        "Where the value lies with 95 % confidence, given all that the uncertainty is made of.",
    ),
    "term_as_measured": ("Zoals gemeten en beste schatting", "As measured and best estimate"),
    "meaning_as_measured": (
        "Zoals gemeten: uit de proef zelf. Beste schatting: uit alle proeven van het archief.",
        "As measured: from the tow itself. Best estimate: from all tows of the archive.",
    ),
    "term_log_factor": ("Logfactor", "Log factor"),
    "meaning_log_factor": (
        "Ware snelheid gedeeld door de snelheid volgens de log, in een seizoen.",
        "True speed divided by the speed of the log, in a season.",
    ),
    "term_method": ("Methode", "Method"),
    "meaning_method": (
        "De afgesproken rekenwijze, van meting tot A en B. Elk getal noemt de zijne.",
        "The agreed way of computing, from measurement to A and B. Every number names its own.",
    ),
    "term_edition": ("Editie en concept", "Edition and draft"),
    "meaning_edition": (
        "Een register zoals vastgesteld, dat niet meer verandert. Een concept is niet vastgesteld.",
        "A register as decided, which never changes. A draft is not decided.",
    ),
    "term_flag": ("Waarschuwing", "Flag"),
    "meaning_flag": (
        "Iets om naar te kijken; het verandert geen getal.",
        "Something to look at; it changes no number.",
    ),
    "term_set_aside": ("Terzijde gelegd", "Set aside"),
    "meaning_set_aside": (
        "Niet gebruikt, met de reden erbij.",
        "Not used, with the reason.",
    ),
    "term_e_n": ("E_n", "E_n"),
    "meaning_e_n": (
        "Verschil van twee proeven gedeeld door beide 95 %-intervallen samen; voorbij 1 spreken ze "
        "elkaar tegen.",
        "Difference of two tows divided by both 95 % intervals together; beyond 1 they disagree.",
    ),
    "term_power": ("Vermogen per roeier", "Power per rower"),
    "meaning_power": (
        "Wat elke roeier gemiddeld levert, in watt; de ploeg die het meeste levert, wint.",
        "What each rower gives on average, in watts; the crew that gives most wins.",
    ),
    "term_type": ("Standaardsnelheid", "Standard speed"),
    "meaning_type": (
        "De middelste opgegeven snelheid van een type; bij die snelheid zijn sloepen te "
        "vergelijken.",
        "The median declared speed of a type, at which boats can be compared.",
    ),
    "term_verification_code": ("Controlecode", "Verification code"),
    "meaning_verification_code": (
        "Berekend uit alles waar een regel van een editie op rust: verandert daar iets, dan "
        "verandert de code.",
        "Computed from everything behind a line of an edition: if any of that changes, so does "
        "the code.",
    ),
    "term_crew_class": ("Klasse", "Class"),
    "meaning_crew_class": ("H: heren, D: dames.", "H: men, D: women."),
    # Register
    "register_note": (
        "A en B gelden van 85 tot 115 % van de opgegeven roeisnelheid; Cw geldt bij die snelheid. "
        "Het interval van Cw is 95 % bij een methode die de fout van de log schat. Bij andere "
        "methoden is het alleen de spreiding van de runs: de fout van de log zit er niet in. Een "
        "verlopen regel heeft geen A, B en Cw. Een concept is niet gepubliceerd.",
        "A and B hold from 85 to 115 % of the declared speed; Cw holds at that speed. Its interval "
        "is a 95 % interval for a method that estimates the log's error. For other methods it is "
        "the spread of the runs alone: the log's error is not in it. An expired line has no A, B "
        "and Cw. A draft is not published.",
    ),
    # Due
    "due_list": ("Wie moet weer slepen", "Who has to tow again"),
    "due_list_note": (
        "Tot wanneer elke proef telt, beoordeeld op de dag van de laatste proef of wedstrijd (de "
        "peildatum), en de snelheid voor de volgende. Laagste en Hoogste: 70 tot 90 W per roeier "
        "(heren) of 40 tot 55 W (dames) op de bekende kromme. Buiten de kromme: verder dan 85 tot "
        "115 % van de opgegeven snelheid.",
        "Until when each tow counts, as judged on the day of the last tow or race (As of), and the "
        "speed of the next one. Lowest and Highest: 70 to 90 W per rower (men) or 40 to 55 W "
        "(women) on the known curve. Beyond the curve: outside 85 to 115 % of the declared speed.",
    ),
    "retow_choice": ("Welke sloepen opnieuw slepen", "Which boats to tow again"),
    "retow_choice_note": (
        "Sloepen die, opnieuw gesleept met dGPS, de onzekerheid van de logfactoren het meest "
        "verkleinen; de eerste het meest. Sd: standaardafwijking van een factor, voor en na.",
        "Boats that, towed again with dGPS, reduce the uncertainty of the log factors most; the "
        "first one most. Sd: standard deviation of a factor, before and after.",
    ),
    # Boat
    "facts": ("Maten", "Dimensions"),
    "boat_lines": ("In het register", "In the register"),
    "boat_curve": ("Weerstandskromme", "Resistance curve"),
    "boat_curve_note": (
        "De lijn is Cw = A / (1 - (v/B)^2) over het geldige bereik, 85 tot 115 % van de opgegeven "
        "snelheid; de streep is het interval bij die snelheid. Een volle band en streep zijn het "
        "95 %-interval, met alles wat in de onzekerheid zit; een lichte band en een streepjeslijn "
        "de spreiding van de runs alleen: de fout van de log zit er niet in. Open tekens tellen "
        "niet mee.",
        "The line is Cw = A / (1 - (v/B)^2) over the valid range, 85 to 115 % of the declared "
        "speed; the bar is the interval at that speed. A full band and bar are the 95 % interval, "
        "with all that the uncertainty is made of; a light band and a dashed bar the spread of the "
        "runs alone: the log's error is not in it. Open marks do not count.",
    ),
    "boat_history": ("Door de jaren", "Through the years"),
    "boat_history_note": (
        "Cw bij de opgegeven snelheid van elke proef, volgens elke methode. Een doorgetrokken lijn "
        "is het 95 %-interval, een streepjeslijn de spreiding van de runs alleen: de fout van de "
        "log zit er niet in.",
        "Cw at the declared speed of every tow, by every method. A solid line is its 95 % "
        "interval, a dashed one the spread of the runs alone: the log's error is not in it.",
    ),
    "boat_traces": ("Wat de instrumenten zeiden", "What the instruments said"),
    "boat_traces_note": (
        "Gemiddelden per seconde; snelheid: doorgetrokken log 1, gestreept GPS. Wat grijs "
        "is, is weggesneden om de reden die erboven staat; de rest telt.",
        "Means per second; speed: solid log 1, dashed GPS. What is grey is cut for the "
        "reason above it; the rest counts.",
    ),
    "boat_runs": ("Runs", "Runs"),
    "boat_out_back": ("Heen tegen terug, en de wind", "Out against back, and the wind"),
    "boat_out_back_note": (
        "Cw voor en na de luchtcorrectie, heen (runs 1-3) en terug (runs 4-6). Na de correctie "
        "horen heen en terug samen te vallen. Windhoek: 0 graden is van voren, min van bakboord, "
        "180 van achteren.",
        "Cw before and after the air correction, out (runs 1-3) and back (runs 4-6). After the "
        "correction out and back should coincide. Wind angle: 0 degrees is from ahead, minus from "
        "port, 180 from behind.",
    ),
    "boat_lineage": ("Herkomst", "Lineage"),
    "boat_lineage_note": (
        "De bestanden, de methode en de code achter elke registerregel.",
        "The files, the method and the code behind every register line.",
    ),
    # Types
    "types_charts": ("B en Cw per type", "B and Cw per type"),
    "types_note": (
        "De gekozen proeven volgens twee methoden, op dezelfde assen. Sloepen zonder type staan "
        "er niet bij. Standaardsnelheid: de middelste opgegeven snelheid van het type. Sleep "
        "over een grafiek om sloepen te kiezen, of vul eronder van en tot in: de lijst toont "
        "ze, elk met de nieuwste proef. Laagste en hoogste zijn een 95 %-interval, of bij een "
        "methode die de fout van de log niet schat de spreiding van de runs alleen: die fout zit "
        "er dan niet in. Klik op een punt om naar de sloep te gaan. Twee typen "
        "volgens vier methoden staan onder Presentatie 2015. Van welk seizoen tot welk kiest u "
        "vrij in de werkbank (herijk workbench), die de statistiek ervoor opnieuw berekent.",
        "The chosen tows under two methods, on the same axes. Boats without a type are left "
        "out. Standard speed: the median declared speed of the type. Drag over a chart to "
        "select boats, or fill in from and to below it: the list shows them, each with its "
        "newest tow. Lowest and highest are a 95 % interval, or with a method that does not "
        "estimate the log's error the spread of the runs alone: that error is then not in it. "
        "Click a point to go to the boat. Two types by four methods are on the "
        "page Presentation 2015. Any range of seasons can be chosen in the workbench (herijk "
        "workbench), which computes its statistics anew.",
    ),
    "b_weight": ("B tegen gewicht", "B against weight"),
    "b_speed": ("B tegen opgegeven snelheid", "B against declared speed"),
    "a_weight": ("A tegen gewicht", "A against weight"),
    "cw_standard_weight": (
        "Cw bij standaardsnelheid tegen gewicht",
        "Cw at the standard speed against weight",
    ),
    "cw_standard_speed": (
        "Cw bij standaardsnelheid tegen opgegeven snelheid",
        "Cw at the standard speed against declared speed",
    ),
    "types_list": ("Sloepen", "Boats"),
    "before": ("Voor", "Before"),
    "after": ("Na", "After"),
    "pair_first": ("Vergelijk", "Compare"),
    "pair_second": ("met", "with"),
    "types_lines": ("Hangt het af van gewicht of snelheid?", "Does it follow weight or speed?"),
    "types_lines_newest": (
        "Hangt het af van gewicht of snelheid? De nieuwste proef van elke ploeg",
        "Does it follow weight or speed? The newest tow of each crew",
    ),
    "types_lines_note": (
        "Een rechte lijn per type door n proeven; proeven van een sloep tellen als herhaling. De "
        "pagina van een type heeft ook die door alle proeven en per seizoen. De helling "
        "is de verandering van de grootheid per kg of per m/s (bij een macht: de exponent); een "
        "helling waarvan het interval 0 bevat, is niet aangetoond. R²: deel van de spreiding dat "
        "de lijn verklaart. q is (v/B)²/(1 - (v/B)²) bij de standaardsnelheid, de middelste "
        "opgegeven snelheid van het type.",
        "A straight line per type through n tows; tows of one boat count as repeats. The page of a "
        "type also has those through all tows and per season. The slope is "
        "the change of the quantity per kg or per m/s (of a power: the exponent); a slope whose "
        "interval holds 0 is not shown to exist. R²: share of the spread that the line explains. q "
        "is (v/B)²/(1 - (v/B)²) at the standard speed, the median declared speed of the type.",
    ),
    "types_homogeneity": ("Kan één B voor het type?", "Could one B serve the type?"),
    "types_homogeneity_note": (
        "Van de nieuwste proef van elke sloep en ploeg (n). p: kans op zoveel verschil tussen de "
        "bochten als alle sloepen dezelfde B hebben; een kleine p zegt dat ze die niet hebben. "
        "Kans 10 % te zien: hoe waarschijnlijk een echte spreiding van 10 % in B hier was "
        "opgemerkt. Deel ruis: deel van de spreiding dat de runs alleen al geven.",
        "Of the newest tow of each boat and crew (n). p: chance of so large a difference between "
        "the bends if all boats have the same B; a small p says that they have not. Chance to see "
        "10 %: how likely a true spread of B of 10 % would have been noticed here. Share of noise: "
        "share of the spread that the runs alone give.",
    ),
    "types_outliers_note": (
        "Ver van wat de andere sloepen van het type voorspellen, in standaardafwijkingen (sd) van "
        "die voorspelling. Een mogelijke verklaring is iets om na te gaan, niet bewezen.",
        "Far from what the other boats of the type predict, in standard deviations (sd) of that "
        "prediction. A possible cause is something to look at, not proven.",
    ),
    "types_outliers": (
        "Nieuwste proeven die afwijken van hun type",
        "Newest tows that differ from their type",
    ),
    "types_outliers_tows": (
        "Gekozen proeven die in Cw afwijken van hun type",
        "Chosen tows whose Cw differs from their type",
    ),
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
    "season_change": ("Ten opzichte van de gepubliceerde Cw", "Relative to the published Cw"),
    "season_change_note": (
        "Cw volgens de methode / Cw zoals gepubliceerd, van dezelfde proef: mediaan, en laagste "
        "tot hoogste.",
        "Cw by the method / Cw as published, of the same tow: median, and lowest to highest.",
    ),
    "options": ("Gevoeligheid voor keuzes", "Sensitivity to choices"),
    "options_note": (
        "Wat Cw verandert als één keuze anders was gemaakt: mediaan en de middelste 90 % van de "
        "proeven.",
        "How Cw would change if one choice were made otherwise: median and the middle 90 % of "
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
        "Nieuwe Cw / oude Cw, bij het seizoen van de nieuwe proef. E_n: het verschil gedeeld "
        "door beide intervallen samen; voorbij 1 spreken twee proeven elkaar tegen. Waar die de "
        "spreiding van de runs alleen zijn, kan dat de fout van de log zijn. Klik op "
        "een punt om naar de sloep te gaan.",
        "New Cw / old Cw, at the season of the new tow. E_n: the difference divided by both "
        "intervals together; beyond 1 two tows disagree. Where these are the spread of the runs "
        "alone, that may be the log's error. Click a point to go to the boat.",
    ),
    "components": ("Waar de spreiding vandaan komt", "Where the spread comes from"),
    "components_note": (
        "Wat verschillen tussen sloepen, tussen seizoenen, van een sloep tussen seizoenen, en "
        "tussen runs bijdragen aan de spreiding van Cw: standaardafwijking met 95 %-interval, uit "
        "één model van alle proeven met een kromme (n). Elke ploeg van een sloep telt apart als "
        "sloep, en na een verbouwing opnieuw.",
        "What differences between boats, between seasons, of a boat between seasons, and between "
        "runs add to the spread of Cw: standard deviation with 95 % interval, from one model of "
        "all tows with a curve (n). Each crew of a boat counts as a boat, and again after an "
        "alteration.",
    ),
    "predicted": ("Voorspeld zonder slepen", "Predicted without towing"),
    "predicted_note": (
        "Cw uit lengte, gewicht, breedte en type tegen Cw uit de proef. Op de lijn zijn ze gelijk. "
        "Verschilt: meer dan de onzekerheid van beide; bij een methode die de fout van de log niet "
        "schat, zit die er niet in.",
        "Cw from length, weight, beam and type against Cw from the tow. On the line they agree. "
        "Disagrees: by more than the uncertainty of both; under a method that does not estimate "
        "the log's error, that is not in it.",
    ),
    # Changes
    "changes_list": ("Gewijzigde regels", "Changed lines"),
    "changes_note": (
        "Nieuw / oud: bij de oude opgegeven snelheid; vermogen verandert evenveel. In 2 uur: "
        "seconden die de ploeg voor hetzelfde vermogen langer (+) mag doen of sneller (-) moet "
        "zijn. Snelheidsplaats: van alle sloepen van de klasse bij gelijk vermogen, niet de plaats "
        "in een wedstrijd. De oorzaken vermenigvuldigen samen tot Cw nieuw / oud.",
        "New / old: at the old declared speed; power changes as much. In 2 h: seconds that the "
        "crew may take longer (+) or has to be faster (-) for the same power. Speed rank: among "
        "all boats of the class at equal power, not the place in a race. The causes multiply to "
        "Cw new / old.",
    ),
    # Quality
    "statuses": ("Status van de krommen", "Status of the curves"),
    "flags": ("Waarschuwingen", "Flags"),
    "flags_note": (
        "Een waarschuwing zegt waar iemand naar moet kijken; ze verandert geen getal.",
        "A flag says what a person should look at; it never changes a number.",
    ),
    "run_reasons": ("Runs die niet tellen", "Runs that do not count"),
    "set_aside": ("Terzijde gelegd", "Set aside"),
    "set_aside_note": (
        "Bestanden, regels en proeven die niet gebruikt zijn, met de reden.",
        "Files, lines and tows not used, with the reason.",
    ),
    "checks": ("Wat de controles vonden", "What the checks found"),
    "checks_note": (
        "Op hoeveel proeven elke controle is gedaan, en hoe vaak iets buiten zijn grens lag.",
        "On how many tows each check was made, and how often something lay beyond its limit.",
    ),
    "rebuilt": ("Wat de herrekening deed", "What the rebuild did"),
    "rebuilt_note": (
        "Proeven per seizoen die in de sleeplijst staan en die gebruikt zijn; de methoden die zijn "
        "toegepast; en de tabellen die daaruit zijn gemaakt.",
        "Tows per season that the tow list holds and that were used; the methods applied; and the "
        "tables made of them.",
    ),
    "seasons": ("Seizoenen", "Seasons"),
    "nothing_set_aside": ("Niets is terzijde gelegd.", "Nothing was set aside."),
    "no_changes": ("Er zijn geen gewijzigde regels.", "There are no changed lines."),
    "editions": ("Uitgegeven edities", "Published editions"),
    "races_note": (
        "Elke uitslag opnieuw berekend volgens de oude en de nieuwe editie; kies een wedstrijd.",
        "Every result computed again by the old and the new edition; choose a race.",
    ),
    "race_results": ("Uitslag volgens beide edities", "Results by both editions"),
    "race_ranks": ("Plaats oud en nieuw", "Place before and after"),
    "race_note": (
        "Vermogen per roeier in deze wedstrijd, en de plaats daarnaar, per klasse: onder de "
        "ploegen die op die dag in beide edities een geldige regel hebben. Op de lijn blijft de "
        "plaats gelijk.",
        "Power per rower in this race, and the place by it, by class: among the crews that have a "
        "valid line on that day in both editions. On the line the place stays the same.",
    ),
    "no_races": (
        "Het archief bevat geen wedstrijden om opnieuw te berekenen.",
        "The archive holds no races to compute again.",
    ),
    "downloads": ("Downloads", "Downloads"),
    "downloads_note": (
        "Het register van elke editie zoals uitgegeven, met het bericht aan de leden en de "
        "toelichting in twee talen.",
        "The register of every edition as published, with the notice to the members and the "
        "release notes in Dutch and English.",
    ),
    "season_links": ("Waar een logfactor op rust", "What a log factor rests on"),
    "season_links_note": (
        "Waar een log binnen een seizoen is vervangen, heeft elk deel een eigen factor; de "
        "grafiek hierboven toont hun gemiddelde. De andere log heeft ook een regel: de methode "
        "gebruikt hem niet. Grootste invloed: hoever de factor hoogstens verschuift als één sloep "
        "ontbreekt.",
        "Where a log was replaced within a season each part has its own factor; the chart above "
        "shows their mean. The other log has a line too: the method does not use it. Largest "
        "influence: how far the factor moves at most when one boat is left out.",
    ),
    "season_steps": ("Log of krachtmeter?", "Log or load cell?"),
    "season_steps_note": (
        "Een seizoen kan afwijken van de andere proeven van dezelfde sloepen doordat de log of "
        "doordat de krachtmeter verkeerd wees. De bocht van de krommen onderscheidt die twee. "
        "Stappen van Cw in procenten, met hun standaardafwijking (sd); voor een stap onder 3 % of "
        "onder twee keer zijn sd is geen oorzaak gezocht.",
        "A season may differ from the other tows of the same boats because the log or because the "
        "load cell was wrong. The bend of the curves tells the two apart. Steps of Cw in per cent, "
        "with their standard deviation (sd); for a step below 3 % or below twice its sd no cause "
        "is looked for.",
    ),
    "season_diagnosis": ("Instrumenten per seizoen", "Instruments by season"),
    "season_diagnosis_note": (
        "Wat er in een seizoen mis kan zijn met log, GPS, krachtmeter, windmeter of temperatuur. "
        "Fout: waarschijnlijker wel dan niet. Niet te zeggen: 10 tot 50 %. Alarm: 4 "
        "standaardafwijkingen van wat gewoon is. Zou niet opvallen: een gewone fout zou voor iets "
        "anders worden aangezien. Grootte: in procenten, of in N; het interval rekent mee hoe "
        "zelden zo'n fout is, en kan dus 0 tot 0 zijn. Wat niet in de tabel staat: geen fout "
        "gezien, en een gewone zou opvallen.",
        "What may be wrong in a season with log, GPS, load cell, anemometer or temperature. Fault: "
        "likelier than not. Cannot be told: 10 to 50 %. Alarm: 4 standard deviations from what is "
        "usual. Would not show: a fault of the usual size would be taken for something else. "
        "Size: in per cent, or in N; the interval counts how seldom such a fault is, so it can be "
        "0 to 0. What is not in the table: no fault was seen, and a usual one would show.",
    ),
    "eras": ("Wijkt een tijdvak af?", "Does an era differ?"),
    "eras_note": (
        "Volgende proef van dezelfde sloepen, in een later tijdvak, tegen die in het tijdvak "
        "zelf, zonder veroudering: mediaan van n paren met 95 %-interval. In de grafiek alle "
        "typen samen.",
        "Next tow of the same boats, in a later era, against that in the era itself, without "
        "ageing: median of n pairs with 95 % interval. The chart has all types together.",
    ),
    "assessments": ("Controles", "Checks"),
    "assessments_note": (
        "Alleen wat buiten zijn grens ligt; alle controles staan in de tabel assessments.",
        "Only what lies beyond its limit; all checks are in the table assessments.",
    ),
    "uncertainty_budget_note": (
        "Relatieve standaardonzekerheid van Cw per oorzaak; de tabel zegt welke proeven die delen.",
        "Relative standard uncertainty of Cw by cause; the table says which tows share it.",
    ),
    "hand_windows_note": (
        "Vensters die iemand zelf heeft gekozen, met de reden.",
        "Windows that a person chose, with the reason.",
    ),
    "uncertainty_budget": ("Waaruit de onzekerheid bestaat", "What the uncertainty is made of"),
    "hand_windows": ("Met de hand gekozen vensters", "Windows chosen by hand"),
}

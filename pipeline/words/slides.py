"""Titles and sentences of the slide book, and the words of its charts."""

from typing import Final

SLIDES: Final[dict[str, tuple[str, str]]] = {
    "slides": ("Presentatie 2015", "Presentation 2015"),
    "about_slides": (
        "Elke grafiek van de presentatie van 24 januari 2015, over alle seizoenen, voor en na.",
        "Every chart of the presentation of 24 January 2015, over all seasons, before and after.",
    ),
    "slides_note": (
        "De methoden staan naast elkaar op gelijke assen. Cirkels zijn heren, driehoeken dames. "
        "Een open teken is een proef die te langzaam of te snel was voor de standaardsnelheid, een "
        "zwarte stip een proef met te weinig vermogen. De lijn is de best passende rechte met een "
        "95 %-interval; bij gewicht en lengte een per ploegklasse. R² is het deel van de spreiding "
        "dat de lijn verklaart, met elke proef gewogen naar de fout en proeven van een sloep als "
        "herhaling. Een proef waarvan Cw van het type afwijkt, is genoemd. Een streep is het "
        "95 %-interval van een proef; een streepjeslijn de spreiding van de runs alleen: de fout "
        "van de log zit er niet in.",
        "The methods stand side by side on equal axes. Circles are men, triangles women. An open "
        "mark is a tow too slow or too fast for the standard speed, a black dot one with too "
        "little power. The line is the straight line that fits best, with its 95 % interval; "
        "against weight and length one per crew class. R² is the share of the spread that the line "
        "explains, each tow weighted by its error and tows of one boat as repeats. A tow whose Cw "
        "is an outlier of its type is named. A bar is a tow's 95 % interval; a dashed one the "
        "spread of the runs alone: the log's error is not in it.",
    ),
    # Charts
    "crew_class": ("Ploeg", "Crew"),
    "crew": ("Ploeg", "Crew"),
    "waterline_length": ("Lengte waterlijn [m]", "Waterline length [m]"),
    "tow_hull_ratio": ("Sleepsnelheid / rompsnelheid", "Tow speed / hull speed"),
    "speed_case": ("Sleepsnelheid t.o.v. rompsnelheid", "Tow speed by hull speed"),
    "power": ("Vermogen bij slepen [W]", "Power when towed [W]"),
    "power_ratio_raced": (
        "Vermogen: eigen kromme / die van het type",
        "Power: own curve / type's curve",
    ),
    "tows": ("Proeven", "Tows"),
    "all_tows": ("alle proeven", "all tows"),
    "code.newest": ("de nieuwste van elke ploeg", "the newest of each crew"),
    "ticked": ("Aangevinkt", "Ticked"),
    "code.as_read": ("log zoals gelezen", "log as read"),
    "code.dgps": ("geijkt op dGPS", "calibrated on dGPS"),
    "code.multiply": ("log \u00d7 (1 + correctie)", "log \u00d7 (1 + correction)"),
    "code.divide": ("log / (1 - correctie)", "log / (1 - correction)"),
    "code.optimisation": ("optimalisatie", "optimisation"),
    "code.trimming": ("afkappen", "trimming"),
    "code.vane": ("windvaancorrectie", "wind-vane correction"),
    "code.b_from_length": ("B uit sloeplengte", "B from length"),
    "code.correction": ("snelheidscorrectie", "speed correction"),
    "code.operation": ("delen i.p.v. vermenigvuldigen", "dividing, not multiplying"),
    "code.estimate": ("geschatte logfactor", "estimated log factor"),
    "median_ratio": ("Mediaan / gemiddelde", "Median / mean"),
    "code.channel.log1": ("log 1 [m/s]", "log 1 [m/s]"),
    "code.channel.log2": ("log 2 [m/s]", "log 2 [m/s]"),
    "code.channel.gps": ("GPS [m/s]", "GPS [m/s]"),
    "code.channel.force": ("kracht [N]", "force [N]"),
    "code.channel.wind": ("wind [m/s]", "wind [m/s]"),
    "code.channel.cw": ("Cw gemeten [kg/m]", "Cw measured [kg/m]"),
    # Titles
    "slide.weight": ("{y} tegen gewicht: {types}", "{y} against weight: {types}"),
    "slide.speed": ("{y} tegen sleepsnelheid: {types}", "{y} against tow speed: {types}"),
    "slide.length": ("{y} tegen lengte: {types}", "{y} against length: {types}"),
    "slide.b": ("B", "B"),
    "slide.a": ("A", "A"),
    "slide.cw": ("Cw bij standaardsnelheid", "Cw at the standard speed"),
    "slide.of_season": (", alleen {tows}", ", {tows} only"),
    "slide.hull_speed": ("Is B de rompsnelheid?", "Is B hull speed?"),
    "slide.towed_at": (
        "Op welk deel van de rompsnelheid wordt gesleept?",
        "At what part of hull speed are boats towed?",
    ),
    "slide.raced_beyond": (
        "Sloepen die harder roeien dan hun kromme geldt",
        "Boats that race faster than their curve holds",
    ),
    "slide.boat_years": ("{name} door de jaren", "{name} through the years"),
    "slide.eras": (
        "Wijken de proeven van een tijdvak af van latere?",
        "Do tows of an era differ from later ones?",
    ),
    # Sentences
    "slide.line": (
        "{type}: {verdict}. R² {r2_after} {after}, {r2_before} {before}; {counted}.",
        "{type}: {verdict}. R² {r2_after} {after}, {r2_before} {before}; {counted}.",
    ),
    "slide.counted": ("{tows} van {boats}", "{tows} of {boats}"),
    "slide.one_tow": ("1 proef", "1 tow"),
    "slide.many_tow": ("{n} proeven", "{n} tows"),
    "slide.one_boat": ("1 sloep", "1 boat"),
    "slide.many_boat": ("{n} sloepen", "{n} boats"),
    "slide.no_tow": ("geen proef", "no tow"),
    "slide.rises": ("{y} stijgt met {x}", "{y} rises with {x}"),
    "slide.falls": ("{y} daalt met {x}", "{y} falls with {x}"),
    "slide.none": (
        "geen verband tussen {y} en {x} gezien",
        "no relation seen between {y} and {x}",
    ),
    "slide.unclear": (
        "te weinig sloepen om te zeggen of {y} met {x} samenhangt",
        "too few boats to tell whether {y} goes with {x}",
    ),
    "slide.no_line": (
        "{type}: te weinig sloepen voor een lijn ({counted}).",
        "{type}: too few boats for a line ({counted}).",
    ),
    "slide.x.weight": ("gewicht", "weight"),
    "slide.x.speed": ("sleepsnelheid", "tow speed"),
    "slide.x.length": ("lengte", "length"),
    "slide.outside": ("Uitschieters in Cw: {names}.", "Outliers in Cw: {names}."),
    "slide.b_is_not": (
        "Nee: B ligt op {ratio} keer de rompsnelheid ({lo} tot {hi}; {boats}, {after}); {share} "
        "ligt er binnen 5 % van.",
        "No: B lies at {ratio} times hull speed ({lo} to {hi}; {boats}, {after}); {share} lie "
        "within 5 % of it.",
    ),
    "slide.b_is": (
        "Het kan: B ligt op {ratio} keer de rompsnelheid ({lo} tot {hi}; {boats}, {after}).",
        "It may be: B lies at {ratio} times hull speed ({lo} to {hi}; {boats}, {after}).",
    ),
    "slide.b_unknown": (
        "Te weinig sloepen met een B om het te zeggen ({boats}).",
        "Too few boats with a B to tell ({boats}).",
    ),
    "slide.towed": (
        "De helft van de proeven ligt boven {ratio} van de rompsnelheid; {share} ligt tussen 60 en "
        "70 %, waar de presentatie het roeien plaatst.",
        "Half of the tows lie above {ratio} of hull speed; {share} lie between 60 and 70 %, where "
        "the presentation puts rowing.",
    ),
    "slide.raced": (
        "Gesleept met weinig vermogen of geroeid buiten de eigen kromme: {n}. Daarvan geeft de "
        "eigen kromme {up} keer te veel en {down} keer te weinig vermogen (het interval sluit 1 "
        "uit). Gesleept onder 70 W (dames 40) en geroeid boven 100 W (dames 57): {both}.",
        "Towed with little power or raced off their own curve: {n}. The own curve of {up} of these "
        "gives too much power, of {down} too little (the interval leaves out 1). Towed under "
        "70 W (women 40) and raced above 100 W (women 57): {both}.",
    ),
    "slide.years": (
        "{crew}: Cw bij {speed} m/s loopt {after_spread} uiteen {after}, {before_spread} {before} "
        "(hoogste / laagste van {n}).",
        "{crew}: Cw at {speed} m/s spreads by {after_spread} {after}, {before_spread} {before} "
        "(highest / lowest of {n}).",
    ),
    "slide.one_tow_a_crew": (
        "Elke ploeg is een keer gesleept: er is niets te vergelijken.",
        "Every crew was towed once: there is nothing to compare.",
    ),
    "slide.apart": (
        "Van een proef van {era} naar de volgende van dezelfde sloep: {before}; {after}.",
        "From a tow of {era} to the next of the same boat: {before}; {after}.",
    ),
    "slide.is_apart": (
        "{method} wijkt die af, Cw {shift} ({lo} tot {hi})",
        "{method} it stands apart, Cw {shift} ({lo} to {hi})",
    ),
    "slide.not_apart": (
        "{method} is geen afwijking gezien, {shift} ({lo} tot {hi})",
        "{method} no difference is seen, {shift} ({lo} to {hi})",
    ),
    "slide.ticks": (
        "{tow}: alle combinaties van de vier opties van 2015",
        "{tow}: all combinations of the four options of 2015",
    ),
    "slide.ticks_said": (
        "{tow}: de hoogste van {n} krommen ligt {spread} boven de laagste (Cw bij de opgegeven "
        "snelheid, "
        "log zoals gelezen, {method}). Gemiddeld over de andere keuzen: {effects}.",
        "{tow}: the highest of {n} curves lies {spread} above the lowest (Cw at the declared "
        "speed, log "
        "as read, {method}). On average over the other choices: {effects}.",
    ),
    "slide.tick_effects": (
        "Wat de opties van 2015 met alle sloepen doen",
        "What the options of 2015 do to all boats",
    ),
    "slide.tick_effects_said": (
        "De mediane verandering van Cw over {tows}: {effects} ({method}). De streep omvat de "
        "middelste 90 % van de proeven.",
        "The median change of Cw over {tows}: {effects} ({method}). The bar holds the middle 90 % "
        "of the tows.",
    ),
    "decimal_mark": (",", "."),
    # Columns and codes
    "code.low": ("laag (onder 67 %)", "low (under 67 %)"),
    "code.middle": ("midden (67 tot 80 %)", "middle (67 to 80 %)"),
    "code.high": ("hoog (vanaf 80 %)", "high (80 % and above)"),
    "column.a_lo_kg_m": ("A laagste [kg/m]", "A lowest [kg/m]"),
    "column.a_hi_kg_m": ("A hoogste [kg/m]", "A highest [kg/m]"),
    "column.b_hull_ratio": ("B / romp\u00adsnelheid", "B / hull speed"),
    "column.b_ratio": ("B / romp\u00adsnelheid", "B / hull speed"),
    "column.b_ratio_lo": ("Laagste", "Lowest"),
    "column.b_ratio_hi": ("Hoogste", "Highest"),
    "column.cw_standard_lo_kg_m": ("Laagste [kg/m]", "Lowest [kg/m]"),
    "column.cw_standard_hi_kg_m": ("Hoogste [kg/m]", "Highest [kg/m]"),
    "column.expected_cw_kg_m": ("Verwacht [kg/m]", "Expected [kg/m]"),
    "column.hull_speed_m_s": ("Romp\u00adsnelheid [m/s]", "Hull speed [m/s]"),
    "column.b_from_length": ("B uit sloep\u00adlengte", "B from length"),
    "column.channel": ("Kanaal", "Channel"),
    "column.log1_ratio": ("Snelheid / log 1", "Speed / log 1"),
    "column.mean": ("Gemiddelde", "Mean"),
    "column.median": ("Mediaan", "Median"),
    "column.optimisation": ("Optimalisatie", "Optimisation"),
    "column.sd": ("Spreiding", "Spread"),
    "column.speed_case": (
        "Sleep\u00adsnelheid t.o.v. romp\u00adsnelheid",
        "Tow speed by hull speed",
    ),
    "column.speed": ("Snelheid", "Speed"),
    "column.study": ("Studie", "Study"),
    "column.trimming": ("Afkappen", "Trimming"),
    "column.vane": ("Windvaan\u00adcorrectie", "Wind-vane correction"),
    "column.slow": ("Te weinig vermogen", "Too little power"),
    "column.raced_power_w": ("Vermogen in wedstrijd [W]", "Power in the race [W]"),
    "column.power_ratio_raced": ("Eigen kromme / type", "Own curve / type"),
    "column.power_ratio_raced_lo": ("Laagste", "Lowest"),
    "column.power_ratio_raced_hi": ("Hoogste", "Highest"),
    "column.label": ("Proef", "Tow"),
    "column.newest_method": ("Methode", "Method"),
    "column.outside": ("Uitschieter", "Outlier"),
    "column.share_stated_1pct": ("Zegt < 1 %", "States < 1 %"),
    "column.share_stated_2pct": ("Zegt < 2 %", "States < 2 %"),
    "column.share_seen_1pct": ("Herhaald < 1 %", "Repeated < 1 %"),
    "column.share_seen_2pct": ("Herhaald < 2 %", "Repeated < 2 %"),
    "column.tow_hull_ratio": ("Sleep\u00adsnelheid / romp\u00adsnelheid", "Tow speed / hull speed"),
    "column.tow_ratio": ("Sleep\u00adsnelheid / romp\u00adsnelheid", "Tow speed / hull speed"),
    "column.tow_share_60_70": ("Deel bij 60-70 %", "Share at 60-70 %"),
    "column.x": ("x van de lijn", "x of the line"),
    "column.y": ("y van de lijn", "y of the line"),
    # Page
    "slides_weight": ("Tegen gewicht", "Against weight"),
    "slides_speed": ("Tegen sleepsnelheid", "Against tow speed"),
    "slides_length": ("Tegen lengte", "Against length"),
    "slides_hull_speed": ("Is B de rompsnelheid?", "Is B hull speed?"),
    "slides_2014": ("2014 opnieuw berekend", "2014 recomputed"),
    "slides_2014_note": (
        "De proeven van 2014 zoals ze dat jaar uitkwamen, begin 2015 herrekend na alle "
        "verbeteringen, en zoals ze nu worden berekend.",
        "The tows of 2014 as they came out that year, recomputed early in 2015 after all "
        "improvements, and as computed today.",
    ),
    "slides_raced": (
        "Traag gesleept, hard geroeid",
        "Towed slowly, raced fast",
    ),
    "slide_raced_beyond": (
        "Vermogen in een wedstrijd: eigen kromme tegen die van het type",
        "Race power: own curve against that of the type",
    ),
    "slides_eras": (
        "Wijken seizoenen met andere instrumenten af?",
        "Do seasons with other instruments stand apart?",
    ),
    "slides_ticks": ("De vier opties van 2015", "The four options of 2015"),
    "slides_ticks_note": (
        "Optimalisatie, afkappen, windvaancorrectie en B uit sloeplengte: alle zestien combinaties "
        "over elkaar, met de snelheid van de log en na correctie. Elk vak kleurt een optie.",
        "Optimisation, trimming, wind-vane correction and B from length: all sixteen combinations "
        "overlaid, with the log's speed and after correction. Each panel colours one option.",
    ),
    "slide_ticks": (
        "Krommen onder alle combinaties van de opties",
        "Curves under all combinations of the options",
    ),
    "slide_tick_effects": ("Wat elke optie met Cw doet", "What each option does to Cw"),
    "boat_ticks": ("Wat andere keuzen met de kromme doen", "What other choices do to the curve"),
    "run_statistics": (
        "Spreiding binnen elke run; streepjeslijn: 10 %",
        "Spread within each run; dashed: 10 %",
    ),
    "boat_statistics": ("De metingen per run", "The measurements per run"),
    "boat_statistics_note": (
        "Wat het programma van 2014 per run liet zien: gemiddelde, spreiding, mediaan en hun "
        "verhoudingen, hier van secondegemiddelden. De getallen staan in de tabel eronder.",
        "What the tool of 2014 showed of each run: mean, spread, median and their ratios, here of "
        "means per second. The numbers are in the table below it.",
    ),
    "slides_years": ("Een sloep door de jaren", "One boat through the years"),
    **{
        f"slide_{y}_{x}": (f"{name_nl} tegen {x_nl}", f"{name_en} against {x_en}")
        for y, (name_nl, name_en) in {
            "b": ("B", "B"),
            "a": ("A", "A"),
            "cw": ("Cw bij standaardsnelheid", "Cw at the standard speed"),
        }.items()
        for x, (x_nl, x_en) in {
            "weight": ("gewicht", "weight"),
            "speed": ("sleepsnelheid", "tow speed"),
            "length": ("lengte", "length"),
        }.items()
    },
    "slide_hull_speed": (
        "B tegen lengte; op de streepjeslijn is B de rompsnelheid",
        "B against length; on the dashed line B is hull speed",
    ),
    "slide_towed_at": (
        "Sleepsnelheid als deel van de rompsnelheid; grijs: 60-70 %",
        "Tow speed as part of hull speed; grey: 60-70 %",
    ),
    "slide_boat_years": (
        "Krommen van alle seizoenen; streepjeslijn: de standaardsnelheid",
        "Curves of all seasons; dashed: the standard speed",
    ),
    "claim_hull_speed": ("B en rompsnelheid per type", "B and hull speed per type"),
    "claim_hull_speed_note": (
        "Sleepsnelheid en B als deel van de rompsnelheid, 1,25 keer de wortel van de waterlijn. "
        "Van B de mediaan van de sloepen met het 95 %-interval: ligt 1 daarbuiten, dan is B niet "
        "de rompsnelheid.",
        "Tow speed and B as parts of hull speed, 1.25 times the root of the waterline. Of B the "
        "median of the boats with its 95 % interval: if 1 lies outside it, B is not hull speed.",
    ),
    "claim_promise": ("Binnen 2 %, en binnen 1 %?", "Within 2 %, and within 1 %?"),
    "claim_promise_note": (
        "De presentatie: een ruime meerderheid binnen 2 %, na verbetering alle binnen 1 %. Eerst "
        "wat de proeven zelf zeggen (half 95 %-interval; bij de oude methoden alleen de spreiding "
        "van de runs), dan wat herhaalde proeven laten zien.",
        "The presentation: a large majority within 2 %, after the improvements all within 1 %. "
        "First what the tows state themselves (half the 95 % interval; under the old methods the "
        "spread of the runs alone), then what repeat tows show.",
    ),
    "claim_season_changes": ("Is 6 % snelheid 20-30 % in Cw?", "Is 6 % in speed 20-30 % in Cw?"),
    "claim_season_changes_note": (
        "De presentatie: de logs van 2009-2011 tot 6 % gecorrigeerd, 20-30 % in Cw. Hier Cw bij de "
        "opgegeven snelheid onder de gekozen methode gedeeld door die zoals gepubliceerd: de "
        "mediaan van het seizoen en de uitersten.",
        "The presentation: the logs of 2009-2011 corrected by up to 6 %, 20-30 % in Cw. Here Cw at "
        "the declared speed under the chosen method over that as published: the median of the "
        "season and the extremes.",
    ),
    "claim_print_summary": ("Komt de druk er weer uit?", "Does print come out again?"),
    "claim_print_summary_note": (
        "Gedrukte Cw gedeeld door de herrekende, per seizoen. Kijk hier eerst, voor er iets wordt "
        "herijkt: wat overblijft is onverklaard.",
        "Printed Cw divided by the recomputed one, per season. Look here before anything is "
        "re-based: what is left is unexplained.",
    ),
}

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
        "Een open teken is een proef die te langzaam of te snel was voor de standaardsnelheid. De "
        "lijn is de best passende rechte met een 95 %-interval; bij gewicht en lengte een per "
        "ploegklasse. Een proef die van het type afwijkt, is genoemd. Een streep is het "
        "95 %-interval van een proef; een streepjeslijn de spreiding van de runs alleen: de fout "
        "van de log zit er niet in.",
        "The methods stand side by side on equal axes. Circles are men, triangles women. An open "
        "mark is a tow too slow or too fast for the standard speed. The line is the straight line "
        "that fits best, with its 95 % interval; against weight and length one per crew class. A "
        "tow that is an outlier of its type is named. A bar is a tow's 95 % interval; a dashed "
        "one the spread of the runs alone: the log's error is not in it.",
    ),
    # Charts
    "men": ("heren", "men"),
    "women": ("dames", "women"),
    "crew_class": ("Ploeg", "Crew"),
    "crew": ("Ploeg", "Crew"),
    "waterline_length": ("Lengte waterlijn [m]", "Waterline length [m]"),
    "tow_hull_ratio": ("Sleepsnelheid / rompsnelheid", "Tow speed / hull speed"),
    "speed_case": ("Sleepsnelheid t.o.v. rompsnelheid", "Tow speed by hull speed"),
    "power": ("Vermogen bij slepen [W]", "Power when towed [W]"),
    "raced_power": ("Vermogen in wedstrijd [W]", "Power in the race [W]"),
    "power_ratio_raced": (
        "Vermogen in wedstrijd: eigen kromme / kromme van het type",
        "Race power: own curve / type's curve",
    ),
    "tows": ("Proeven", "Tows"),
    "newest_only": ("nieuwste per ploeg", "newest per crew"),
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
        "{type}: {verdict} onder {after}, R2 {r2_after} (onder {before} {r2_before}); {n} proeven "
        "van {boats} sloepen.",
        "{type}: {verdict} under {after}, R2 {r2_after} (under {before} {r2_before}); {n} tows of "
        "{boats} boats.",
    ),
    "slide.rises": ("{y} stijgt met {x}", "{y} rises with {x}"),
    "slide.falls": ("{y} daalt met {x}", "{y} falls with {x}"),
    "slide.none": ("geen verband van {y} met {x} gezien", "no link of {y} with {x} seen"),
    "slide.no_line": (
        "{type}: te weinig sloepen voor een lijn ({n} proeven van {boats} sloepen).",
        "{type}: too few boats for a line ({n} tows of {boats} boats).",
    ),
    "slide.x.weight": ("gewicht", "weight"),
    "slide.x.speed": ("sleepsnelheid", "tow speed"),
    "slide.x.length": ("lengte", "length"),
    "slide.outside": (
        "Uitschieters van hun type onder {after}: {names}.",
        "Outliers of their type under {after}: {names}.",
    ),
    "slide.b_is_not": (
        "Nee: onder {after} ligt B op {ratio} keer de rompsnelheid ({lo} tot {hi}; {boats} "
        "sloepen); {share} ligt er binnen 5 % van.",
        "No: under {after} B lies at {ratio} times hull speed ({lo} to {hi}; {boats} boats); "
        "{share} lie within 5 % of it.",
    ),
    "slide.b_is": (
        "Het kan: onder {after} ligt B op {ratio} keer de rompsnelheid ({lo} tot {hi}; {boats} "
        "sloepen).",
        "It may be: under {after} B lies at {ratio} times hull speed ({lo} to {hi}; {boats} "
        "boats).",
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
        "{n} proeven zijn met weinig vermogen gesleept of in een wedstrijd buiten hun kromme "
        "gebruikt; de eigen kromme geeft {up} te veel en {down} te weinig vermogen (interval "
        "zonder 1). Gesleept onder 70 W (dames 40) en geroeid boven 100 W (dames 57): {both}.",
        "{n} tows were made with little power or used off their curve in a race; their own curve "
        "gives {up} too much and {down} too little power (interval without 1). Towed under 70 W "
        "(women 40) and raced above 100 W (women 57): {both}.",
    ),
    "slide.years": (
        "{crew}: Cw bij {speed} m/s loopt over {n} proeven {before_spread} uiteen onder {before}, "
        "{after_spread} onder {after} (hoogste / laagste).",
        "{crew}: Cw at {speed} m/s spreads over {n} tows by {before_spread} under {before}, "
        "{after_spread} under {after} (highest / lowest).",
    ),
    "slide.apart": (
        "Proeven van {era} lagen onder {before} {before_shift} hoger dan de volgende van dezelfde "
        "sloep; onder {after} {after_shift}, {verdict}.",
        "Tows of {era} lay {before_shift} higher under {before} than the next of the same boat; "
        "under {after} {after_shift}, {verdict}.",
    ),
    "slide.is_apart": ("dat nog afwijkt", "which still differs"),
    "slide.not_apart": ("geen afwijking meer gezien", "no difference seen any more"),
    "decimal_mark": (",", "."),
    # Columns and codes
    "code.waterline_length_m": ("lengte waterlijn", "waterline length"),
    "column.a_lo_kg_m": ("A laagste [kg/m]", "A lowest [kg/m]"),
    "column.a_hi_kg_m": ("A hoogste [kg/m]", "A highest [kg/m]"),
    "column.b_hull_ratio": ("B / romp\u00adsnelheid", "B / hull speed"),
    "column.b_ratio": ("B / romp\u00adsnelheid", "B / hull speed"),
    "column.b_ratio_lo": ("Laagste", "Lowest"),
    "column.b_ratio_hi": ("Hoogste", "Highest"),
    "column.cw_standard_kg_m": (
        "Cw bij standaard\u00adsnelheid [kg/m]",
        "Cw at standard speed [kg/m]",
    ),
    "column.cw_standard_lo_kg_m": ("Laagste [kg/m]", "Lowest [kg/m]"),
    "column.cw_standard_hi_kg_m": ("Hoogste [kg/m]", "Highest [kg/m]"),
    "column.hull_speed_m_s": ("Romp\u00adsnelheid [m/s]", "Hull speed [m/s]"),
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
    "claim_print_summary": ("Komt de druk er weer uit?", "Does print come out again?"),
    "claim_print_summary_note": (
        "Gedrukte Cw gedeeld door de herrekende, per seizoen. Kijk hier eerst, voor er iets wordt "
        "herijkt: wat overblijft is onverklaard.",
        "Printed Cw over the recomputed, per season. Look here before anything is re-based: what "
        "is left is unexplained.",
    ),
}

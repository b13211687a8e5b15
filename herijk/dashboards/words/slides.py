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
        "lijn is de best passende rechte met haar 95 %-interval; bij gewicht en lengte een per "
        "ploegklasse. Een proef die buiten haar type valt, is genoemd. Een streep is het "
        "95 %-interval van een proef; een streepjeslijn de spreiding van de runs alleen: de fout "
        "van de log zit er niet in.",
        "The methods stand side by side on equal axes. Circles are men, triangles women. An open "
        "mark is a tow too slow or too fast for the standard speed. The line is the straight line "
        "that fits best, with its 95 % interval; against weight and length one per crew class. A "
        "tow outside its type is named. A bar is the 95 % interval of a tow; a dashed "
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
        "Do tows of an era stand apart from later ones?",
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
        "Buiten hun type onder {after}: {names}.",
        "Outside their type under {after}: {names}.",
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
        "70 %, zoals de presentatie zegt.",
        "Half of the tows lie above {ratio} of hull speed; {share} lie between 60 and 70 %, as the "
        "presentation says.",
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
    "slide.is_apart": ("dat nog afwijkt", "still apart"),
    "slide.not_apart": ("geen afwijking meer gezien", "no difference seen any more"),
    "decimal_mark": (",", "."),
}

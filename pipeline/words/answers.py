"""The owner's answer: its sentences. Braces are filled in by `dashboards.answer`."""

from typing import Final

ANSWERS: Final[dict[str, tuple[str, str]]] = {
    "crew_of": ("{rowers} roeiers, {people}", "{rowers} rowers, {people}"),
    "crew.H": ("heren", "men"),
    "crew.D": ("dames", "women"),
    "draft": ("concept", "draft"),
    "before_number": ("was", "was"),
    "after_number": ("wordt", "becomes"),
    "waterfall": (
        "Van het oude naar het nieuwe getal, Cw in kg/m",
        "From the old number to the new, Cw in kg/m",
    ),
    "answer_none": ("Geen geldig getal: {status}.", "No valid number: {status}."),
    "answer_number": ("Cw is {new} kg/m.", "Cw is {new} kg/m."),
    "answer_same": ("Cw blijft {new} kg/m.", "Cw stays {new} kg/m."),
    "answer_lower": (
        "Cw gaat van {old} naar {new} kg/m: {by} % lager.",
        "Cw goes from {old} to {new} kg/m: {by} % lower.",
    ),
    "answer_higher": (
        "Cw gaat van {old} naar {new} kg/m: {by} % hoger.",
        "Cw goes from {old} to {new} kg/m: {by} % higher.",
    ),
    "answer_compared": (
        "Vergeleken: \u201c{new}\u201d met \u201c{old}\u201d.",
        "Compared: \u201c{new}\u201d with \u201c{old}\u201d.",
    ),
    "answer_other_speed": (
        "De opgegeven snelheid is een andere: {new} in plaats van {old} m/s. Bij de oude snelheid "
        "verandert Cw {by}; daarover gaat wat volgt.",
        "The declared speed is another one: {new} instead of {old} m/s. At the old speed Cw "
        "changes by {by}; what follows is about that.",
    ),
    "answer_causes": ("Waardoor: {causes}.", "Why: {causes}."),
    "answer_slower": (
        "Voor hetzelfde vermogen mag de ploeg over een wedstrijd van twee uur {seconds} s langer "
        "doen.",
        "For the same power the crew may take {seconds} s longer over a race of two hours.",
    ),
    "answer_faster": (
        "Voor hetzelfde vermogen moet de ploeg een wedstrijd van twee uur {seconds} s sneller "
        "roeien.",
        "For the same power the crew has to row a race of two hours {seconds} s faster.",
    ),
    "answer_interval": (
        "Met 95 % zekerheid ligt Cw tussen {low} en {high} kg/m.",
        "With 95 % confidence Cw lies between {low} and {high} kg/m.",
    ),
    "answer_spread": (
        "De runs alleen al laten Cw tussen {low} en {high} kg/m; de fout van de log komt daar nog "
        "bij en is onder deze methode niet bekend.",
        "The scatter of the runs alone leaves Cw between {low} and {high} kg/m; the error of the "
        "log comes on top of that and is not known under this method.",
    ),
    "answer_best": (
        "De beste schatting uit alle proeven van het archief is {best} kg/m ({low} tot {high}); "
        "die rust voor {share} % op deze proef.",
        "The best estimate from all tows of the archive is {best} kg/m ({low} to {high}); {share} "
        "% of it rests on this tow.",
    ),
    "answer_moved": (
        "Tegenover de proef van {before} is Cw bij gelijke snelheid {moved}; volgens de beste "
        "schatting {kept}. Wat die twee scheelt, ligt eerder aan het meten dan aan de sloep.",
        "Against the tow of {before} Cw at equal speed is {moved}; by the best estimate {kept}. "
        "What differs between the two comes from measuring rather than from the boat.",
    ),
    "answer_log_low": (
        "De log wees in {season} {by} % te laag aan (95 %: {low} tot {high}); dat is verrekend.",
        "In {season} the log read {by} % too low (95 %: {low} to {high}); that is corrected.",
    ),
    "answer_log_high": (
        "De log wees in {season} {by} % te hoog aan (95 %: {low} tot {high}); dat is verrekend.",
        "In {season} the log read {by} % too high (95 %: {low} to {high}); that is corrected.",
    ),
    "answer_fault": (
        "In {season} is waarschijnlijk iets mis: {instrument}, {size} (kans {chance} %).",
        "In {season} something is probably wrong: {instrument}, {size} (chance {chance} %).",
    ),
    "answer_cannot_be_told": (
        "Of er in {season} iets mis was ({instrument}), is niet te zeggen (kans {chance} %).",
        "Whether something was wrong in {season} ({instrument}) cannot be told (chance "
        "{chance} %).",
    ),
    "answer_not_settled": (
        "De schatting van de fouten van de instrumenten kwam niet tot een eind. Wat over {season} "
        "is geschat, is niet betrouwbaar.",
        "The search for the errors of the instruments did not settle. What is estimated of "
        "{season} cannot be relied on.",
    ),
    "answer_alarm": (
        "In {season} wijkt een instrument sterk af van wat is aangenomen: {instrument}, {size}. "
        "Iemand moet ernaar kijken.",
        "In {season} an instrument lies far from what is assumed: {instrument}, {size}. A person "
        "should look.",
    ),
    "answer_exceeds": (
        "De verandering is groter dan de onzekerheid van beide getallen samen.",
        "The change is larger than the uncertainty of both numbers together.",
    ),
    "answer_within": (
        "De verandering valt binnen de onzekerheid van beide getallen samen.",
        "The change lies within the uncertainty of both numbers together.",
    ),
    "answer_exceeds_old": (
        "Beide getallen zijn van dezelfde proef; het nieuwe ligt buiten het interval van het oude.",
        "Both numbers come from the same tow; the new one lies outside the interval of the old.",
    ),
    "answer_within_old": (
        "Beide getallen zijn van dezelfde proef; het nieuwe ligt binnen het interval van het oude.",
        "Both numbers come from the same tow; the new one lies within the interval of the old.",
    ),
    "answer_unknown": (
        "Of de verandering groter is dan de onzekerheid, is niet te zeggen: van een van beide "
        "getallen is die niet bekend.",
        "Whether the change is larger than the uncertainty cannot be told: that of one of the "
        "numbers is not known.",
    ),
    "answer_old_spread": (
        "In de onzekerheid van het oude getal zit de fout van de log niet; die is dus te klein.",
        "The uncertainty of the old number leaves out the error of the log: it is too small.",
    ),
    "answer_place": (
        "Bij gelijk vermogen per roeier staat deze sloep naar snelheid op plaats {place} van "
        "{size} van het type {type} ({people}).",
        "At equal power per rower this boat ranks {place} of {size} of type {type} by speed "
        "({people}).",
    ),
    "answer_place_moved": (
        "Bij gelijk vermogen per roeier komt deze sloep naar snelheid op plaats {place} van {size} "
        "van het type {type} ({people}); dat was {old}.",
        "At equal power per rower this boat now ranks {place} of {size} of type {type} by speed "
        "({people}); it was {old}.",
    ),
    "answer_race": (
        "{race} {day}: plaats {new} van de {size} ploegen die in beide edities een plaats hebben, "
        "net als eerst.",
        "{race} {day}: place {new} of the {size} crews that both editions rank, as before.",
    ),
    "answer_race_none": (
        "{race} {day}: er zijn geen twee plaatsen te vergelijken ({why}).",
        "{race} {day}: there are no two places to compare ({why}).",
    ),
    "answer_race_moved": (
        "{race} {day}: plaats {new} van de {size} ploegen die in beide edities een plaats hebben; "
        "dat was {old}.",
        "{race} {day}: place {new} of the {size} crews that both editions rank; it was {old}.",
    ),
    "answer_valid": (
        "De proef van {tow} telt tot en met {until}.",
        "The tow of {tow} counts up to and including {until}.",
    ),
    "answer_expired": (
        "De proef van {tow} telde tot en met {until}.",
        "The tow of {tow} counted up to and including {until}.",
    ),
    "answer_next": (
        "Volgende proef: sleep bij {speed} m/s ({reason}).",
        "Next tow: at {speed} m/s ({reason}).",
    ),
    "answer_object": (
        "Klopt er iets niet? Meld het de commissie en noem {fsn_no}{code}. Hoe het getal tot stand "
        "kwam, staat hieronder.",
        "Is something wrong? Tell the committee, and name {fsn_no}{code}. How the number was made "
        "is shown below.",
    ),
    "answer_with_code": (" en controlecode {code}", " and verification code {code}"),
}

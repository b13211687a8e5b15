"""Texts of the documents that are printed: certificate and proposal."""

from typing import Final

DOCUMENTS: Final[dict[str, tuple[str, str]]] = {
    "certificate": ("Meetbrief", "Certificate"),
    "certificate_headline": ("Cw {cw} kg/m bij {speed} m/s", "Cw {cw} kg/m at {speed} m/s"),
    "certificate_no_interval": (
        "Hoe zeker dit getal is, is niet bekend.",
        "The uncertainty of this number is not known.",
    ),
    "certificate_draft": (
        "Concept: niet vastgesteld, en dus geen geldige meetbrief.",
        "Draft: not decided, and so no valid certificate.",
    ),
    "certificate_expired": (
        "Verlopen: deze meetbrief geldt niet meer.",
        "Expired: this certificate is no longer valid.",
    ),
    "certificate_power": ("Vermogen bij snelheid", "Power at speed"),
    "certificate_watts": ("W/roeier", "W/rower"),
    "certificate_tow": ("Sleepproef van", "Tow of"),
    "certificate_until": ("Geldig tot en met", "Valid until"),
    "unknown_word": ("niet bekend", "not known"),
    "certificate_reading": ("Zo leest u deze meetbrief", "How to read this certificate"),
    "certificate_read_cw": (
        "Cw is de sleepkracht gedeeld door de snelheid in het kwadraat. Hoe lager, hoe lichter de "
        "sloep loopt.",
        "Cw is the tow force divided by the speed squared. The lower, the easier the boat runs.",
    ),
    "certificate_read_curve": (
        "Cw = A / (1 - (v/B)²) geldt van 85 tot 115 % van de opgegeven snelheid.",
        "Cw = A / (1 - (v/B)²) holds from 85 to 115 % of the declared speed.",
    ),
    "certificate_read_power": (
        "Het vermogen is wat elke roeier bij die snelheid gemiddeld levert, in stil water en "
        "stille lucht.",
        "The power is what each rower gives on average at that speed, in still water and still "
        "air.",
    ),
    "certificate_checking": ("Zo controleert u hem", "How to check it"),
    "certificate_check": (
        "Zoek {fsn_no} in het register van editie {edition}: dezelfde controlecode {code} moet er "
        "staan, bij dezelfde getallen. De QR-code bevat editie, nummer, ploeg en controlecode. "
        "Klopt er iets niet, meld het de commissie.",
        "Look {fsn_no} up in the register of edition {edition}: the same verification code {code} "
        "must be there, with the same numbers. The QR code holds edition, number, crew and "
        "code. If something is wrong, tell the committee.",
    ),
    "certificate_uncheckable": (
        "Deze regel is niet gepubliceerd en heeft geen controlecode.",
        "This line is not published and has no verification code.",
    ),
    "proposal": ("Voorstel aan de leden", "Proposal to the members"),
    "proposal_title": ("Voorstel: {method}", "Proposal: {method}"),
    "proposal_ballot": ("Keuze uit: {method}", "Ballot: {method}"),
    "proposal_opening": (
        "Dit stuk laat zien wat er met het register gebeurt als alle sleepproeven met de "
        "voorgestelde methode worden gerekend, vergeleken met: {old}.",
        "This document shows what happens to the register if all tow tests are computed by the "
        "proposed method, compared with: {old}.",
    ),
    "proposal_why": (
        "Waarom: door de jaren is op verschillende manieren gemeten en gerekend. Alleen met één "
        "methode voor alle seizoenen zijn sloepen eerlijk te vergelijken. Wie wint of verliest, is "
        "geen reden voor of tegen een methode.",
        "Why: through the years measuring and computing was done in several ways. Only with one "
        "method for all seasons can boats be compared fairly. Who gains or loses is no reason for "
        "or against a method.",
    ),
    "proposal_side_by_side": ("De methoden naast elkaar", "The methods side by side"),
    "proposal_what": ("Wat er verandert: {method}", "What changes: {method}"),
    "proposal_mean": ("Gemiddeld effect op Cw", "Mean effect on Cw"),
    "proposal_types": ("Voor wie: per type", "For whom: by type"),
    "proposal_median": ("Cw, mediaan", "Cw, median"),
    "proposal_seconds": (
        "In 2 uur: seconden die een ploeg bij hetzelfde vermogen langer (+) mag doen over een "
        "wedstrijd van twee uur, of sneller (\u2212) moet zijn. Laatste kolom: hoeveel regels meer "
        "veranderen dan de onzekerheid.",
        "In 2 h: seconds that a crew may take longer (+) over a race of two hours at the same "
        "power, or has to be faster (\u2212). Last column: how many lines change by more than the "
        "uncertainty.",
    ),
    "proposal_boats": ("De grootste veranderingen", "The largest changes"),
    "proposal_old": ("Oud", "Old"),
    "proposal_new": ("Nieuw", "New"),
    "proposal_change": ("Verandering", "Change"),
    "proposal_races": ("De wedstrijden van {year}", "The races of {year}"),
    "proposal_moved": (
        "Van de {results} uitslagen van ploegen die op die dag in beide een geldige regel hebben, "
        "veranderen er {moved} van plaats. De winnaars van het laatste jaar:",
        "Of the {results} results of crews with a valid line on that day in both, {moved} change "
        "place. The winners of the last year:",
    ),
    "proposal_chance": ("Kans op een ander", "Chance of another"),
    "proposal_undecided": ("Wat open blijft", "What stays undecided"),
    "proposal_unknown": (
        "Regels waarvan niet te zeggen is of de verandering groter is dan de onzekerheid: "
        "{unknown}.",
        "Lines of which it cannot be told whether the change is larger than the uncertainty: "
        "{unknown}.",
    ),
    "proposal_known": (
        "Van elke regel is te zeggen of de verandering groter is dan de onzekerheid.",
        "Of every line it can be told whether the change is larger than the uncertainty.",
    ),
    "proposal_unsure": (
        "Regels met een waarschuwing waar de commissie nog naar moet kijken: {flagged} van de "
        "{lines}. Oude getallen hebben vaak een te kleine onzekerheid: de fout van de log zit er "
        "niet in.",
        "Lines with a flag that the committee still has to look at: {flagged} of {lines}. Old "
        "numbers often have too small an uncertainty: the error of the log is not in it.",
    ),
    "proposal_check": ("Controleren en bezwaar maken", "Checking, and objecting"),
    "proposal_checking": (
        "Elke sloep heeft een pagina op de site met oud en nieuw getal, de oorzaken, en daaronder "
        "de metingen. Klopt er iets niet, meld het de commissie vóór de stemming, met het "
        "FSN-nummer en wat u meent dat het moet zijn.",
        "Every boat has a page on the site with the old and new number, the causes, and the "
        "measurements below. If something is wrong, tell the committee before the vote, with the "
        "FSN number and what you think it should be.",
    ),
    "proposal_annex": (
        "Bijlage: het bestand van de methode (uitleg in het Engels)",
        "Annex: the file of the method",
    ),
}

"""Texts of the documents that are printed: certificate and proposal."""

from typing import Final

DOCUMENTS: Final[dict[str, tuple[str, str]]] = {
    "certificate": ("Meetbrief", "Certificate"),
    "certificate_headline": ("Cw {cw} kg/m bij {speed} m/s", "Cw {cw} kg/m at {speed} m/s"),
    "certificate_no_interval": (
        "Hoe zeker dit getal is, is niet bekend.",
        "How sure this number is, is not known.",
    ),
    "certificate_draft": (
        "Concept: niet vastgesteld, en dus geen geldige meetbrief.",
        "Draft: not decided, and so no valid certificate.",
    ),
    "certificate_power": ("Vermogen bij snelheid", "Power at speed"),
    "certificate_watts": ("W/roeier", "W/rower"),
    "certificate_tow": ("Sleepproef van", "Tow of"),
    "certificate_from": ("Geldig vanaf", "Valid from"),
    "certificate_until": ("Geldig tot en met", "Valid until"),
    "certificate_edition": ("Editie", "Edition"),
    "certificate_method": ("Methode", "Method"),
    "certificate_decision": ("Besluit", "Decision"),
    "certificate_thwart": ("Lege doft", "Empty thwart"),
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
        "must stand there, with the same numbers. The QR code holds edition, number, crew and "
        "code. If something is wrong, tell the committee.",
    ),
    "certificate_uncheckable": (
        "Deze regel is niet gepubliceerd en heeft geen controlecode.",
        "This line is not published and has no verification code.",
    ),
}

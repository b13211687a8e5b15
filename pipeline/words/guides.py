"""The documents of the project in short, as Markdown."""

from typing import Final

GUIDES_IN_SHORT: Final[dict[str, tuple[str, str]]] = {
    "method": (
        """Zo rekent de methode "herijkt"; de andere methoden laten stappen weg of doen ze anders.

- **Meten.** Een motorschip sleept de sloep naast zich, drie keer heen en drie keer terug, met
  90, 100 en 110 % van de opgegeven roeisnelheid. Trekkracht, snelheid en wind worden
  voortdurend gemeten.
- **Wat telt.** Van elke run telt het langste deel waarin snelheid, kracht en wind gelijkmatig
  zijn.
- **Snelheid.** De log meet de snelheid door het water. Met dGPS aan boord, vanaf 2014, wordt
  hij per proef geijkt. Voor eerdere seizoenen volgt uit sloepen die later nog eens gesleept
  zijn hoe ver de log ernaast zat.
- **Wind en temperatuur.** De kracht van de wind gaat eraf, die van stilstaande lucht komt
  erbij. De weerstand wordt omgerekend naar water van 15 °C.
- **Kromme.** Cw van een run is de kracht gedeeld door het kwadraat van de snelheid. Door de
  runs gaat de kromme Cw = A / (1 - (v/B)²). Zij geldt van 85 tot 115 % van de opgegeven
  snelheid.
- **Onzekerheid.** Bij elk getal hoort een interval van 95 %, waarin elke bekende fout zit:
  runs, log, krachtmeter, wind, temperatuur en kromme.
- **Register.** Voor elke sloep en ploeg telt de nieuwste proef die niet is afgekeurd.
""",
        """This is how the method "re-based" computes; the others leave steps out or do them
otherwise.

- **Measuring.** A motor ship tows the boat beside it, three times out and three times back, at
  90, 100 and 110 % of the declared speed. Tow force, speed and wind are measured all the time.
- **What counts.** Of each run the longest part counts in which speed, force and wind are level.
- **Speed.** The log measures speed through the water. With dGPS on board, from 2014 on, it is
  calibrated for every tow. For earlier seasons, boats that were towed again later show how far
  the log was off.
- **Wind and temperature.** The force of the wind is taken off, that of still air is put back.
  Resistance is brought to water of 15 °C.
- **Curve.** Cw of a run is the force divided by the speed squared. Through the runs goes the
  curve Cw = A / (1 - (v/B)²). It holds from 85 to 115 % of the declared speed.
- **Uncertainty.** Every number has a 95 % interval, which holds each known error: runs, log,
  load cell, wind, temperature and curve.
- **Register.** For each boat and crew the newest tow counts that is not rejected.
""",
    ),
    "audit": (
        """Een controle (`herijk audit`) laat zien waar de getallen van een sloep vandaan komen,
of dat gelijke sloepen gelijk behandeld worden.

- Bij elke uitspraak staat op hoeveel sloepen en proeven die rust. Meer proeven van één sloep
  zijn niet meer sloepen.
- Intervallen zijn 95 %. "Stijgt met" staat er alleen als het interval van de helling nul
  uitsluit. Geen verband gezien is geen bewijs dat er geen is: kijk hoe breed het interval is.
- Soms wordt niets beweerd, met de reden: te weinig sloepen, geen type, allemaal dezelfde waarde.
- Een uitschieter is een sloep die verder van zijn type ligt dan toeval verklaart. De oorzaken
  die erbij staan, zijn het nakijken waard; bewezen zijn ze niet.
""",
        """An audit (`herijk audit`) shows where a boat's numbers come from, or whether like
boats are treated alike.

- Each statement says on how many boats and tows it rests. Several tows of one boat are not
  several boats.
- Intervals are 95 %. "Rises with" is said only where the interval of the slope leaves out zero.
  No link seen is no proof that there is none: look how wide the interval is.
- Sometimes nothing is claimed, with the reason: too few boats, no type, all the same value.
- An outlier is a boat further from its type than chance explains. The causes named with it are
  worth a look; they are not proved.
""",
    ),
}

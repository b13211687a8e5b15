"""The command line in Dutch, by its English text."""

from typing import Final

COMMAND: Final[dict[str, str]] = {
    # Help: headings
    "Usage: ": "Gebruik: ",
    "Arguments": "Argumenten",
    "Options": "Opties",
    "Commands": "Opdrachten",
    "default": "standaard",
    "required": "verplicht",
    "env var": "omgevingsvariabele",
    "Begin": "Beginnen",
    "Look": "Bekijken",
    "Change the method": "De methode veranderen",
    "Publish": "Uitgeven",
    "Run it as a service, use it in programs": "Als dienst draaien, in programma's gebruiken",
    "More": "Meer",
    "Show this message and exit.": "Toon deze uitleg.",
    "Install completion for the current shell.": "Laat deze shell opdrachten aanvullen.",
    "Show completion for the current shell, to copy it or customize the installation.": (
        "Toon wat de shell laat aanvullen, om te kopiëren of aan te passen."
    ),
    "Print the version.": "Toon de versie.",
    "Language. Default: that of the system.": "Taal. Standaard: die van het systeem.",
    # Wrong arguments
    "Try '{} --help' for help.": "Uitleg geeft '{} --help'.",
    "Error: {}": "Fout: {}",
    "Missing option {}.": "Optie {} ontbreekt.",
    "Missing argument {}.": "Argument {} ontbreekt.",
    "Missing command.": "Noem een opdracht.",
    "No such option: {} (Possible options: {})": "Er is geen optie {}. Bedoelt u {}?",
    "No such command {}. Did you mean {}?": "Er is geen opdracht {}. Bedoelt u {}?",
    "No such option: {}": "Er is geen optie {}",
    "No such command {}.": "Er is geen opdracht {}.",
    "Got unexpected extra argument(s) ({})": "Te veel argumenten ({})",
    "Option {} requires an argument.": "Optie {} vraagt een waarde.",
    "Invalid value for {}: {}": "Ongeldige waarde voor {}: {}",
    "Invalid value: {}": "Ongeldige waarde: {}",
    "{} is not one of {}.": "{} is niet een van {}.",
    "write a season, 2014, or a range, 2009:2018": (
        "schrijf een seizoen, 2014, of een reeks, 2009:2018"
    ),
    "write a day as 2026-05-08": "schrijf een dag als 2026-05-08",
    "give a boat, or one or two types; quote a name with blanks": (
        "geef een sloep, of een of twee types; zet een naam met spaties tussen aanhalingstekens"
    ),
    "give one or two types": "geef een of twee types",
    "name the folder to make": "noem de map die gemaakt moet worden",
    "give --method NAME, or --printed YEAR, and not both": (
        "geef --method NAAM of --printed JAAR, en niet allebei"
    ),
    "--carry goes with --method": "--carry hoort bij --method",
    "{!r} has no --json; these have: {}": "{!r} heeft geen --json; wel: {}",
    # Help: commands
    "Recomputes the history of the Dutch rowing-sloop register from its tow tests.": (
        "Herberekent de geschiedenis van het sloepenregister uit de sleepproeven."
    ),
    "An empty archive with examples, spreadsheets to fill in, and a page that explains it.": (
        "Een leeg archief met voorbeelden, rekenbladen om in te vullen en een pagina met uitleg."
    ),
    "Every fault of lists, headers and a sample of the data, by cause, before any rebuild.": (
        "Elke fout in lijsten, koppen en een deel van de metingen, per oorzaak, nog voor "
        "een herberekening."
    ),
    "From the archive to registers and tables; only what changed is done again.": (
        "Van het archief naar registers en tabellen; alleen wat veranderd is wordt opnieuw gedaan."
    ),
    "Write a simulated archive with known truth (the truth lies beside it, not in it).": (
        "Schrijf een gesimuleerd archief met bekende waarheid (die ligt ernaast, niet erin)."
    ),
    "Check that machine, settings, data folder and archive are in order.": (
        "Kijk of computer, instellingen, datamap en archief in orde zijn."
    ),
    "Where a boat's numbers come from, step by step; or whether boats of a type are equal.": (
        "Waar de getallen van een sloep vandaan komen, stap voor stap; of zijn sloepen van "
        "een type gelijk?"
    ),
    "The register: every line with its sizes, and whether it is valid on a day.": (
        "Het register: elke regel met de maten, en of hij op een dag geldig is."
    ),
    "Whose tow expires when, at what speed to tow each next, and which boats to tow again.": (
        "Wiens proef wanneer verloopt, bij welke snelheid elke sloep daarna te slepen, en "
        "welke opnieuw."
    ),
    "All pages of the site in a folder of their own, for instance as of an earlier day.": (
        "Alle pagina's van de site in een eigen map, bijvoorbeeld zoals ze op een eerdere "
        "dag waren."
    ),
    "How wrong the speed log was in each season, with its uncertainty and what it rests on.": (
        "Hoe ver de log er in elk seizoen naast zat, hoe zeker dat is en waar het op rust."
    ),
    "Every chart of the 2015 presentation over this archive, as SVG and PNG and in one PDF.": (
        "Elke grafiek van de presentatie van 2015 over dit archief, als SVG en PNG en in een PDF."
    ),
    "A curve with its interval from speeds and forces; B only where the points determine it.": (
        "Een kromme met interval uit snelheden en krachten; B alleen waar de punten hem bepalen."
    ),
    "Change a method's options in a browser and see at once what happens to all boats.": (
        "Verander opties van een methode in een browser en zie meteen wat er met alle "
        "sloepen gebeurt."
    ),
    "The methods: those that ship, and your own.": "De methoden: de meegeleverde en die van uzelf.",
    "List the methods: those that ship, and those in the folder `methods` of --data.": (
        "Noem de methoden: de meegeleverde, en die in de map `methods` van --data."
    ),
    "One method in words, with what differs from the one it extends.": (
        "Een methode in woorden, met wat verschilt van de methode waarop die voortbouwt."
    ),
    "Read a method file and say in words what it does; an error is told with its line.": (
        "Lees een methodebestand en zeg in woorden wat het doet; bij een fout staat de regel."
    ),
    "Begin a method file NAME.toml here, which extends another; every option is listed in it.": (
        "Begin hier een methodebestand NAAM.toml dat op een ander voortbouwt; elke optie "
        "staat erin."
    ),
    "Which options differ between two methods, and what that does to Cw where --data has tows.": (
        "Welke opties tussen twee methoden verschillen, en wat dat met Cw doet als --data "
        "proeven heeft."
    ),
    "All of history under a method: what changes and why. Nothing is published or stored.": (
        "De hele geschiedenis volgens een methode: wat verandert er en waardoor. Er wordt "
        "niets uitgegeven of bewaard."
    ),
    "What a board sends its members before they vote: what changes, for whom, how uncertain.": (
        "Wat een bestuur zijn leden stuurt vóór de stemming: wat verandert er, voor wie, "
        "hoe zeker is het."
    ),
    "Freeze an edition of the register: it is never changed afterwards.": (
        "Geef een editie van het register uit, die daarna nooit meer verandert."
    ),
    "Two editions side by side: who gains, who loses, why, and what it does to races.": (
        "Twee edities naast elkaar: wie wint, wie verliest, waardoor, en wat het met "
        "wedstrijden doet."
    ),
    "Check that editions and archive are what they were, and make the editions again.": (
        "Controleer dat edities en archief zijn wat ze waren, en maak de edities opnieuw."
    ),
    "From a printed line to the files, runs and seconds behind it.": (
        "Van een gedrukte regel naar de bestanden, runs en seconden waar hij op rust."
    ),
    "The certificate of a boat, a page per crew; or of all boats of an edition in one file.": (
        "De meetbrief van een sloep, een pagina per ploeg; of die van alle sloepen van een "
        "editie in een bestand."
    ),
    "Rebuild by itself: schedules and sensor, with Dagster's page and the site, until stopped.": (
        "Herbereken vanzelf: volgens schema of bij nieuwe bestanden, met de pagina van "
        "Dagster en de site, tot u stopt."
    ),
    "What --json of a command prints, as JSON Schema; without a command, of which there is one.": (
        "Wat --json van een opdracht geeft, als JSON Schema; zonder opdracht: van welke er een is."
    ),
    # Help: arguments and options
    "The archive folder.": "De map van het archief.",
    "The archive folder, if any.": "De map van het archief, als die er is.",
    "Folder with everything Herijk writes.": "Map met alles wat Herijk schrijft.",
    "Print the result as JSON.": "Geef de uitkomst als JSON.",
    "Judge on this day, as if nothing later were known; without: on the day of the "
    "archive's last tow or race.": (
        "Beoordeel op deze dag, alsof van later niets bekend is; anders op de dag van de "
        "laatste proef of wedstrijd van het archief."
    ),
    "Folder to make.": "Map die gemaakt wordt.",
    "Method to add to those of the data folder, or to renew; repeat for more. A file is kept "
    "there. Default: those that beheer.toml lists, or all that ship.": (
        "Methode die erbij komt of opnieuw wordt toegepast; herhaal voor meer. Een bestand wordt "
        "in de datamap bewaard. Standaard: die in beheer.toml staan, of alle meegeleverde."
    ),
    "Read these seasons only.": "Lees alleen deze seizoenen.",
    "Seasons, both ends included.": "Seizoenen, eerste en laatste meegerekend.",
    "Address to listen on.": "Adres om op te luisteren.",
    "Port of Dagster's page; the site has the next.": (
        "Poort van de pagina van Dagster; de site heeft de volgende."
    ),
    "Let Dagster's page start rebuilds and switch schedules.": (
        "Laat de pagina van Dagster herberekeningen starten en schema's omzetten."
    ),
    "A method's name, or a TOML file.": "Naam van een methode, of een TOML-bestand.",
    "The method it is compared with.": "De methode waarmee vergeleken wordt.",
    "Edition, method or file it is compared with.": (
        "Editie, methode of bestand waarmee vergeleken wordt."
    ),
    'A boat by number or name, FSN211 or "Razende Snol", or one or two types.': (
        'Een sloep met nummer of naam, FSN211 of "Razende Snol", of een of twee types.'
    ),
    "Show this method only.": "Toon alleen deze methode.",
    "Which tows a type's statistics rest on.": "Op welke proeven de statistiek van een type rust.",
    "Folder for the plots. Default: audit/NAME in --data.": (
        "Map voor de figuren. Standaard: audit/NAAM in --data."
    ),
    "Folder for them. Default: slides in --data.": "Map ervoor. Standaard: slides in --data.",
    "Folder for them, new or of pages.": "Map ervoor: nieuw, of met pagina's.",
    "Type of boat; repeat for two together.": "Type sloep; herhaal voor twee samen.",
    "Which tows are drawn.": "Welke proeven getekend worden.",
    "Boat through the years, by number or name; repeat for more.": (
        "Sloep door de jaren, met nummer of naam; herhaal voor meer."
    ),
    "Port on this machine; 0 for any that is free.": (
        "Poort op deze computer; 0 voor een die vrij is."
    ),
    "Method whose factors are shown.": "Methode waarvan de factoren getoond worden.",
    "Tows in each.": "Proeven in elk seizoen.",
    "Samples per second.": "Metingen per seconde.",
    "Decides all that is drawn.": "Bepaalt alles wat geloot wordt.",
    "What is wrong in it; see --worlds.": "Wat er mis in is; zie --worlds.",
    "List the worlds, and stop.": "Noem de werelden, en stop.",
    "A command, such as: due.": "Een opdracht, bijvoorbeeld: due.",
    "By number or name; all of the edition without.": "Op nummer of naam; zonder: alle.",
    "By number or name.": "Op nummer of naam.",
    "Edition; the newest when left out.": "Editie; de nieuwste als u niets geeft.",
    "Name of an edition.": "Naam van een editie.",
    "The seal of the last edition, from the minutes.": (
        "Het zegel van de laatste editie, uit de notulen."
    ),
    "The old edition.": "De oude editie.",
    "The new edition.": "De nieuwe editie.",
    "File to write: a PDF, or .html for a page.": (
        "Te schrijven bestand: een PDF, of .html voor een pagina."
    ),
    "File to write, a PDF.": "Te schrijven bestand, een PDF.",
    "Method proposed; several make a ballot.": (
        "Voorgestelde methode; meer dan een geeft een stembiljet."
    ),
    "Edition that counts now, or a draft.": "Editie die nu geldt, of een concept.",
    "Name of the new edition, for example 2026-1.": (
        "Naam van de nieuwe editie, bijvoorbeeld 2026-1."
    ),
    "Day from which it counts: 2026-05-08.": "Dag waarop de editie ingaat: 2026-05-08.",
    "Who decided it, and where.": "Wie het besloot, en waar.",
    "Method that the last rebuild applied.": (
        "Methode die bij de laatste herberekening is toegepast."
    ),
    "Instead of a method: the register printed that year.": (
        "In plaats van een methode: het register dat in dat jaar gedrukt is."
    ),
    "Printed edition whose lines are re-based for boats without measurements.": (
        "Gedrukte editie waarvan de regels worden omgerekend voor sloepen zonder metingen."
    ),
    "Day of publication; else today.": "Dag van uitgave; anders vandaag.",
    "Fatigue correction of races: none, known (2 to 3 h only) or extend.": (
        "Uitputtingscorrectie in wedstrijden: none, known (alleen 2 tot 3 uur) of extend."
    ),
    "Method whose curves give the speeds.": ("Methode waarvan de krommen de snelheden geven."),
    "Name of the new method, for example ours-2027.": (
        "Naam van de nieuwe methode, bijvoorbeeld ours-2027."
    ),
    "Method that it begins from.": "Methode om van uit te gaan.",
    "Table with a header: speeds, forces or Cw.": "Tabel met een kop: snelheden, krachten of Cw.",
    "Column of speeds.": "Kolom met snelheden.",
    "Column of forces.": "Kolom met krachten.",
    "Write the picture here, as SVG.": "Schrijf de figuur hierheen, als SVG.",
    # Simulated worlds
    "Instruments and weather of each season, and nothing else wrong.": (
        "Instrumenten en weer van elk seizoen, en verder niets mis."
    ),
    "Everything that is known to have gone wrong.": "Alles wat voor zover bekend misgegaan is.",
    "A quarter of the tows has its runs back in a second file, with a log 2 % off the first.": (
        "Een kwart van de proeven heeft de runs terug in een tweede bestand, met een log "
        "die 2 % van de eerste afwijkt."
    ),
    "A quarter of the tows is pulled askew until 2013, 5 to 10 %, some 40 %.": (
        "Een kwart van de proeven is tot 2013 scheef getrokken, 5 tot 10 %, sommige 40 %."
    ),
    "A third of the tows is done at 75 to 90 % of the usual speed.": (
        "Een derde van de proeven is bij 75 tot 90 % van de gewone snelheid gedaan."
    ),
    "A tide of 0.3 m/s turns during every tow.": (
        "Een getij van 0,3 m/s kentert tijdens elke proef."
    ),
    "Boats of a type are identical, of Delft shape.": (
        "Sloepen van een type zijn gelijk, met de weerstand van de Delftse serie."
    ),
    "Boats of a type are identical.": "Sloepen van een type zijn gelijk.",
    "Freeboards from 2017 on, and a tenth of the tows with a thwart left free.": (
        "Vrijboorden vanaf 2017, en een tiende van de proeven met een lege doft."
    ),
    "Hulls have a marked hump near hull speed.": (
        "Rompen hebben een duidelijke bult bij de rompsnelheid."
    ),
    "Hulls have the resistance of the Delft series.": (
        "Rompen hebben de weerstand van de Delftse serie."
    ),
    "In 2 % of runs each: log 1 drops to 0, the load cell gives no number, or peaks.": (
        "In telkens 2 % van de runs: log 1 valt naar 0, de krachtmeter geeft geen getal, of piekt."
    ),
    "In mid-season of 2010 the log is replaced by one 4 % off; nobody writes it down.": (
        "Midden in seizoen 2010 komt er een log die 4 % afwijkt; niemand schrijft het op."
    ),
    "Logs foul by 4 % from the first day of a season to the last, until 2013.": (
        "Logs vervuilen tot 2013 met 4 % van de eerste tot de laatste dag van een seizoen."
    ),
    "Logs vary 1.2 % between tows, 12 % of boats are altered unreported, boats age.": (
        "Logs schommelen 1,2 % tussen proeven, 12 % van de sloepen is verbouwd zonder het "
        "te melden, sloepen verouderen."
    ),
    "None of the boats of 2010 is towed in another season.": (
        "Geen sloep van 2010 is in een ander seizoen gesleept."
    ),
    "Of the boats of 2010 only three are also towed in other seasons.": (
        "Van de sloepen van 2010 zijn er maar drie ook in andere seizoenen gesleept."
    ),
    "The anemometer reads 0.7 of the wind in 2012.": (
        "De windmeter wijst in 2012 0,7 van de wind aan."
    ),
    "The anemometer reads 0.8 of the wind, always.": (
        "De windmeter wijst altijd 0,8 van de wind aan."
    ),
    "The dGPS lags 4 s from 2014 on.": "De dGPS loopt vanaf 2014 4 s achter.",
    "The dGPS reads 1 % too much in 2016.": "De dGPS wijst in 2016 1 % te veel aan.",
    "The helmsman holds the speed that log 1 reads: a log that reads low makes him go faster.": (
        "De stuurman houdt de snelheid van log 1 aan: wijst die te weinig aan, dan vaart "
        "hij harder."
    ),
    "The load cell reads 10 N without force in 2016.": (
        "De krachtmeter wijst in 2016 zonder kracht 10 N aan."
    ),
    "The load cell reads 4 % too much in 2010.": "De krachtmeter wijst in 2010 4 % te veel aan.",
    "The load cell reads 4 % too much in 2016.": "De krachtmeter wijst in 2016 4 % te veel aan.",
    "The vane points 15 degrees off, always.": "De windvaan staat altijd 15 graden verdraaid.",
    "The whole fleet has 3 % less resistance from 2014 on.": (
        "De hele vloot heeft vanaf 2014 3 % minder weerstand."
    ),
    "The zero of the load cell drifts from -12 to 12 N within 2016.": (
        "Het nulpunt van de krachtmeter loopt in 2016 van -12 naar 12 N."
    ),
    "Until 2013 temperatures are not written down, while the water warms from 4 to 12 C.": (
        "Tot 2013 is de watertemperatuur niet genoteerd, terwijl het water van 4 naar 12 C gaat."
    ),
    "Simulated archive: {archive}\nIts truth: {truth}": (
        "Gesimuleerd archief: {archive}\nDe waarheid ervan: {truth}"
    ),
    "SIMULATED archive: made by `herijk simulate`, not the federation's measurements.": (
        "GESIMULEERD archief: gemaakt met `herijk simulate`, geen metingen van de federatie."
    ),
    # Check, init, doctor, pages, workbench, serve
    "Nothing is wrong in the lists and headers of {} tows.": (
        "Er is niets mis in de lijsten en kopregels van {} sleepproeven."
    ),
    "Causes: {}; places: {}. As it is, {} tows are left for a rebuild to judge.": (
        "Oorzaken: {}; plaatsen: {}. Zoals het nu is blijven {} sleepproeven over, die bij het "
        "herbouwen worden beoordeeld."
    ),
    "An empty archive is in {}; begin with LEESMIJ.md.": (
        "Een leeg archief staat in {}; begin met LEESMIJ.md."
    ),
    "There is also: {}": "Er staat ook: {}",
    "and {} more": "en nog {}",
    " and {} more": " en nog {}",
    "  and {} more: see the table quarantine": "  en nog {}: zie de tabel quarantine",
    ", line {}": ", regel {}",
    " (tow {})": " (proef {})",
    "tow {}: {}": "proef {}: {}",
    "ok": "goed",
    "WRONG": "FOUT",
    "disk": "schijf",
    "settings": "instellingen",
    "lock": "slot",
    "tables": "tabellen",
    "free": "vrij",
    "data folder": "datamap",
    "archive": "archief",
    "applies {}": "past {} toe",
    "method {}": "methode {}",
    "{} is not there yet; a rebuild makes it": "{} is er nog niet; een herberekening maakt het",
    "{} is not a folder": "{} is geen map",
    "{:.1f} GB free at {}": "{:.1f} GB vrij in {}",
    "{} tows in {} seasons": "{} proeven in {} seizoenen",
    "{} files in {}; begin with index.html": "{} bestanden in {}; begin met index.html",
    "The workbench is at {} (on this machine only); Ctrl-C stops it.": (
        "De werkbank staat op {} (alleen op deze computer); Ctrl-C sluit af."
    ),
    "WARNING: everybody who can reach {host} can read the site and Dagster's page: there "
    "is no password. Put a proxy with one in front (docs/security.md), or serve on "
    "127.0.0.1": (
        "WAARSCHUWING: wie {host} kan bereiken, kan de site en de pagina van Dagster "
        "lezen: er is geen wachtwoord. Zet er een proxy met wachtwoord voor "
        "(docs/security.md), of gebruik 127.0.0.1"
    ),
    "no plots, for {} cannot be written ({}); give another folder with --plots": (
        "geen figuren, want {} is niet te beschrijven ({}); geef een andere map met --plots"
    ),
    # Rebuild
    "tows, {task.fields[set_aside]} set aside,": "proeven, {task.fields[set_aside]} terzijde,",
    "left": "te gaan",
    "making the site": "de site maken",
    "checking the tables": "de tabellen controleren",
    "looking at what the archive holds": "kijken wat het archief bevat",
    "Nothing changed: no file was read again, all tables are up to date.": (
        "Er is niets veranderd: geen bestand is opnieuw gelezen, alle tabellen zijn bij."
    ),
    "Seasons read: {}. Methods applied: {}.": "Gelezen seizoenen: {}. Toegepaste methoden: {}.",
    "none": "geen",
    "Since the last report:\n": "Sinds het vorige verslag:\n",
    "Tows accepted: ": "Opgenomen proeven: ",
    "Set aside:\n": "Terzijde gelegd:\n",
    "Set aside: nothing.": "Terzijde gelegd: niets.",
    "Curves:\n": "Krommen:\n",
    "Tables: {}\nSite: {}\nReport: {}": "Tabellen: {}\nSite: {}\nVerslag: {}",
    "Change of Cw at the declared speed against {}:\n": (
        "Verandering van Cw bij de opgegeven snelheid tegenover {}:\n"
    ),
    "Biggest changes against {}:\n": "Grootste veranderingen tegenover {}:\n",
    # Heads of tables
    "A old": "A oud",
    "B old": "B oud",
    "Cw old": "Cw oud",
    "W old": "W oud",
    "new": "nieuw",
    "old W": "W oud",
    "new W": "W nieuw",
    "old rank": "oude plaats",
    "new rank": "nieuwe plaats",
    "rank": "plaats",
    "old winner": "oude winnaar",
    "new winner": "nieuwe winnaar",
    "chance that another wins": "kans dat een ander wint",
    "all types": "alle types",
    "all types, %": "alle types, %",
    "beam m": "breedte m",
    "length m": "lengte m",
    "bow m": "boeg m",
    "boat": "sloep",
    "name": "naam",
    "crew": "ploeg",
    "cause": "oorzaak",
    "causes": "oorzaken",
    "chance": "kans",
    "change": "verandering",
    "class": "klasse",
    "classes": "klassen",
    "counts": "telt",
    "curve": "kromme",
    "cut because": "geknipt om",
    "day": "dag",
    "declared": "opgegeven",
    "edition": "editie",
    "empty thwart": "lege doft",
    "equal": "gelijk",
    "from": "van",
    "to": "tot",
    "gross kg/m": "bruto kg/m",
    "highest": "hoogste",
    "lowest": "laagste",
    "median": "mediaan",
    "in 1 %": "binnen 1 %",
    "in 2 %": "binnen 2 %",
    "in 2 h": "in 2 uur",
    "in 2 h at equal power": "in 2 uur bij gelijk vermogen",
    "in part": "deels",
    "kind": "soort",
    "last tow": "laatste proef",
    "lines": "regels",
    "links": "koppelingen",
    "lost": "verloren",
    "made again": "opnieuw gemaakt",
    "method": "methode",
    "new / old Cw, %": "Cw nieuw / oud, %",
    "number": "aantal",
    "older tow": "oudste proef",
    "option": "optie",
    "or else": "of anders",
    "own B spread": "spreiding eigen B",
    "pairs": "paren",
    "part": "deel",
    "race": "wedstrijd",
    "raced": "geroeid",
    "reason": "reden",
    "season": "seizoen",
    "seasons": "seizoenen",
    "seconds": "seconden",
    "shared B": "gedeelde B",
    "size": "grootte",
    "source": "bron",
    "step is of": "stap komt van",
    "title": "titel",
    "total": "totaal",
    "tow": "proef",
    "tow at m/s": "slepen bij m/s",
    "towed in": "gesleept in",
    "tows": "proeven",
    "uncertainty then": "onzekerheid dan",
    "valid until": "geldig tot",
    "verdict": "oordeel",
    "what": "wat",
    "where": "waar",
    "why": "waarom",
    "window s": "venster s",
    "speed": "snelheid",
    "-inertia": "-traagheid",
    "-air": "-lucht",
    "+still": "+stil",
    "spread": "spreiding",
    "explained": "verklaard",
    "slope": "helling",
    "within": "binnen",
    "outside": "erbuiten",
    "yes": "ja",
    "no": "nee",
    "notice": "let op",
    "changes": "wisselt",
    "the same": "dezelfde",
    "gone": "weg",
    "as printed": "zoals gedrukt",
    "removed: {}": "vervallen: {}",
    "no: {}": "nee: {}",
    # Register, publish, diff, verify, lineage
    "{} lines need a look; they are marked in the register. Look at each with herijk "
    "audit, and write what you decide in besluiten.toml:": (
        "{} regels vragen om een blik; ze zijn in het register gemerkt. Bekijk elk met "
        "herijk audit, en schrijf wat u besluit in besluiten.toml:"
    ),
    "no numbers: the archive rules its tows out (see doubts in the table tows)": (
        "geen getallen: het archief sluit de proeven uit (zie doubts in de tabel tows)"
    ),
    "Register {}, validity judged on {}: {}.": "Register {}, geldigheid op {}: {}.",
    "Compared with {}: herijk diff {} {}": "Vergeleken met {}: herijk diff {} {}",
    "There is no earlier edition to compare it with.": (
        "Er is geen eerdere editie om mee te vergelijken."
    ),
    "Published {}: {} lines ({}), method {}, valid from {}.": (
        "Uitgegeven {}: {} regels ({}), methode {}, geldig vanaf {}."
    ),
    "Decision: {}": "Besluit: {}",
    "Seal, to be kept in the minutes: {}": "Zegel, te bewaren in de notulen: {}",
    "Folder: {}": "Map: {}",
    "  register.xlsx, register.csv        the register": (
        "  register.xlsx, register.csv        het register"
    ),
    "  bericht.md, notice.md              one page for the members, Dutch and English": (
        "  bericht.md, notice.md              een pagina voor de leden, Nederlands en Engels"
    ),
    "  toelichting.md, release_notes.md   release notes, Dutch and English": (
        "  toelichting.md, release_notes.md   toelichting, Nederlands en Engels"
    ),
    "It is never changed. To see that it stays so: herijk verify": (
        "Zij verandert nooit meer. Dat controleert u met: herijk verify"
    ),
    "no lines": "geen regels",
    "Gain (more power for the same race): {}\nLose: {}\nLarger than the uncertainty: {}; "
    "uncertainty not known for {}.": (
        "Winst (meer vermogen in dezelfde wedstrijd): {}\nVerlies: {}\nGroter dan de "
        "onzekerheid: {}; onzekerheid niet bekend bij {}."
    ),
    "The interval of {} is the spread of the runs alone: the log's error is not in it.": (
        "Het interval van {} is alleen de spreiding van de runs: de fout van de log zit er niet in."
    ),
    "Causes, with their factor on Cw:\n": "Oorzaken, met hun factor op Cw:\n",
    "Every line: A and Cw in kg/m, B in m/s, W per rower at the old declared speed, "
    "seconds that the new register gives in\na two-hour race, rank at equal power among "
    "all boats of the class:\n": (
        "Elke regel: A en Cw in kg/m, B in m/s, W per roeier bij de oude opgegeven "
        "snelheid, seconden die het nieuwe register geeft\nin een wedstrijd van twee uur, "
        "plaats bij gelijk vermogen onder alle sloepen van de klasse:\n"
    ),
    "{} lines, median {}, {} in two hours": "{} regels, mediaan {}, {} in twee uur",
    "Races: the archive holds none.": "Wedstrijden: het archief heeft er geen.",
    "Races, not corrected for fatigue: ": "Wedstrijden, zonder uitputtingscorrectie: ",
    "Races, corrected for fatigue as published: ": (
        "Wedstrijden, met de uitputtingscorrectie zoals gepubliceerd: "
    ),
    "Races, corrected for fatigue (beyond 2 to 3 hours by the same power law, inferred): ": (
        "Wedstrijden, met uitputtingscorrectie (buiten 2 tot 3 uur met dezelfde machtswet, een "
        "aanname): "
    ),
    "{}{} results, {} of them ranked by both editions: {} change rank among those, "
    "{} on or off the podium.": (
        "{}{} uitslagen, waarvan {} met een plaats in beide edities: {} daarvan krijgen een andere "
        "plaats, {} komen op of van het podium."
    ),
    "Winners:\n{}": "Winnaars:\n{}",
    "Ranks that change:\n{}": "Plaatsen die veranderen:\n{}",
    "  The chance: in how many of the equally likely new registers the old winner loses.": (
        "  De kans: in welk deel van de even waarschijnlijke nieuwe registers de oude "
        "winnaar verliest."
    ),
    "not known": "niet bekend",
    "No edition has been published yet; nothing to verify.": (
        "Er is nog geen editie uitgegeven; er is niets te controleren."
    ),
    "{}\nMade again: measured lines from the samples files of the archive, carried lines from "
    "the printed edition,\nprinted lines from the register in the archive.": (
        "{}\nOpnieuw gemaakt: gemeten regels uit de meetbestanden van het archief, overgenomen "
        "regels uit de gedrukte editie,\ngedrukte regels uit het register in het archief."
    ),
    "Head: {}\nThe seal of the last edition. Keep it, for example in the minutes: whoever "
    "has it can tell later whether\nany edition was made anew.": (
        "Laatste zegel: {}\nHet zegel van de laatste editie. Bewaar het, bijvoorbeeld in "
        "de notulen: wie het heeft kan later zien of\neen editie opnieuw gemaakt is."
    ),
    "{} of these come out otherwise: either the code changed since, or the edition did. The "
    "head decides: compare\nit with the minutes, or give it with --head.": (
        "{} hiervan komen anders uit: of het programma is sindsdien veranderd, of de editie. Het "
        "laatste zegel beslist:\nvergelijk het met de notulen, of geef het op met --head."
    ),
    "{} {} wrong.": "{} {} mis.",
    "thing is": "ding is",
    "things are": "dingen zijn",
    "Nothing was altered. The code of today makes {} of these otherwise; what was "
    "published stands.": (
        "Er is niets veranderd. Het programma van vandaag maakt er {} anders; wat "
        "uitgegeven is, blijft gelden."
    ),
    "Everything is as it was published.": "Alles is zoals het uitgegeven is.",
    "Edition {}, valid from {}, method {} ({}), code {}. Decision: {}": (
        "Editie {}, geldig vanaf {}, methode {} ({}), programma {}. Besluit: {}"
    ),
    "Verification code {}\n  {}": "Controlecode {}\n  {}",
    "  No tow of the archive is behind this line.": (
        "  Achter deze regel staat geen proef van het archief."
    ),
    "  Tow {} of {}, from\n{}": "  Proef {} van {}, uit\n{}",
    # Due
    "Due list as of {}{}; curves of method {}. {} boats and crews: {} expired, {} expire "
    "this year, {} without a curve.": (
        "Sleeplijst per {}{}; krommen volgens methode {}. {} sloepen en ploegen: {} "
        "verlopen, {} verlopen dit jaar, {} zonder kromme."
    ),
    ", the day of the last tow or race": ", de dag van de laatste proef of wedstrijd",
    "Expired: does not count any more": "Verlopen: telt niet meer",
    "Expires at the end of this year: tow before the next season": (
        "Verloopt eind dit jaar: slepen voor het volgende seizoen"
    ),
    "Without a curve: never towed, or no tow gave one": (
        "Zonder kromme: nooit gesleept, of geen proef gaf er een"
    ),
    "Later": "Later",
    "The speed takes 70-90 W per rower (men) or 40-55 W (women) on the known curve. A boat "
    "that was altered\nsince may be towed at another one. * lies outside 85-115 % of the "
    "last declared speed, where its curve does not hold.": (
        "De snelheid vraagt op de bekende kromme 70-90 W per roeier (heren) of 40-55 W "
        "(dames). Een sloep die sindsdien\nverbouwd is mag bij een andere gesleept worden. "
        "* ligt buiten 85-115 % van de laatst opgegeven snelheid, waar de kromme niet "
        "geldt."
    ),
    "To narrow the season factors most, tow these again, in this order": (
        "Sleep deze opnieuw, in deze volgorde, om de seizoensfactoren het scherpst te krijgen"
    ),
    "{}: nobody, this method estimates no log error, so no tow would narrow it.": (
        "{}: niemand, deze methode schat geen logfout, dus geen proef maakt die scherper."
    ),
    "{}.\nAll of them together bring the uncertainty of a season's log error from {:.3f} % "
    "to {:.3f} % of speed (standard\ndeviation); the last column says how far it is after "
    "each. {}\n{}": (
        "{}.\nAllemaal samen brengen ze de onzekerheid van de logfout van een seizoen van "
        "{:.3f} % naar {:.3f} % van de snelheid\n(standaardafwijking); de laatste kolom "
        "zegt hoe ver het na elk is. {}\n{}"
    ),
    "0.1 m/s": "0,1 m/s",
    "It is not worth it for that alone.": "Daarvoor alleen loont het niet.",
    "From, to: the 95 % interval of Cw where the method estimates the error of the log; else "
    "the spread\nof the runs alone, without that error. A and B hold from 85 to 115 % of v.": (
        "Van, tot: het 95 %-interval van Cw als de methode de fout van de log schat; anders alleen "
        "de spreiding\nvan de runs, zonder die fout. A en B gelden van 85 tot 115 % van v."
    ),
    "would not show: a fault of the usual size would be taken for what is given under 'or else'. "
    "The interval\ncounts how seldom such a fault is, so where nothing points to one it can be "
    "0 to 0.": (
        "zou niet opvallen: een fout van gewone grootte zou worden aangezien voor wat bij 'of "
        "anders' staat. Het\ninterval rekent mee hoe zelden zo'n fout voorkomt; waar niets erop "
        "wijst kan het 0 tot 0 zijn."
    ),
    # Log-error, rebase, methods, fit
    "True speed = log speed x factor, under {} (95 % intervals):": (
        "Ware snelheid = logsnelheid x factor, volgens {} (95 %-intervallen):"
    ),
    "links: boats also towed in other seasons; step is of: whether the season differs by its\n"
    "log or by its load cell (force), as the bend of the same boats' curves tells; prescribed:\n"
    "nothing ties the season to one with dGPS, so its factor is not determined and the method's\n"
    "prescribed one is used.": (
        "koppelingen: sloepen die ook in andere seizoenen gesleept zijn; stap komt van: of het "
        "seizoen\nafwijkt door de log of door de krachtmeter, te zien aan de bocht van de "
        "krommen van dezelfde\nsloepen; voorgeschreven: niets verbindt het seizoen met een met "
        "dGPS, dus de factor is niet\nbepaald en die van de methode is gebruikt."
    ),
    "No sound tow in {}: nothing is known of the log there.": (
        "Geen bruikbare proef in {}: over de log daar is niets bekend."
    ),
    "Each log, and each part of a season in which one was replaced:": (
        "Elke log, en elk deel van een seizoen waarin er een vervangen is:"
    ),
    "What may be wrong with the instruments of a season:": (
        "Wat er mis kan zijn met de instrumenten van een seizoen:"
    ),
    "  nothing was found, and nothing is in doubt": "  er is niets gevonden, en er is geen twijfel",
    "{}, from {}": "{}, vanaf {}",
    "{} against {}; nothing was stored.": "{} tegenover {}; er is niets bewaard.",
    "Register lines: {}.": "Registerregels: {}.",
    "Change of Cw at the declared speed by each step, median of the season's tows; a "
    "tow's\nown steps multiply to its total, medians need not:\n": (
        "Verandering van Cw bij de opgegeven snelheid door elke stap, mediaan over de "
        "proeven van het seizoen; de stappen van\neen proef geven samen het totaal, die "
        "van medianen niet altijd:\n"
    ),
    "Register lines most affected:\n": "Registerregels die het meest veranderen:\n",
    "The file is sound. Try it: herijk rebase {}": (
        "Het bestand is in orde. Probeer het: herijk rebase {}"
    ),
    "{} extends {}. Change it, then: herijk methods check {}": (
        "{} bouwt voort op {}. Verander het, en dan: herijk methods check {}"
    ),
    "{} and {} say the same of every season.": "{} en {} zeggen van elk seizoen hetzelfde.",
    "{}: {} points": "{}: {} punten",
    "Cw [kg/m] with its 95 % interval, from the scatter of the points alone:": (
        "Cw [kg/m] met 95 %-interval, uit de spreiding van de punten alleen:"
    ),
    "  {:8.3f}  {:8.3f}  {} to {}": "  {:8.3f}  {:8.3f}  {} tot {}",
    "B above {:.2f} m/s is possible": "elke B boven {:.2f} m/s kan",
    "any B is possible": "elke B kan",
    "the points show no bend, so there is no B ({})": (
        "de punten tonen geen bocht, dus er is geen B ({})"
    ),
    "B is not determined: the best fit has {:.2f} m/s, but {}": (
        "B is niet bepaald: het best past {:.2f} m/s, maar {}"
    ),
    "B = {:.3f} m/s ({:.3f} to {:.3f})": "B = {:.3f} m/s ({:.3f} tot {:.3f})",
    "without bound": "onbegrensd",
    # Methods in words
    "Extends {}; what differs from it is marked {}.": (
        "Bouwt voort op {}; wat daarvan verschilt is gemerkt met {}."
    ),
    "Content hash {}": "Hash van de inhoud {}",
    "Season {}": "Seizoen {}",
    "Seasons {} to {}": "Seizoenen {} tot {}",
    "the present": "heden",
    "noise": "ruis",
    # Audit
    "{} plots in {}": "{} figuren in {}",
    "{}; towed for {} crews ({}): each has a register line and repeats of its own; in the "
    "statistics of a type they are one boat": (
        "{}; gesleept voor {} ploegen ({}): elk heeft een eigen registerregel en eigen "
        "herhalingen; in de statistiek van een type zijn ze een sloep"
    ),
    "No tow of this boat was accepted.": "Geen proef van deze sloep is opgenomen.",
    "Its place among {} towed boats of its type ({}), newest tow of each boat and crew:": (
        "De plaats tussen {} gesleepte sloepen van het type ({}), nieuwste proef van elke "
        "sloep en ploeg:"
    ),
    "If it shared its type's bend:": "Met de bocht van het type:",
    "Slow tow:": "Langzame proef:",
    "Its repeat tows (without an alteration between them; E_n above 1: they disagree):": (
        "Herhaalde proeven (zonder verbouwing ertussen; E_n boven 1: ze spreken elkaar tegen):"
    ),
    "As predicted from weight, length, beam and type by the other boats:": (
        "Zoals voorspeld uit gewicht, lengte, breedte en type door de andere sloepen:"
    ),
    "What other choices do to Cw, the largest first (the tool of 2015 let one tick: tool):": (
        "Wat andere keuzes met Cw doen, de grootste eerst (wat het programma van 2015 liet "
        "aanvinken: tool):"
    ),
    "In the registers:": "In de registers:",
    "Set aside, by its number or the name of its file:": (
        "Terzijde gelegd, volgens nummer of bestandsnaam:"
    ),
    "  none: n 0": "  geen: n 0",
    "  not predicted: n 0": "  niet voorspeld: n 0",
    "  no line": "  geen regel",
    "  nothing": "  niets",
    "wholly": "helemaal",
    "not determined": "niet bepaald",
    "B not determined": "B niet bepaald",
    ", Cw at 115 % {} %": ", Cw bij 115 % {} %",
    "  {}, {}, {}: B {} to {}, Cw at the declared speed {} %{}": (
        "  {}, {}, {}: B {} naar {}, Cw bij de opgegeven snelheid {} %{}"
    ),
    "  {}, {}{}, {} to {}: Cw {} %, E_n {}": "  {}, {}{}, {} naar {}: Cw {} %, E_n {}",
    "they disagree": "ze spreken elkaar tegen",
    "they agree": "ze komen overeen",
    "{}, A {:.2f}, {}, Cw {:.2f} at {:.2f} m/s, tow {}, until {}": (
        "{}, A {:.2f}, {}, Cw {:.2f} bij {:.2f} m/s, proef {}, tot {}"
    ),
    "weight not known": "gewicht niet bekend",
    "Tow {} of {}: {}{}, declared {:.2f} m/s, {} m, {}, from {}": (
        "Proef {} van {}: {}{}, opgegeven {:.2f} m/s, {} m, {}, uit {}"
    ),
    "  {} to {}: Cw {} %{}{}": "  {} naar {}: Cw {} %{}{}",
    "standard uncertainty of Cw: {}": "standaardonzekerheid van Cw: {}",
    "no curve, {}{}": "geen kromme, {}{}",
    "A {:.2f} kg/m, {} ({}), Cw {:.2f} kg/m ({}: {:.2f} to {:.2f}), {:.1f} W per rower, {}{}": (
        "A {:.2f} kg/m, {} ({}), Cw {:.2f} kg/m ({}: {:.2f} tot {:.2f}), {:.1f} W per roeier, {}{}"
    ),
    "runs alone: spread of the runs alone: the log's error is not in it": (
        "alleen runs: spreiding van de runs alleen: de fout van de log zit er niet in"
    ),
    "{}: {:.2f} to {}": "{}: {:.2f} tot {}",
    "no interval": "geen interval",
    "no upper bound": "geen bovengrens",
    "runs alone": "alleen runs",
    "{}: are equal boats equal?": "{}: zijn gelijke sloepen gelijk?",
    "In short, over all tows of {}": "Kort, over alle proeven van {}",
    "all seasons": "alle seizoenen",
    "{} (n {} of {} boats).": "{} (n {} van {} sloepen).",
    "Outside the type: ": "Buiten het type: ",
    "no tow": "geen proef",
    "{} follows {}": "{} volgt {}",
    "{} and {} no trend": "{} en {} geen verband",
    "{}, {} explained": "{}, {} verklaard",
    "{:.2f} to {:.2f}": "{:.2f} tot {:.2f}",
    "B {} hull speed: {:.2f} times it ({}); towed at {} of it.": (
        "B {} de rompsnelheid: {:.2f} keer zo hoog ({}); gesleept bij {} ervan."
    ),
    "may be": "kan zijn:",
    "is not": "is niet",
    " at a standard {}": " bij een standaard van {}",
    " or ": " of ",
    "1. Do A [kg/m] and B [m/s] follow weight or tow speed, q weight? Cw [kg/m]{}?": (
        "1. Volgen A [kg/m] en B [m/s] het gewicht of de sleepsnelheid, q het gewicht? Cw [kg/m]{}?"
    ),
    "2. Can all boats have the same bend?": "2. Kunnen alle sloepen dezelfde bocht hebben?",
    "3. Does the bend q = (v/B)^2 / (1 - (v/B)^2) follow the tow speed? A true hyperbola's "
    "does not.": (
        "3. Volgt de bocht q = (v/B)^2 / (1 - (v/B)^2) de sleepsnelheid? Die van een echte "
        "hyperbool doet dat niet."
    ),
    "4. If like boats shared one bend: B, and most change of a register's Cw by speed": (
        "4. Als gelijke sloepen een bocht deelden: B, en de grootste verandering van Cw in "
        "een register per snelheid"
    ),
    "5. Which boats lie outside their type?": "5. Welke sloepen liggen buiten hun type?",
    "6. Slow tows: under {:.0f} W (men) or {:.0f} W (women) a rower": (
        "6. Langzame proeven: onder {:.0f} W (heren) of {:.0f} W (dames) per roeier"
    ),
    "7. Do repeat tows of unaltered boats agree, before and after correction?": (
        "7. Komen herhaalde proeven van niet verbouwde sloepen overeen, voor en na correctie?"
    ),
    "8. Second opinion without towing: Cw from weight, length, beam and type": (
        "8. Tweede mening zonder slepen: Cw uit gewicht, lengte, breedte en type"
    ),
    "{} against {}": "{} tegen {}",
    "Cw lies closer together than both": "Cw ligt dichter bijeen dan beide",
    "Cw lies further apart": "Cw ligt verder uiteen",
    "these differ no more than chance lets them": (
        "deze verschillen niet meer dan het toeval toelaat"
    ),
    "spread about weight: {}: {}.": "spreiding om het gewicht: {}: {}.",
    "yes, equal bends are possible": "ja, gelijke bochten zijn mogelijk",
    "no, they differ by more than noise": "nee, ze verschillen meer dan ruis",
    "not claimed, too weak a test": "niet te zeggen, te zwakke toets",
    "{}: p {:.3f} (F {:.2f} on {} and {}, n {}).": "{}: p {:.3f} (F {:.2f} op {} en {}, n {}).",
    "{} The shared curve does not bend upwards: there is no B to compare.": (
        "{} De gedeelde kromme buigt niet omhoog: er is geen B om te vergelijken."
    ),
    "{} Chance to see a true spread of B of 5 %: {}, of 10 %: {}. {}": (
        "{} Kans om een echte spreiding van B van 5 % te zien: {}, van 10 %: {}. {}"
    ),
    "Noise alone gives {} of the variance of the bends": (
        "Ruis alleen geeft {} van de variantie van de bochten"
    ),
    "{}, B a spread of {} (seen {}), A and B a correlation of {:.2f} (seen {:.2f}).": (
        "{}, B een spreiding van {} (gezien {}), A en B een correlatie van {:.2f} (gezien {:.2f})."
    ),
    "follows": "volgt",
    "no trend seen": "geen verband gezien",
    "none seen": "niet gezien",
    "{}: 10 % more tow speed, q {}, n {}.": "{}: 10 % meer sleepsnelheid, q {}, n {}.",
    "shared bend": "gedeelde bocht",
    "the bend": "de bocht",
    "n {} by {}": "n {} naar {}",
    "too few boats to judge {}": "te weinig sloepen om {} te beoordelen",
    "{} outside ({}).": "{} erbuiten ({}).",
    "{} to later": "{} naar later",
    "{} ({} to {})": "{} ({} tot {})",
    "ageing is not taken out: fewer than six pairs within the last era.": (
        "veroudering is niet verrekend: minder dan zes paren in het laatste tijdperk."
    ),
    "ageing taken out: Cw {} % a year, from n {} pairs of all types within the last era.": (
        "veroudering verrekend: Cw {} % per jaar, uit n {} paren van alle types in het "
        "laatste tijdperk."
    ),
    "s_r: within a tow; s_R: between tows of one boat (ISO 5725); classes: how many "
    "classes of boats of a type can be told apart.": (
        "s_r: binnen een proef; s_R: tussen proeven van een sloep (ISO 5725); klassen: "
        "hoeveel klassen sloepen van een type te onderscheiden zijn."
    ),
    "no repeat pairs of this type (n 0).": "geen herhaalde proeven van dit type (n 0).",
    "this type: s_R {} (n {} pairs, {} of {} disagree by E_n).": (
        "dit type: s_R {} (n {} paren, {} van {} spreken elkaar volgens E_n tegen)."
    ),
    "no bound": "geen grens",
    "spread by cause: nothing claimed, {}.": "spreiding per oorzaak: niet te zeggen, {}.",
    "within types, at one speed: {} (n {}).": "binnen types, bij een snelheid: {} (n {}).",
    "boats": "sloepen",
    "not known (n 0 pairs)": "niet bekend (n 0 paren)",
    "{} ({}, n {} pairs)": "{} ({}, n {} paren)",
    "{}: off by {} (n {}; all types {}, n {}); the tow test itself {}, between seasons {}; "
    "{} of {} disagree.": (
        "{}: {} ernaast (n {}; alle types {}, n {}); de sleepproef zelf {}, tussen "
        "seizoenen {}; {} van {} spreken elkaar tegen."
    ),
    "q against weight": "q tegen gewicht",
    "spread about weight": "spreiding om gewicht",
    "equal bends possible": "gelijke bochten mogelijk",
    "q per 10 % tow speed": "q per 10 % sleepsnelheid",
    "boats outside": "sloepen erbuiten",
    "slow tows": "langzame proeven",
    "{}, next tow": "{}, volgende proef",
    "repeats: s_R": "herhalingen: s_R",
    "off from dimensions": "ernaast uit de maten",
    "not claimed": "niet te zeggen",
    "{}, p {:.3f}, noise {}, n {}": "{}, p {:.3f}, ruis {}, n {}",
    "{} of n {}": "{} van n {}",
    "{}, n {} pairs": "{}, n {} paren",
    "{} Beside a verdict stand the slope, per 100 kg (q: 1000 kg) or 0.1 m/s, and the "
    "share of the spread that the line explains.": (
        "{} Naast een oordeel staan de helling, per 100 kg (q: 1000 kg) of 0,1 m/s, en het "
        "deel van de spreiding dat de lijn verklaart."
    ),
    "What differs: slopes and shifts by more than both intervals together, and verdicts": (
        "Wat verschilt: hellingen en verschuivingen met meer dan beide intervallen samen, "
        "en oordelen"
    ),
    "weight": "gewicht",
    "tow speed": "sleepsnelheid",
    "two crews of one boat are not taken for two boats. Intervals are 95 %; a trend or "
    "shift is named where its interval leaves out zero: 'none seen' is no proof that there "
    "is none.": (
        "twee ploegen van een sloep tellen niet als twee sloepen. Intervallen zijn 95 %; "
        "een verband of verschuiving wordt genoemd als nul buiten het interval ligt: 'niet "
        "gezien' bewijst niet dat er niets is."
    ),
    "n counts the newest tow of each boat and crew": (
        "n telt de nieuwste proef van elke sloep en ploeg"
    ),
    "lines and outliers over all tows, repeats of a boat taken as such; the other "
    "statistics over the newest tow of each boat and crew": (
        "lijnen en uitschieters over alle proeven, herhalingen van een sloep als zodanig; "
        "de overige statistiek over de nieuwste proef van elke sloep en ploeg"
    ),
    "only tows of {}, the newest of each boat and crew among them; eras and agreement of "
    "all types over all seasons": (
        "alleen proeven van {}, daarvan de nieuwste van elke sloep en ploeg; tijdperken en "
        "overeenstemming van alle types over alle seizoenen"
    ),
    "{} boats": "{} sloepen",
    "nothing claimed: {} ({})": "niet te zeggen: {} ({})",
    "and {} more: see --json": "en nog {}: zie --json",
    "{} boats, {} of them towed; {} tows": "{} sloepen, waarvan {} gesleept; {} proeven",
    "{} accepted.": "{} opgenomen.",
    "{}, {}; {}; declared speed {}.": "{}, {}; {}; opgegeven snelheid {}.",
    "nothing known explains it": "niets bekends verklaart het",
    "(v/B)^2 {:.2f}, expected {:.2f}": "(v/B)^2 {:.2f}, verwacht {:.2f}",
    "Cw at {:.2f} m/s {} % from the expected": "Cw bij {:.2f} m/s {} % van het verwachte",
    "{:.2f} m/s, {:.0f} W per rower": "{:.2f} m/s, {:.0f} W per roeier",
    "{}, {}: {}; no like crews to compare with": "{}, {}: {}; geen vergelijkbare ploegen",
    "{}, {}: {}; at {:.2f} m/s, where like crews row ({} of its speed), its curve asks {} "
    "% ({} to {}) of the power by its type's bend": (
        "{}, {}: {}; bij {:.2f} m/s, waar vergelijkbare ploegen roeien ({} van de eigen "
        "snelheid), vraagt de kromme {} % ({} tot {}) van het vermogen volgens de bocht "
        "van het type"
    ),
    "Cw at {:.2f} m/s {:.2f}, predicted {:.2f} ({:.2f} to {:.2f}) kg/m": (
        "Cw bij {:.2f} m/s {:.2f}, voorspeld {:.2f} ({:.2f} tot {:.2f}) kg/m"
    ),
    "Cw, power of m": "Cw, macht van m",
    # Kinds of findings of verify
    "altered": "gewijzigd",
    "missing": "ontbreekt",
    "swapped": "verwisseld",
    "differs": "verschilt",
    "unchecked": "niet gecontroleerd",
}

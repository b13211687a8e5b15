"""What could not be done, in Dutch, by its English text."""

from typing import Final

ERRORS: Final[dict[str, str]] = {
    # The machine, the data folder
    "there is no Dask scheduler at {}: {}": "er is geen Dask-scheduler op {}: {}",
    "this server works on {} and {} alone": "deze server werkt alleen met {} en {}",
    "{}, named by smtp_password_file, cannot be read": (
        "{}, genoemd bij smtp_password_file, is niet te lezen"
    ),
    "the archive {} lies in the data folder {}, or is the same; name a data folder outside "
    "the archive with --data": (
        "het archief {} ligt in de datamap {}, of is dezelfde map; kies met --data een "
        "datamap buiten het archief"
    ),
    "{} cannot be understood: {}. Mend it, or remove it: it is made again with the usual "
    "settings": (
        "{} is niet te begrijpen: {}. Herstel het, of haal het weg: het wordt dan opnieuw "
        "gemaakt met de gewone instellingen"
    ),
    "to work on {} a library is needed that is not there; install it with: pip install "
    "'herijk[dask]'": (
        "om op {} te werken is een bibliotheek nodig die ontbreekt; installeer die met: "
        "pip install 'herijk[dask]'"
    ),
    "{} ended by itself with status {}; what it said is above": (
        "{} stopte vanzelf met status {}; wat het meldde staat hierboven"
    ),
    "{}:{} cannot be used: {}. Name another with --port": (
        "{}:{} is niet te gebruiken: {}. Kies een andere met --port"
    ),
    "{}, by {}. {}": "{}, door {}. {}",
    "{} is being rebuilt already": "{} wordt al herberekend",
    "{} is served already": "{} wordt al bediend door een andere herijk serve",
    "Wait until that is done, or stop that process; its lock goes with it": (
        "Wacht tot dat klaar is, of stop dat proces; zijn slot verdwijnt dan mee"
    ),
    "Stop that one first": "Stop die eerst",
    "process {} on {} since {}": "proces {} op {} sinds {}",
    "a process that has just begun": "een proces dat net begonnen is",
    "What was there before is whole, and what was finished is kept.": (
        "Wat er al was is heel, en wat af is blijft bewaard."
    ),
    "there is no room left to write in {root}. Free some, or move the data folder; "
    "lake/samples in it is the largest part and is made again when needed": (
        "er is geen ruimte meer om in {root} te schrijven. Maak ruimte, of verplaats de "
        "datamap; lake/samples is daarin het grootst en wordt zo nodig opnieuw gemaakt"
    ),
    "{root} cannot be written. Give the user who runs this the right to write in all of "
    "it, or name another folder with --data": (
        "{root} is niet te beschrijven. Geef de gebruiker die dit draait overal in die map "
        "schrijfrecht, of kies met --data een andere map"
    ),
    "{path} cannot be read or written. Give the user who runs this the right to it, or "
    "name another": (
        "{path} is niet te lezen of te beschrijven. Geef de gebruiker die dit draait daar "
        "recht op, of kies iets anders"
    ),
    "this process may not open more files. Allow more (ulimit -n 1024; in systemd "
    "LimitNOFILE=1024) and run it again": (
        "dit proces mag niet meer bestanden openen. Sta er meer toe (ulimit -n 1024; in "
        "systemd LimitNOFILE=1024) en start opnieuw"
    ),
    "this process may not write files as large as it needs. Allow larger ones (ulimit -f "
    "unlimited; in systemd LimitFSIZE=infinity) and run it again": (
        "dit proces mag geen bestanden schrijven van de grootte die nodig is. Sta grotere toe "
        "(ulimit -f unlimited; in systemd LimitFSIZE=infinity) en start opnieuw"
    ),
    "there is not enough memory. Allow more (ulimit -v unlimited; in systemd MemoryMax=), "
    "close other programs, or read fewer seasons at a time with --seasons": (
        "er is te weinig geheugen. Sta meer toe (ulimit -v unlimited; in systemd MemoryMax=), "
        "sluit andere programma's, of lees met --seasons minder seizoenen tegelijk"
    ),
    "stopped, as it was told to. {} Run it again to go on": (
        "gestopt, zoals gevraagd. {} Start opnieuw om verder te gaan"
    ),
    "no archive can be made in {}: {}. Name another folder": (
        "in {} is geen archief te maken: {}. Kies een andere map"
    ),
    "{} is no method file: the name of one ends in {}": (
        "{} is geen methodebestand: de naam daarvan eindigt op {}"
    ),
    "the disk under {root} gives errors. Look in the system's log, and replace it": (
        "de schijf onder {root} geeft fouten. Kijk in het logboek van het systeem en vervang hem"
    ),
    "Dagster's records in {root}/dagster are damaged. Remove that folder: it holds no "
    "table, only the history of runs": (
        "de gegevens van Dagster in {root}/dagster zijn beschadigd. Haal die map weg: er "
        "staat geen tabel in, alleen welke runs er waren"
    ),
    "Dagster's records in {root}/dagster cannot be opened: this process may not open more "
    "files (allow more: ulimit -n 1024; in systemd LimitNOFILE=1024), or has no right to "
    "that folder": (
        "de gegevens van Dagster in {root}/dagster zijn niet te openen: dit proces mag "
        "niet meer bestanden openen (sta er meer toe: ulimit -n 1024; in systemd "
        "LimitNOFILE=1024), of heeft geen recht op die map"
    ),
    "a figure could not be drawn: the drawing library stopped, usually because this "
    "process may not open more files (allow more: ulimit -n 1024; in systemd "
    "LimitNOFILE=1024)": (
        "een figuur kon niet getekend worden: het tekenprogramma stopte, meestal omdat dit "
        "proces niet meer bestanden mag openen (sta er meer toe: ulimit -n 1024; in "
        "systemd LimitNOFILE=1024)"
    ),
    "{} cannot be opened: {}": "{} is niet te openen: {}",
    "another program has it open for writing. Close that program, or let it open the "
    "file to read only, and try again": (
        "een ander programma heeft het open om erin te schrijven. Sluit dat programma, of "
        "open het bestand daar alleen om te lezen, en probeer opnieuw"
    ),
    "it is damaged, or another program wrote in it. Make it again with herijk rebuild, "
    "which knows the archive": (
        "het is beschadigd, of een ander programma schreef erin. Maak het opnieuw met "
        "herijk rebuild, dat het archief kent"
    ),
    "{} is damaged. It can be made again: run herijk rebuild; when that comes back, look "
    "at the disk": (
        "{} is beschadigd. Het is opnieuw te maken: draai herijk rebuild; komt dit terug, "
        "kijk dan naar de schijf"
    ),
    "a process that helped with the rebuild was ended, perhaps as memory ran out. Run it again: "
    "what was finished is kept": (
        "een proces dat bij het herrekenen hielp is gestopt, misschien omdat het geheugen vol was. "
        "Start het opnieuw: wat af was, blijft"
    ),
    "{} changed while it was read. Try again when nobody is copying files into {}": (
        "{} veranderde tijdens het lezen. Probeer opnieuw wanneer niemand bestanden naar "
        "{} kopieert"
    ),
    "{} is not there; make it with: herijk rebuild --archive DIR --data {}": (
        "{} is er niet; maak het met: herijk rebuild --archive MAP --data {}"
    ),
    "{} is not there; make it with: herijk rebuild --archive DIR --data {} --method {}": (
        "{} is er niet; maak het met: herijk rebuild --archive MAP --data {} --method {}"
    ),
    "{} has no tow: {}": "{} bevat geen sleepproef: {}",
    "there are {}": "er zijn {}",
    "there is none: {}": "er is er geen: {}",
    "the last rebuild found none that it could use; `herijk check ARCHIVE` and the table "
    "quarantine say why": (
        "de laatste herberekening vond er geen die bruikbaar was; `herijk check ARCHIEF` "
        "en de tabel quarantine zeggen waarom"
    ),
    "{} holds no warehouse; make it with: herijk rebuild --archive DIR --data {}": (
        "{} bevat geen uitkomsten; maak ze met: herijk rebuild --archive MAP --data {}"
    ),
    "{} holds no editions and no tables; is it the right data folder?": (
        "{} bevat geen edities en geen tabellen; is het de goede datamap?"
    ),
    "the archive lists no tow in the seasons asked for; it has tows of {}": (
        "het archief kent geen sleepproef in de gevraagde seizoenen; het heeft die van {}"
    ),
    "{} holds no tows; make it with: herijk rebuild --archive DIR --data {}": (
        "{} bevat geen sleepproeven; maak het met: herijk rebuild --archive MAP --data {}"
    ),
    "there is no warehouse to make it from; run herijk rebuild": (
        "er zijn geen uitkomsten om het uit te maken; draai herijk rebuild"
    ),
    "a check failed: {}": "een controle is niet geslaagd: {}",
    "something went wrong that was not foreseen: {}: {}": (
        "er ging iets mis dat niet voorzien was: {}: {}"
    ),
    "{}. Nothing was published. Details are in {}; please send it to whoever maintains Herijk": (
        "{}. Er is niets uitgegeven. Bijzonderheden staan in {}; stuur dat bestand naar "
        "wie Herijk onderhoudt"
    ),
    "Herijk itself failed on {}; all else was made. Please report this to whoever maintains "
    "Herijk, with what the folder unforeseen of the data folder has of it": (
        "Herijk zelf is vastgelopen op {}; al het andere is gemaakt. Meld dit aan wie Herijk "
        "onderhoudt, met wat daarvan in de map unforeseen van de gegevensmap staat"
    ),
    # Files and settings
    "there is no file {}": "er is geen bestand {}",
    "{} is there already; choose another name": "{} bestaat al; kies een andere naam",
    "{} is there and holds no pages; give a new folder": (
        "{} bestaat al en bevat geen pagina's; geef een nieuwe map"
    ),
    '{}: {!r}: it may hold archive = "folder" and data = "folder"': (
        '{}: {!r}: er mag alleen archive = "map" en data = "map" in staan'
    ),
    "{} cannot be read: {}": "{} is niet te lezen: {}",
    "{}: not valid TOML: {}": "{}: geen geldige TOML: {}",
    "{} is not valid TOML: {}": "{} is geen geldige TOML: {}",
    "{}: {}: {}; it may hold {}": "{}: {}: {}; er mag in staan: {}",
    "[[besluit]], each with sleep_id, oordeel (uitsluiten or voorkeur), reden, wie and datum": (
        "[[besluit]], elk met sleep_id, oordeel (uitsluiten of voorkeur), reden, wie en datum"
    ),
    "{}: more than one decision about {}": "{}: meer dan een besluit over {}",
    # TOML that people write
    "a letter in line {} is not in UTF-8; save the file as UTF-8": (
        "een letter in regel {} is geen UTF-8; bewaar het bestand als UTF-8"
    ),
    "{} letters, up to {} dots in a line; at most {} and {} can be right": (
        "{} letters, tot {} punten in een regel; hoogstens {} en {} kan kloppen"
    ),
    "line {} cannot be read; a number has a decimal point, text is put between quotes, and a key "
    "occurs once in its table": (
        "regel {} is niet te lezen; een getal heeft een decimale punt, een tekst staat tussen "
        "aanhalingstekens, en een sleutel staat een keer in zijn tabel"
    ),
    "tables within tables, too deep to read": "tabellen in tabellen, te diep om te lezen",
    "unknown key": "onbekende sleutel",
    "must be one of {expected}": "moet een zijn van {expected}",
    "must be one of {}": "moet een zijn van {}",
    "must be more than {gt}": "moet meer zijn dan {gt}",
    "must be at least {ge}": "moet minstens {ge} zijn",
    "must be less than {lt}": "moet minder zijn dan {lt}",
    "must be at most {le}": "mag hoogstens {le} zijn",
    "must be a number": "moet een getal zijn",
    "must be a whole number": "moet een heel getal zijn",
    "must be true or false": "moet true of false zijn",
    "must be a text between quotes": "moet een tekst tussen aanhalingstekens zijn",
    "must have the form {pattern}": "moet de vorm {pattern} hebben",
    "must be a list between [ and ]": "moet een lijst tussen [ en ] zijn",
    "must be a table": "moet een tabel zijn",
    "must be of small letters, digits and hyphens": (
        "mag alleen kleine letters, cijfers en streepjes hebben"
    ),
    "{}, not {!r}": "{}, niet {!r}",
    "{}, line {}": "{}, regel {}",
    "{}; allowed here: {}": "{}; hier kan: {}",
    "{} (season {})": "{} (seizoen {})",
    "{!r} is not a range of seasons; write 2009:2011, 2015: or 2014": (
        "{!r} is geen reeks seizoenen; schrijf 2009:2011, 2015: of 2014"
    ),
    "range {!r} ends before it begins": "reeks {!r} eindigt voordat die begint",
    "a method cannot build on itself: {}; change its name or this one": (
        "een methode kan niet op zichzelf voortbouwen: {}; geef een van beide een andere naam"
    ),
    "unknown step; allowed here: {}": "onbekende stap; hier kan: {}",
    "a table of options is needed, not {!r}": "hier hoort een tabel met opties, niet {!r}",
    "given twice for season {}; ranges overlap": (
        "twee keer gegeven voor seizoen {}; de reeksen overlappen"
    ),
    "{} is no file; remove it, or put the file there": (
        "{} is geen bestand; haal het weg, of zet het bestand er neer"
    ),
    "{} both are in {}; keep one": "{} staan allebei in {}; houd er een",
    "{} is not empty; name a folder that is new": "{} is niet leeg; geef een nieuwe map",
    "{} exists and is not an empty folder; nothing was written. Choose another folder, or "
    "remove it first": (
        "{} bestaat en is geen lege map; er is niets geschreven. Kies een andere map, of "
        "haal deze eerst weg"
    ),
    "{} exists; nothing was written. Remove it, or choose another folder": (
        "{} bestaat al; er is niets geschreven. Haal het weg, of kies een andere map"
    ),
    # The archive
    "The archive at {} cannot be read: {}": "Het archief in {} is niet te lezen: {}",
    "There is no archive at {}: expected a folder with {}, sleeplijsten/ and meetdata_<jaar>/.": (
        "Er is geen archief in {}: verwacht wordt een map met {}, sleeplijsten/ en "
        "meetdata_<jaar>/."
    ),
    "the archive is not where it was at the last rebuild; rebuild with --archive DIR": (
        "het archief staat niet meer waar het bij de laatste herberekening stond; "
        "herbereken met --archive MAP"
    ),
    "the archive has no tow of {} or before": "het archief heeft geen sleepproef van {} of eerder",
    "the archive holds no readable register printed in {}; it holds: {}": (
        "het archief bevat geen leesbaar register dat in {} gedrukt is; wel: {}"
    ),
    "{}: {} Mend the line, or take it out": "{}: {} Verbeter de regel, of haal hem weg",
    "{}, line {}: {} is listed twice for {}{}; take one of the lines out": (
        "{}, regel {}: {} staat twee keer in de lijst voor {}{}; haal een van de regels weg"
    ),
    "there is no file at {}: is its disk there?": (
        "er is geen bestand {}: is de schijf aangesloten?"
    ),
    "no tow can be used: the tow lists hold none in the seasons that were read; fill "
    "sleeplijsten/sleeplijst_<jaar>.csv, or widen --seasons": (
        "geen sleepproef is bruikbaar: de sleeplijsten hebben er geen in de gelezen "
        "seizoenen; vul sleeplijsten/sleeplijst_<jaar>.csv, of geef --seasons ruimer op"
    ),
    "no tow can be used: {} rows or files are set aside ({}). All are in the table "
    "quarantine. See them by cause with: herijk check ARCHIVE. The first: {}: {}": (
        "geen sleepproef is bruikbaar: {} rijen of bestanden zijn terzijde gelegd ({}). Ze "
        "staan allemaal in de tabel quarantine. Bekijk ze per oorzaak met: herijk check "
        "ARCHIEF. De eerste: {}: {}"
    ),
    "tow {}, run {}: no blocks, though its samples were read; rebuild with an empty data folder": (
        "sleepproef {}, run {}: geen blokken, terwijl de metingen gelezen zijn; herbereken "
        "met een lege datamap"
    ),
    # Boats, tows, types
    "there is no boat {!r}; boats go by FSN number or name, for example {} or {}": (
        "er is geen sloep {!r}; noem een FSN-nummer of een naam, bijvoorbeeld {} of {}"
    ),
    "{} boats are called {!r}: {}; give the FSN number": (
        "{} sloepen heten {!r}: {}; geef het FSN-nummer"
    ),
    "there is no boat and no type {!r}; the types, and how many boats: {}; boats are named by FSN "
    "number or name, for example {}": (
        "er is geen sloep en geen type {!r}; de types, en hoeveel sloepen: {}; een sloep heeft een "
        "FSN-nummer of een naam, bijvoorbeeld {}"
    ),
    "{} is a boat, not a type; a boat has a page of its own: herijk audit {}": (
        "{} is een sloep, geen type; een sloep heeft een eigen pagina: herijk audit {}"
    ),
    "there is no type {!r}; the types are {}": "er is geen type {!r}; de types zijn {}",
    "there are no tows {!r}; write all, newest, a season 2014 or a range 2012:2015": (
        "er zijn geen proeven {!r}; schrijf all, newest, een seizoen 2014 of een reeks 2012:2015"
    ),
    "no tow of {} has a curve that can be compared": (
        "geen proef van {} heeft een kromme die te vergelijken is"
    ),
    "no type of boat has curves to compare: there are no slides": (
        "geen type sloep heeft krommen om te vergelijken: er zijn geen dia's"
    ),
    "there is no table {!r}; the tables are {}": "er is geen tabel {!r}; de tabellen zijn {}",
    "there is no tow {!r} in the table tows": "er is geen sleepproef {!r} in de tabel tows",
    "tow {} has no members in the ensemble: there is no curve for it; look for its status "
    "in the table curves": (
        "sleepproef {} staat niet in het ensemble: hij heeft geen kromme; kijk naar zijn "
        "status in de tabel curves"
    ),
    "missing: {}": "ontbreekt: {}",
    "give force_n or cw_kg_m, and not both": "geef force_n of cw_kg_m, en niet allebei",
    "{} speeds and {} values; give as many of each": (
        "{} snelheden en {} waarden; geef er van elk evenveel"
    ),
    "A and B must be positive numbers": "A en B moeten positieve getallen zijn",
    "every speed and every power must be a number, 0 or more": (
        "elke snelheid en elk vermogen moet een getal van 0 of meer zijn"
    ),
    "sample_rate_hz is {}; 1 or more can be right": ("sample_rate_hz is {}; 1 of meer kan kloppen"),
    "every speed and every force must be a positive number": (
        "elke snelheid en elke kracht moet een positief getal zijn"
    ),
    "the points determine no curve; two different speeds are the least": (
        "de punten bepalen geen kromme; twee verschillende snelheden zijn het minste"
    ),
    "{}: {} curves use a point that is not a positive number, the first is curve {}. Set "
    "such points to unused beforehand.": (
        "{}: {} krommen gebruiken een punt dat geen positief getal is, de eerste is kromme "
        "{}. Zet zulke punten vooraf op niet gebruikt."
    ),
    "Points need three arrays of one shape (n_fits, n_points), not {}.": (
        "Punten vragen drie reeksen van een vorm (n_fits, n_points), niet {}."
    ),
    "Water temperatures must lie in {:g}-{:g} C, in degrees Celsius.": (
        "Watertemperaturen moeten tussen {:g} en {:g} graden Celsius liggen."
    ),
    "The fatigue reference is known from {:g} to {:g} h; {} race times lie outside, the "
    "first is {:.2f} h. Leave these without correction, or extend it.": (
        "De uitputtingscorrectie is bekend van {:g} tot {:g} uur; {} wedstrijdtijden liggen "
        "daarbuiten, de eerste is {:.2f} uur. Corrigeer die niet, of trek de lijn door."
    ),
    # Methods
    "there is no method {!r}; the methods are {}": "er is geen methode {!r}; de methoden zijn {}",
    "there is no method file {}": "er is geen methodebestand {}",
    "the tables hold no method {!r}; they hold {}": (
        "de tabellen bevatten geen methode {!r}; wel {}"
    ),
    "{} is the name of another method; choose another": (
        "{} is de naam van een andere methode; kies een andere naam"
    ),
    "{}: name: {!r}, and the file is called {!r}": "{}: name: {!r}, en het bestand heet {!r}",
    "{}: name: {!r} is a method that ships; choose another name": (
        "{}: name: {!r} is een meegeleverde methode; kies een andere naam"
    ),
    "{}: {}": "{}: {}",
    "{}: {} letters; a method has at most {}": (
        "{}: {} letters; een methode heeft er hoogstens {}"
    ),
    "{}: the seasons {} are not those of {}": "{}: de seizoenen {} zijn niet die van {}",
    "{} has {} ranges, not {}": "{} heeft {} reeksen seizoenen, niet {}",
    "the present": "heden",
    "method {} says nothing about season {}; it covers {} to {}. Leave that season out "
    "with --seasons, or widen the method's `seasons`": (
        "methode {} zegt niets over seizoen {}; die geldt van {} tot {}. Laat dat seizoen "
        "weg met --seasons, of maak `seasons` van de methode ruimer"
    ),
    "season factors: {} of tow {} is {}, and {} more; give only tows with a sound curve": (
        "seizoensfactoren: {} van sleepproef {} is {}, en nog {}; geef alleen proeven met "
        "een deugdelijke kromme"
    ),
    "there is no due list of method {}; make it with: herijk rebuild --archive DIR --data "
    "{} --method {}": (
        "er is geen lijst van te slepen sloepen volgens methode {}; maak hem met: herijk "
        "rebuild --archive MAP --data {} --method {}"
    ),
    # Editions
    "there is no edition {}; published: {}": "er is geen editie {}; uitgegeven: {}",
    "there is no edition {!r}; there are {}": "er is geen editie {!r}; er zijn {}",
    "the last rebuild has no edition {}; {}. One published since is there after herijk rebuild": (
        "de laatste herberekening heeft geen editie {}; {}. Een die daarna is uitgegeven, staat er "
        "na herijk rebuild"
    ),
    "none yet": "nog geen",
    "edition {} has no valid line of {}": "editie {} heeft geen geldige regel van {}",
    "any boat": "enige sloep",
    "boat {} is not in edition {}; its register.csv lists the boats": (
        "sloep {} staat niet in editie {}; register.csv noemt de sloepen"
    ),
    "edition {} was recomputed; only lines of an edition as printed can be carried over": (
        "editie {} is herberekend; alleen regels van een editie zoals gedrukt kunnen "
        "overgenomen worden"
    ),
    "edition {} was taken over from print and has no method; compare it with another "
    "edition: herijk diff {} EDITION": (
        "editie {} is overgenomen zoals gedrukt en heeft geen methode; vergelijk die met "
        "een andere editie: herijk diff {} EDITIE"
    ),
    "the tables of method {} are not those of the archive and code of today; run: herijk "
    "rebuild --archive DIR --data {} --method {}": (
        "de tabellen van methode {} horen niet bij het archief en het programma van "
        "vandaag; draai: herijk rebuild --archive MAP --data {} --method {}"
    ),
    "an edition needs a decision: say who decided it and where, with --decision": (
        "een editie vraagt een besluit: zeg met --decision wie het nam en waar"
    ),
    "{} decides about {}, which is not a tow of the warehouse; mend the sleep_id, or take the "
    "decision out": (
        "{} besluit over {}, en die sleepproef is er niet; verbeter de sleep_id, of haal "
        "het besluit weg"
    ),
    "{!r} cannot name an edition: use letters, digits, '.', '_' and '-', begin with a "
    "letter or digit, and not with 'concept-', which marks drafts": (
        "{!r} kan geen naam van een editie zijn: gebruik letters, cijfers, '.', '_' en "
        "'-', begin met een letter of cijfer, en niet met 'concept-', dat een concept "
        "aanduidt"
    ),
    "edition {} was already published and is never changed; publish under another name, "
    "for example with a higher number": (
        "editie {} is al uitgegeven en verandert nooit; geef uit onder een andere naam, "
        "bijvoorbeeld met een hoger nummer"
    ),
    "edition {}: {} is missing or damaged ({}); put the folder back from a copy": (
        "editie {}: {} ontbreekt of is beschadigd ({}); zet de map terug uit een kopie"
    ),
    "{}/{} names no file": "{}/{} noemt geen bestand",
    "edition {}: {}.parquet is missing or damaged; put the folder back from a copy": (
        "editie {}: {}.parquet ontbreekt of is beschadigd; zet de map terug uit een kopie"
    ),
    "edition {} could not be written: {}. Nothing was published; make room or mend the "
    "folder, and publish again": (
        "editie {} kon niet geschreven worden: {}. Er is niets uitgegeven; maak ruimte of "
        "herstel de map, en geef opnieuw uit"
    ),
    # Simulated archives
    "there is no world {}; there are: {}": "er is geen wereld {}; er zijn: {}",
    "season {} cannot be simulated: the table of instruments begins in {}; ask for {} or later": (
        "seizoen {} is niet te simuleren: de tabel van instrumenten begint in {}; vraag {} of later"
    ),
    "seasons must ascend and be at least one; got {}": (
        "seizoenen moeten oplopen en er moet er een zijn; gegeven: {}"
    ),
    "at least one tow per season is needed; got {}": (
        "per seizoen is minstens een sleepproef nodig; gegeven: {}"
    ),
    "the rate must be 4 to 10000 Hz; got {}": "de frequentie moet 4 tot 10000 Hz zijn; gegeven: {}",
    # What verify finds
    "edition {} was published and is gone": "editie {} is uitgegeven en is weg",
    "it is number {} of the editions, and {} is expected here: another was taken out, or put in": (
        "het is nummer {} van de edities, en hier wordt {} verwacht: er is een uitgehaald of "
        "tussengevoegd"
    ),
    "the edition before it has another seal than when this one was published": (
        "de editie ervoor heeft een ander zegel dan toen deze werd uitgegeven"
    ),
    "the folder was renamed; it is {}": "de map is hernoemd; het is {}",
    "{} was changed: its seal does not fit": "{} is gewijzigd: het zegel past niet",
    "{} is a link to somewhere else; an edition holds its files itself": (
        "{} verwijst naar elders; de bestanden van een editie staan in de editie zelf"
    ),
    "{} was added after publication": "{} is na de uitgave toegevoegd",
    "{} is gone; put it back from a copy": "{} is weg; zet het terug uit een kopie",
    "{} was changed after publication": "{} is na de uitgave gewijzigd",
    "{} does not say what the tables of the edition say": (
        "{} zegt iets anders dan de tabellen van de editie"
    ),
    "made again, it comes out otherwise in {}": "opnieuw gemaakt komt het anders uit in {}",
    "it was made by other code: {}": "het is door een ander programma gemaakt: {}",
    "it has no number in the chain of editions": "het heeft geen nummer in de rij van edities",
    "the head is {}, and should be {}": "het laatste zegel is {}, en zou {} moeten zijn",
    "it says {!r}; it was {!r}": "er staat {!r}; het was {!r}",
    "and {} more places differ": "en nog {} plaatsen verschillen",
    "the archive is not where the last rebuild found it; run herijk rebuild --archive DIR": (
        "het archief is niet waar de laatste herberekening het vond; draai herijk rebuild "
        "--archive MAP"
    ),
    "{} is gone from the archive; put it back": "{} is weg uit het archief; zet het terug",
    "{} is not the file that the edition was made from": (
        "{} is niet het bestand waaruit de editie gemaakt is"
    ),
    "{}: {} is {}; it was {}": "{}: {} is {}; het was {}",
    "it cannot be made again: {}": "hij is niet opnieuw te maken: {}",
    "made again, there is a line that the edition has not: {}": (
        "opnieuw gemaakt is er een regel die de editie niet heeft: {}"
    ),
    "made again, {}: {}": "opnieuw gemaakt, {}: {}",
    "its method has options that there are no longer": (
        "de methode heeft keuzes die er niet meer zijn"
    ),
    "{} is no longer in the warehouse": "{} is niet meer in de tabellen",
    "tows that went into it changed": "proeven die meetellen, zijn gewijzigd",
    "either the code changed since, or the edition did": (
        "of de code is sindsdien gewijzigd, of de editie"
    ),
}

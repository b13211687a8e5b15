"""The sentences about the archive in Dutch, by their English text."""

from typing import Final

ARCHIVE: Final[dict[str, str]] = {
    # Lists
    "Line {line}: {what}": "Regel {line}: {what}",
    "Herijk itself failed on this tow ({}). Its files may be sound. Please report this to "
    "whoever maintains Herijk, with unforeseen/{}.txt of the data folder.": (
        "Herijk zelf liep vast op deze sleepproef ({}). De bestanden kunnen goed zijn. Meld dit "
        "aan wie Herijk onderhoudt, met unforeseen/{}.txt uit de datamap."
    ),
    "Herijk itself failed on this list ({}). It may be sound. Please report this to whoever "
    "maintains Herijk, with the folder unforeseen of the data folder.": (
        "Herijk zelf liep vast op deze lijst ({}). De lijst kan goed zijn. Meld dit aan wie Herijk "
        "onderhoudt, met de map unforeseen uit de datamap."
    ),
    "line {line} of {path}": "regel {line} van {path}",
    "sheet '{sheet}': {what}": "blad '{sheet}': {what}",
    "The name of '{name}' has letters that cannot be read; give it another name.": (
        "De naam van '{name}' heeft letters die niet te lezen zijn; geef het een andere naam."
    ),
    "{boat} {crew} is listed twice for {race}; {ending}": (
        "{boat} {crew} staat twee keer bij {race}; {ending}"
    ),
    "there is no list of boats: {path} is expected.": (
        "er is geen lijst van sloepen: {path} wordt verwacht."
    ),
    "there is no list of tows: {path} is expected.": (
        "er is geen lijst van sleepproeven: {path} wordt verwacht."
    ),
    "'{path}' is not read: it has another name than the archive's files. It can be {kinds}; say "
    "so under [files] in archief.toml.": (
        "'{path}' wordt niet gelezen: de naam is anders dan die van bestanden van het archief. Het "
        "kan {kinds} zijn; zet dat onder [files] in archief.toml."
    ),
    "No run lasts longer than {lasts:.1f} s at {rate} samples a second, and {planned:.0f} s is "
    "planned: is the rate {observed:.0f}?": (
        "Geen run duurt langer dan {lasts:.1f} s bij {rate} metingen per seconde, en {planned:.0f} "
        "s is gepland: is de frequentie {observed:.0f}?"
    ),
    "Column {number} has no name and holds '{cell}'. Give it its name; one that is not needed can "
    "be put under ignore in archief.toml.": (
        "Kolom {number} heeft geen naam en bevat '{cell}'. Geef de kolom zijn naam; een kolom die "
        "niet nodig is, kan in archief.toml bij ignore."
    ),
    "[[{table}]] is for {what}, and no tow list has that: is it mistyped?": (
        "[[{table}]] is voor {what}, en dat staat in geen sleeplijst: is het een tikfout?"
    ),
    "column '{column}' is empty.": "kolom '{column}' is leeg.",
    "column '{column}' is {cell} and the boat list says {listed:g}; one of the two cannot be "
    "right.": (
        "kolom '{column}' is {cell} en de lijst van sloepen zegt {listed:g}; een van de twee kan "
        "niet kloppen."
    ),
    "{names} must be there, here or in the boat list.": (
        "{names} moet er zijn, hier of in de lijst van sloepen."
    ),
    "the year is {cell}; {low:g} to {high:g} can be right.": (
        "het jaar is {cell}; {low:g} tot {high:g} kan kloppen."
    ),
    "column '{column}' is {cell}; {low:g} to {high:g} can be right.": (
        "kolom '{column}' is {cell}; {low:g} tot {high:g} kan kloppen."
    ),
    "column '{column}' is {cell}; it must be a whole number.": (
        "kolom '{column}' is {cell}; het moet een geheel getal zijn."
    ),
    "column '{column}' is '{cell}', which is not an ordinary number.": (
        "kolom '{column}' is '{cell}'; dat is geen gewoon getal."
    ),
    "column '{column}' is {cell}, while other numbers of this list have their decimals behind a "
    "'{mark}'; write {whole} or {decimal}.": (
        "kolom '{column}' is {cell}, terwijl andere getallen in deze lijst een '{mark}' voor de "
        "decimalen hebben; schrijf {whole} of {decimal}."
    ),
    "column '{column}' is '{cell}': is the first number the day or the month?": (
        "kolom '{column}' is '{cell}': is het eerste getal de dag of de maand?"
    ),
    "column '{column}' is '{cell}', not a date such as 2014-03-01 or 01-03-2014.": (
        "kolom '{column}' is '{cell}'; dat is geen datum zoals 2014-03-01 of 01-03-2014."
    ),
    "column '{column}' is '{cell}', which cannot be right.": (
        "kolom '{column}' is '{cell}'; dat kan niet kloppen."
    ),
    "column '{column}' is '{cell}'; H or D is expected.": (
        "kolom '{column}' is '{cell}'; H of D wordt verwacht."
    ),
    "column '{column}' is '{cell}', not ja, nee or empty.": (
        "kolom '{column}' is '{cell}', niet ja, nee of leeg."
    ),
    "column '{column}' is '{cell}'; it names one run twice.": (
        "kolom '{column}' is '{cell}'; er staat een run twee keer in."
    ),
    "column '{column}' is '{cell}', but there is no meetfile2.": (
        "kolom '{column}' is '{cell}', maar er is geen meetfile2."
    ),
    "column '{column}' has '{part}'; runs are 1 to {last}, or b1 to b{last} for the second file, "
    "with commas between them. Runs beyond these need a [[plan]].": (
        "kolom '{column}' heeft '{part}'; runs zijn 1 tot {last}, of b1 tot b{last} voor het "
        "tweede bestand, met komma's ertussen. Voor meer runs is een [[plan]] nodig."
    ),
    "Column {names} is not known. Correct it, name it under [headers] in archief.toml, or put it "
    "there under ignore.": (
        "Kolom {names} is onbekend. Verbeter de kop, noem hem onder [headers] in archief.toml, of "
        "zet hem daar bij ignore."
    ),
    "the row has {fields} fields where the header has {width}.": (
        "de rij heeft {fields} velden en de kop {width}."
    ),
    "a quotation mark is not closed, or in mid-field.": (
        "een aanhalingsteken is niet gesloten, of staat midden in een veld."
    ),
    "'{tow}' cannot be a sleep_id: it is too long, or has a slash.": (
        "'{tow}' kan geen sleep_id zijn: te lang, of met een schuine streep."
    ),
    "the date {day} is not in {season}, the year of the list.": (
        "de datum {day} valt niet in {season}, het jaar van de lijst."
    ),
    "{day} is set aside in archief.toml: {reason}.": (
        "{day} is terzijde gelegd in archief.toml: {reason}."
    ),
    "'roeitijd' is '{cell}', not a time such as 2:10:25.": (
        "'roeitijd' is '{cell}', geen tijd zoals 2:10:25."
    ),
    "'roeitijd' is 0.": "'roeitijd' is 0.",
    "'roeitijd' is {cell} for {km:g} km through the water: {speed:.3g} m/s; {low:g} to {high:g} "
    "can be right.": (
        "'roeitijd' is {cell} voor {km:g} km door het water: {speed:.3g} m/s; {low:g} tot {high:g} "
        "kan kloppen."
    ),
    "B is {b_m_s} m/s and the speed {declared_speed_m_s}; B must be higher.": (
        "B is {b_m_s} m/s en de roeisnelheid {declared_speed_m_s}; B moet hoger zijn."
    ),
    "Cw is {cw_kg_m}, but A {a_kg_m} and B {b_m_s} give {given:.2f} at {declared_speed_m_s} m/s; "
    "one of them is wrong, or two are exchanged.": (
        "Cw is {cw_kg_m}, maar A {a_kg_m} en B {b_m_s} geven {given:.2f} bij {declared_speed_m_s} "
        "m/s; een ervan klopt niet, of er zijn er twee verwisseld."
    ),
    "Column '{header}' is in Beaufort, which is a range of winds and no speed. Without a wind in "
    "m/s put wind under absent in the season's profile in archief.toml.": (
        "Kolom '{header}' is in Beaufort, en dat is een klasse van wind en geen snelheid. Zet "
        "zonder wind in m/s wind onder absent in het profiel van het seizoen in archief.toml."
    ),
    "there is only '{text}' in this row. A heading or a remark may begin with #.": (
        "alleen '{text}' staat in deze rij. Een kopje of opmerking mag met # beginnen."
    ),
    "a speed and a force must be above zero.": (
        "een snelheid en een kracht moeten boven nul liggen."
    ),
    # Rows compared with each other
    "the rows of the runs of one tow differ in column '{column}': '{one}' and '{other}'.": (
        "de rijen van de runs van één proef verschillen in kolom '{column}': '{one}' en '{other}'."
    ),
    "the rows of one tow are for runs {numbers}; each run has one row, and where each has a file "
    "of its own they are 1, 2, 3 and on.": (
        "de rijen van één proef zijn voor de runs {numbers}; elke run heeft één rij, en waar elke "
        "run een eigen bestand heeft zijn ze 1, 2, 3 en verder."
    ),
    "boat {boat} is listed twice and the rows differ in {key}: {one} here, {other} on {where}.": (
        "sloep {boat} staat twee keer in de lijsten en de rijen verschillen in {key}: {one} hier, "
        "{other} op {where}."
    ),
    "boat {boat} cannot be used, see {path}: {why}": (
        "sloep {boat} is niet te gebruiken, zie {path}: {why}"
    ),
    "boat {boat} is not in the boat list.": "sloep {boat} staat niet in de lijst van sloepen.",
    "sleep_id {tow} is also on {where}; {ending}": (
        "sleep_id {tow} staat ook op {where}; {ending}"
    ),
    "the rows are equal and the first counts.": "de rijen zijn gelijk en de eerste telt.",
    "the rows differ, so neither counts.": "de rijen verschillen, dus geen van beide telt.",
    "sleep_id {tow} is not in the tow list of that year.": (
        "sleep_id {tow} staat niet in de sleeplijst van dat jaar."
    ),
    "tow {tow} has no run {run}.": "sleepproef {tow} heeft geen run {run}.",
    "run {run} of tow {tow} has more than one window; none of them counts.": (
        "run {run} van sleepproef {tow} heeft meer dan een venster; geen ervan telt."
    ),
    "the window of run {run} of tow {tow} ends at {end} s, but the run lasts {seconds} s.": (
        "het venster van run {run} van sleepproef {tow} eindigt op {end} s, maar de run duurt "
        "{seconds} s."
    ),
    "'van' is {start} s and 'tot' {end} s; a window ends after it begins.": (
        "'van' is {start} s en 'tot' {end} s; een venster eindigt na zijn begin."
    ),
    "meetfile and meetfile2 hold the same samples.": (
        "meetfile en meetfile2 bevatten dezelfde metingen."
    ),
    "'{path}' holds the samples that {where} uses already for {boat}.": (
        "'{path}' bevat de metingen die {where} al voor {boat} gebruikt."
    ),
    "the samples are also used for {boat} {crew} on {where}; nobody can know whose they are.": (
        "de metingen zijn ook gebruikt voor {boat} {crew} op {where}; van wie ze zijn is niet te "
        "weten."
    ),
    # Files
    "there is no file '{name}' in {folder}.": "er is geen bestand '{name}' in {folder}.",
    "'{name}' can be any of {found}.": "'{name}' kan elk van deze zijn: {found}.",
    "'{name}' is a path; only the name of a file in {folder} can be given here.": (
        "'{name}' is een pad; hier kan alleen de naam staan van een bestand in {folder}."
    ),
    "No row of a tow list names this file.": "Geen rij van een sleeplijst noemt dit bestand.",
    "'{path}' is not read: it is packed. Unpack it in its folder.": (
        "'{path}' wordt niet gelezen: het is ingepakt. Pak het uit in zijn map."
    ),
    "'{path}' is not read: samples are read from text. Save the sheet as CSV.": (
        "'{path}' wordt niet gelezen: metingen worden uit tekst gelezen. Bewaar het blad als CSV."
    ),
    "'{path}' is not recognised. It may be put under ignore in archief.toml.": (
        "'{path}' is niet herkend. Het mag onder ignore in archief.toml."
    ),
    "'{path}' leads outside the archive, where nothing is read.": (
        "'{path}' leidt naar buiten het archief; daar wordt niets gelezen."
    ),
    "'{name}' cannot be read or unpacked: {error}.": (
        "'{name}' is niet te lezen of uit te pakken: {error}."
    ),
    "'{name}' is not there any more.": "'{name}' is er niet meer.",
    "'{name}' holds more than {limit:.0f} MB, unpacked; a samples file is about 12 MB.": (
        "'{name}' bevat uitgepakt meer dan {limit:.0f} MB; een meetbestand is ongeveer 12 MB."
    ),
    "'{name}' is not a whole {kind} file: {error}.": (
        "'{name}' is geen heel {kind}-bestand: {error}."
    ),
    "The file is not a spreadsheet that can be read: {error}.": (
        "Het bestand is geen leesbaar rekenblad: {error}."
    ),
    "The workbook has no sheet '{name}'; it has {names}.": (
        "Het rekenblad heeft geen werkblad '{name}'; wel {names}."
    ),
    "The workbook holds {:.0f} MB, unpacked; at most {:.0f} MB can be a list. Copy the list alone "
    "into a new workbook.": (
        "Het rekenblad is uitgepakt {:.0f} MB groot; een lijst is hoogstens {:.0f} MB. Kopieer "
        "alleen de lijst naar een nieuw rekenblad."
    ),
    "A sheet of the workbook reaches to row {} and column {}; a list has at most {} rows, {} "
    "columns and {} cells. Delete what is far below or beside the list, or copy the list alone "
    "into a new workbook.": (
        "Een werkblad loopt door tot rij {} en kolom {}; een lijst heeft hoogstens {} rijen, {} "
        "kolommen en {} cellen. Verwijder wat ver onder of naast de lijst staat, of kopieer alleen de lijst "
        "naar een nieuw rekenblad."
    ),
    "The file is empty.": "Het bestand is leeg.",
    "The file is not text in UTF-8, UTF-16 or Windows-1252: it can be damaged.": (
        "Het bestand is geen tekst in UTF-8, UTF-16 of Windows-1252: het kan beschadigd zijn."
    ),
    "The header is not a row of a table: {error}.": "De kop is geen rij van een tabel: {error}.",
    "This LabVIEW file has no segment header.": "Dit LabVIEW-bestand heeft geen kop.",
    # Columns and samples
    "Not found in the header: {names}. Found: {found}.": (
        "Niet gevonden in de kop: {names}. Wel: {found}."
    ),
    "Column '{header}' has unit [{unit}]; known here: {known}.": (
        "Kolom '{header}' heeft eenheid [{unit}]; bekend zijn hier: {known}."
    ),
    "'{end}' at the end of '{name}' is no known unit of it; put the unit in brackets.": (
        "'{end}' achter '{name}' is er geen bekende eenheid van; zet de eenheid tussen haken."
    ),
    "Column '{header}' can be more than one thing; write its unit behind it: {known}.": (
        "Kolom '{header}' kan van alles zijn; schrijf de eenheid erachter: {known}."
    ),
    "Columns '{first}' and '{second}' are the same; one of them has to go.": (
        "Kolommen '{first}' en '{second}' zijn dezelfde; een van de twee moet weg."
    ),
    "Column '{column}' holds {kind}, not numbers.": "Kolom '{column}' bevat {kind}, geen getallen.",
    "Column '{name}' is not known, and there is no 'gps'. Name it under columns of the season's "
    "profile in archief.toml, or put it there under ignore.": (
        "Kolom '{name}' is onbekend, en er is geen 'gps'. Noem hem bij columns in het profiel van "
        "dit seizoen in archief.toml, of zet hem daar bij ignore."
    ),
    "Nothing says which run a row is of: there is no column 'run', the time does not start again, "
    "and the file is not one of several that end in a number.": (
        "Nergens staat van welke run een rij is: er is geen kolom 'run', de tijd begint niet "
        "opnieuw, en het bestand is niet een van meer die op een nummer eindigen."
    ),
    "Runs {present} are in the file and runs {planned} are planned. Give the targets and "
    "directions of all runs under [[plan]] in archief.toml.": (
        "In het bestand staan runs {present} en gepland zijn runs {planned}. Geef de doelen en "
        "richtingen van alle runs onder [[plan]] in archief.toml."
    ),
    "No row has a number in column 'run'.": "Geen rij heeft een getal in de kolom 'run'.",
    "There are no samples in the file.": "Er staan geen metingen in het bestand.",
    "There are no samples below the header.": "Er staan geen metingen onder de kop.",
    "run {run:g} does not exist; runs are numbered 1 to {last}.": (
        "run {run:g} bestaat niet; runs zijn genummerd van 1 tot {last}."
    ),
    "run {run} begins again; its rows must be together.": (
        "run {run} begint opnieuw; zijn rijen moeten bij elkaar staan."
    ),
    "the time does not increase within the run.": "de tijd loopt niet op binnen de run.",
    "By its times it has {own:g} samples per second, other than the first tow of its season: "
    "write that into the tow list, in a column 'meetfrequentie [Hz]'.": (
        "Volgens de tijden heeft hij {own:g} metingen per seconde, anders dan de eerste proef "
        "van het seizoen: schrijf dat in de sleeplijst, in een kolom 'meetfrequentie [Hz]'."
    ),
    "Run {run}: by its times it has {observed:g} samples per second, by the list or the profile "
    "{rate}; they may differ by {most:.0%}.": (
        "Run {run}: volgens de tijden heeft hij {observed:g} metingen per seconde, volgens de "
        "lijst of het profiel {rate}; dat mag {most:.0%} verschillen."
    ),
    # Judging samples
    "The file has {} rows or more; at most {} can be right, and a tow of six runs at 1000 "
    "Hz has 300000.": (
        "Het bestand heeft {} rijen of meer; hoogstens {} kan kloppen, en een proef van "
        "zes runs bij 1000 Hz heeft er 300000."
    ),
    "The header has {} columns in {} letters; at most {} in {} can be right.": (
        "De kop heeft {} kolommen in {} letters; hoogstens {} in {} kan kloppen."
    ),
    "Run b{}": "Run b{}",
    "Run {}": "Run {}",
    "Run {} is to be used but is not in the file; it holds runs {}.": (
        "Run {} moet meetellen maar staat niet in het bestand; wel de runs {}."
    ),
    "{} lasts {:.2f} s at {} samples per second, {:.2f} s too short; {}.": (
        "{} duurt {:.2f} s bij {} metingen per seconde, {:.2f} s te kort; {}."
    ),
    "All runs last {:.0f} s or longer at {} samples per second, and {:.0f} s is planned: is the "
    "rate {:.0f}? Nothing is left out.": (
        "Alle runs duren {:.0f} s of langer bij {} metingen per seconde, en {:.0f} s is de "
        "bedoeling: is de meetfrequentie {:.0f}? Er valt niets af."
    ),
    "up to {:g} s may be missing, so the run is left out": (
        "er mag hoogstens {:g} s ontbreken, dus de run valt af"
    ),
    "the run goes on without them": "de run gaat verder zonder die seconden",
    "over {:g} s, so the run goes on without this column": (
        "meer dan {:g} s, dus de run gaat verder zonder deze kolom"
    ),
    "The force is {:.0f} N in a typical run; it must be positive.": (
        "De kracht is {:.0f} N in een gewone run; die moet positief zijn."
    ),
    "Columns '{}' and '{}' seem to be exchanged: typically they hold {:.4g} and {:.4g}, "
    "and only the other way round can that be right.": (
        "Kolommen '{}' en '{}' lijken verwisseld: gewoonlijk staat er {:.4g} en {:.4g}, en "
        "alleen andersom kan dat kloppen."
    ),
    "The speed by log1 is {:.2f} times the intended one; between {:g} and {:g} times it "
    "looks like km/h under another header.": (
        "De snelheid volgens log1 is {:.2f} keer de bedoelde; tussen {:g} en {:g} keer "
        "lijkt het km/u onder een andere kop."
    ),
    "{}: no row can be used, as fields are missing or the times jump back; the run is left out.": (
        "{}: geen rij is te gebruiken, want er ontbreken velden of de tijd springt terug; de run "
        "valt af."
    ),
    "column '{column}' {} in all runs, which is not wind; the tow goes on without wind.": (
        "kolom '{column}' {} in alle runs, en dat is geen wind; de proef gaat verder zonder wind."
    ),
    "{}: rows do not have their fields, {:.3g} s in all; {}.": (
        "{}: rijen hebben niet al hun velden, samen {:.3g} s; {}."
    ),
    "{}: column '{column}' {} and is wrong for {:.3g} s in all; {}.": (
        "{}: kolom '{column}' {} en klopt samen {:.3g} s niet; {}."
    ),
    "{what} The cell counts as empty.": "{what} De cel telt als leeg.",
    "holds {:.6g}": "bevat {:.6g}",
    "holds no ordinary number": "bevat geen gewoon getal",
    "{}: {what}; the run is left out.": "{}: {what}; de run valt af.",
    "{}: {what}; the run goes on without this column.": (
        "{}: {what}; de run gaat verder zonder deze kolom."
    ),
    "column '{column}' holds {:.6g} for {:.3g} s; less than {:g} s is normal": (
        "kolom '{column}' staat op {:.6g}, {:.3g} s lang; minder dan {:g} s is gewoon"
    ),
    "the mean of column '{column}' is {:.4g}; {:.3g} to {:.3g} can be right": (
        "het gemiddelde van kolom '{column}' is {:.4g}; {:.3g} tot {:.3g} kan kloppen"
    ),
    "{}: gps holds {:.6g} throughout, {}; the run goes on without this column.": (
        "{}: gps staat de hele tijd op {:.6g}, {}; de run gaat verder zonder deze kolom."
    ),
    "while log1 changed by {:.2f} m/s": "terwijl log1 {:.2f} m/s veranderde",
    "and so in {}, at another speed": "en net zo in {}, bij een andere snelheid",
    "and so in a run in which log1 changed": "en net zo in een run waarin log1 veranderde",
    "no column for {} in the header {!r}; name it with {}": (
        "geen kolom voor {} in de kop {!r}; noem hem met {}"
    ),
    "All {} tows of {}": "Alle {} proeven van {}",
    "{} has exactly the samples of {}; the run is left out.": (
        "{} bevat precies de metingen van {}; de run telt niet mee."
    ),
    "column '{column}' holds {:.3g} in a typical run and log1 {:.3g}, so it looks like {unit}; the "
    "tow goes on without this column.": (
        "kolom '{column}' is {:.3g} in een gewone run en log1 {:.3g}, dus het lijkt {unit}; de "
        "sleep gaat verder zonder deze kolom."
    ),
    "{} instead of {}": "{} in plaats van {}",
    "{} or {}": "{} of {}",
    "a gain of two": "een factor twee",
    "knots": "knopen",
    "radians": "radialen",
    "degrees": "graden",
    "column '{column}' is at its highest value, {:.6g}, in {:.0f} % of the samples, as a load "
    "cell at the end of its range": (
        "kolom '{column}' staat op zijn hoogste waarde, {:.6g}, bij {:.0f} % van de metingen, "
        "zoals een krachtmeter aan het eind van zijn bereik"
    ),
    "Columns '{}' and '{}' seem to be exchanged: the second moves {:.0f} times a second, as log1 "
    "does, and the first {:.1f} times, as a receiver does.": (
        "Kolommen '{}' en '{}' lijken verwisseld: de tweede verandert {:.0f} keer per seconde, "
        "zoals log1, en de eerste {:.1f} keer, zoals een ontvanger."
    ),
    "{} Or are weight and length in its row of the list not this boat's?": (
        "{} Of zijn gewicht en lengte in de lijst niet van deze sloep?"
    ),
    "{} tows of season {}": "{} proeven van seizoen {}",
    "All {} tows of season {}": "Alle {} proeven van seizoen {}",
    "This tow": "Deze proef",
    "All tows of the archive": "Alle proeven van het archief",
    "{}: {}. {}": "{}: {}. {}",
    "the force is {:.2g} times what the size of the boat and the other tows give": (
        "de kracht is {:.2g} keer wat de grootte van de sloep en de andere proeven geven"
    ),
    "the wind is {:.2g} times what out and back together give, which is the boat's own speed": (
        "de wind is {:.2g} keer wat heen en terug samen geven, de eigen snelheid van de sloep"
    ),
    "the wind out and back together comes from {:.0f} degrees; it is the wind of the boat's own "
    "speed, from straight ahead": (
        "de wind komt heen en terug samen uit {:.0f} graden; het is de wind van de eigen snelheid, "
        "van recht voren"
    ),
    "If the vane is turned, or counts from another 0, declare wind_zero_deg = {:.0f} under "
    "[[profile]] in archief.toml.": (
        "Als de windvaan gedraaid zit, of van een andere 0 telt, zet dan wind_zero_deg = {:.0f} "
        "onder [[profile]] in archief.toml."
    ),
    "all wind angles lie between -3.14 and 6.28, as angles in radians do": (
        "alle windhoeken liggen tussen -3,14 en 6,28, zoals hoeken in radialen"
    ),
    "Check whether these are this boat's samples, and what the load cell was set to.": (
        "Kijk of dit de metingen van deze sloep zijn, en hoe de krachtmeter was ingesteld."
    ),
    "It looks like {}: correct the unit in the header, or the scale.": (
        "Het lijkt op {}: verbeter de eenheid in de kop, of de schaal."
    ),
    "Run {} holds exactly the samples of tow {} ({}) of {} {}{}, packed or written otherwise.": (
        "Run {} bevat precies de metingen van proef {} ({}) van {} {}{}, anders verpakt of "
        "geschreven."
    ),
}

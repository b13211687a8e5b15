"use strict";
// Search, tables and charts of every page. Scripts come from the site; nothing else is fetched.
(() => {
  const root = document.documentElement;
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const form = document.querySelector(".selects");
  const choice = (name) => form?.elements[name]?.value ?? "";

  const site = root.dataset.site;
  const language = root.lang;
  const LOCALES = {
    nl: { decimal: ",", thousands: ".", grouping: [3], currency: ["€ ", ""], minus: "\u2212" },
    en: { decimal: ".", thousands: ",", grouping: [3], currency: ["€", ""], minus: "\u2212" },
  };
  const { decimal } = LOCALES[language];
  const plain = (text) => text.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase();

  // -- Scripts, when they are needed --------------------------------------------------------------
  const loaded = new Map();

  function load(path) {
    if (!loaded.has(path)) {
      loaded.set(path, new Promise((resolve, reject) => {
        const script = document.createElement("script");
        script.src = path;
        script.onload = resolve;
        script.onerror = () => reject(new Error(`${path} cannot be read`));
        document.head.append(script);
      }));
    }
    return loaded.get(path);
  }

  // The page's own data: what its charts draw, and the rows of tables that are not shown at first.
  let data = null;

  async function loadData() {
    if (data) return;
    await load(document.body.dataset.data);
    const packed = Uint8Array.from(atob(window.HERIJK_DATA), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    data = await new Response(stream).json();
  }

  const loadCharts = () => Promise.all([
    loadData(), load(`${site}static/charts-${language}.js`), load(`${site}static/vega.js`),
  ]);

  // -- Search -------------------------------------------------------------------------------------
  const find = document.querySelector(".find");
  const MOST_FOUND = 12;

  async function search() {
    await load(`${site}static/find.js`);
    const words = plain(find.querySelector("input").value).split(/\s+/).filter(Boolean);
    const list = find.querySelector("ul");
    list.hidden = words.length === 0;
    const fits = ([name, more]) => words.every((word) => plain(`${name} ${more}`).includes(word));
    const found = words.length ? window.HERIJK_FIND.filter(fits).slice(0, MOST_FOUND) : [];
    list.replaceChildren(...found.map(([name, , page]) => {
      const link = document.createElement("a");
      link.href = root.dataset.root + page;
      link.textContent = name;
      const item = document.createElement("li");
      item.append(link);
      return item;
    }));
    if (!found.length) list.append(Object.assign(document.createElement("li"), { textContent: "\u2013" }));
  }

  find.addEventListener("input", search);
  find.addEventListener("submit", (event) => {
    event.preventDefault();
    find.querySelector("li a")?.click();
  });
  find.addEventListener("keydown", (event) => {
    const links = all("li a", find);
    const here = links.indexOf(document.activeElement);
    const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
    if (step) { event.preventDefault(); (links[here + step] ?? find.querySelector("input")).focus(); }
    if (event.key === "Escape") find.querySelector("ul").hidden = true;
  });

  // -- The address holds what is chosen -------------------------------------------------------------
  const ownFields = () => all(".selects select, .tools .search");
  const defaults = new Map(ownFields().map((field) => [field.name, field.value]));

  function readAddress() {
    const wanted = new URLSearchParams(location.search);
    for (const field of ownFields()) {
      const value = wanted.get(field.name);
      const known = field.tagName !== "SELECT" || [...field.options].some((o) => o.value === value);
      if (value !== null && known) field.value = value;
    }
    return wanted.get("sort");
  }

  function writeAddress(sorted) {
    const kept = new URLSearchParams(location.search);
    for (const field of ownFields()) {
      if (field.value === defaults.get(field.name)) kept.delete(field.name);
      else kept.set(field.name, field.value);
    }
    if (sorted) kept.set("sort", sorted);
    const text = kept.toString();
    try {
      history.replaceState(null, "", (text ? `?${text}` : location.pathname) + location.hash);
    } catch { /* a browser may keep a page from disk from changing its address */ }
    const other = document.querySelector(".language");
    other.href = other.getAttribute("href").replace(/\?.*$/, "") + (text ? `?${text}` : "");
  }

  // -- Downloads --------------------------------------------------------------------------------
  // As the spreadsheets of the language write it. Text that one would take for a formula, also
  // after a separator of another language, is kept text.
  const SEPARATOR = { nl: ";", en: "," }[language];

  function csvCell(value) {
    if (value === null || value === undefined) return "";
    if (typeof value === "number") return String(value).replace(".", decimal);
    const text = String(value).replace(/(^|[;,\t\r\n])(\s*)([=+\-@])/g, "$1$2'$3");
    return /[",;\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  }

  function save(name, parts, type) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(parts, { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  function download(name, header, rows) {
    const text = [header, ...rows].map((row) => row.map(csvCell).join(SEPARATOR)).join("\r\n");
    save(`${name}.csv`, ["\ufeff", text, "\r\n"], "text/csv");
  }

  const headingOf = (text) => text.replace(/[\u00ad\u200b]/g, "").trim();

  // -- Tables -----------------------------------------------------------------------------------
  // A row that is not shown is not in the document: a browser lays out what is seen.
  const tables = all(".table");
  const rowsOfTable = new Map(tables.map((table) => [table, [...table.querySelector("tbody").rows]]));
  let selected = null; // boats chosen in a chart, or null
  let marked = null; // the boat whose row was clicked, or null

  // The rows that are not shown at first come with the data of the page.
  async function allRows(table) {
    const { more } = table.dataset;
    if (more) await loadData();
    if (table.dataset.more) {
      const place = document.createElement("template");
      place.innerHTML = data.rows[language][more];
      rowsOfTable.get(table).push(...place.content.children);
      delete table.dataset.more;
      arrange(table);
    }
  }

  const isOtherChosen = () => all("select", form ?? undefined).some((field) => field.value !== defaults.get(field.name));

  async function filter(table) {
    let fault = ""; // rows that cannot be read are missed; others do not take their place
    if (isOtherChosen()) await allRows(table).catch((error) => { fault = String(error); });
    const words = plain(table.querySelector(".search")?.value ?? "").split(/\s+/).filter(Boolean);
    const linked = table.querySelector("table.linked");
    const follows = JSON.parse(table.dataset.follows);
    const chosen = JSON.parse(table.dataset.keys).map((key) => key.every((value, i) => matches(follows[i], value)));
    const fits = (row) =>
      (chosen[row.dataset.k] ?? true) &&
      words.every((word) => plain(row.textContent).includes(word)) &&
      (!linked || selected === null || selected.has(row.dataset.boat));
    const shown = rowsOfTable.get(table).filter(fits);
    const body = table.querySelector("tbody");
    const isSame = shown.length === body.rows.length && shown.every((row, i) => row === body.rows[i]);
    if (!isSame) body.replaceChildren(...shown);
    if (linked) shown.forEach((row, i) => {
      row.tabIndex = i ? -1 : 0;
      row.classList.toggle("chosen", row.dataset.boat === marked);
    });
    table.querySelector(".count b").textContent = fault || shown.length;
    const clear = table.querySelector(".clear");
    if (clear) clear.hidden = selected === null;
  }

  // What a selector says, or each of several: to see two types side by side. "All" says nothing.
  const chosenOf = (names) => [names].flat().map(choice).filter((text) => text !== "");

  function matches(names, value) {
    const wanted = chosenOf(names);
    return wanted.length === 0 || [value].flat().some((one) => wanted.includes(String(one)));
  }

  // The number in a cell, or "" where there is none.
  function numberOf(cell) {
    if (cell.dataset.v !== undefined) return Number(cell.dataset.v);
    const text = cell.textContent.replace(decimal, ".").replace("\u2212", "-");
    return text === "" ? "" : Number(text);
  }

  const isNumeric = (cell) => cell.className === "";

  function sort(table, header, down = header.getAttribute("aria-sort") === "ascending") {
    all("th", table).forEach((other) => other.removeAttribute("aria-sort"));
    header.setAttribute("aria-sort", down ? "descending" : "ascending");
    arrange(table);
    filter(table);
  }

  // Puts all rows that are here in the order that a heading says.
  function arrange(table) {
    const header = table.querySelector("th[aria-sort]");
    if (!header) return;
    const down = header.getAttribute("aria-sort") === "descending";
    const place = [...header.parentElement.children].indexOf(header);
    const numeric = header.classList.contains("n");
    const compare = new Intl.Collator("nl", { numeric: true }).compare;
    const key = (cell) => (numeric ? numberOf(cell) : cell.textContent);
    const rows = rowsOfTable.get(table).map((row) => [key(row.cells[place]), row]);
    rows.sort(([a], [b]) => {
      if (a === "" || b === "") return (a === "") - (b === "");
      const order = numeric ? a - b : compare(a, b);
      return down ? -order : order;
    });
    rowsOfTable.set(table, rows.map(([, row]) => row));
  }

  for (const table of tables) {
    table.querySelector(".search")?.addEventListener("input", () => { filter(table); writeAddress(); });
    table.querySelector(".clear")?.addEventListener("click", () => select(null));
    all("th", table).forEach((header) =>
      header.querySelector("button").addEventListener("click", () => {
        sort(table, header);
        writeAddress(`${table.dataset.table}.${header.dataset.c}.${header.getAttribute("aria-sort")}`);
      }));
    table.querySelector(".csv").addEventListener("click", () => {
      download(table.dataset.table, all("th", table).map((h) => headingOf(h.textContent)),
        all("tbody tr", table).map((row) => [...row.cells].map((cell) =>
          (isNumeric(cell) ? numberOf(cell) : cell.textContent))));
    });
    table.querySelector("table.linked")?.addEventListener("click", (event) => {
      const row = event.target.closest("tbody tr");
      if (row) mark(row.dataset.boat);
    });
    table.querySelector("table.linked")?.addEventListener("keydown", (event) => {
      const step = { ArrowDown: "nextElementSibling", ArrowUp: "previousElementSibling", Enter: "self" }[event.key];
      const row = event.target.matches("tr") && (step === "self" ? event.target : event.target[step]);
      if (!row) return;
      event.preventDefault();
      row.focus();
      mark(row.dataset.boat);
    });
  }

  // -- Charts -----------------------------------------------------------------------------------
  const frames = new Map();

  // Columns to rows.
  function asRows(columns) {
    const names = Object.keys(columns);
    return (columns[names[0]] ?? []).map((_, i) =>
      Object.fromEntries(names.map((name) => [name, columns[name][i]])));
  }

  function rowsOf(name) {
    if (!frames.has(name)) frames.set(name, data.charts[name].flatMap(asRows));
    return frames.get(name);
  }

  function chosenRows(name, figure) {
    const follows = Object.entries(JSON.parse(figure.dataset.follows));
    const own = rowsOf(name).filter((row) => follows.every(([column, names]) =>
      (row[column] ?? null) === null || matches(names, row[column])));
    // A row of several methods or choices of tows is here for the one that is chosen.
    const several = follows.filter(([column, names]) => own.some((row) => Array.isArray(row[column])) && choice(names));
    const said = Object.fromEntries(several.map(([column, names]) => [column, choice(names)]));
    return several.length ? own.map((row) => ({ ...row, ...said })) : own;
  }

  const shownRows = (figure) => chosenRows(figure.dataset.data, figure);

  // What a chart shows of what the selectors say.
  function tell(figure) {
    if (!figure.dataset.said) return;
    const said = chosenRows(figure.dataset.said, figure).filter((row) => row.figure === figure.dataset.figure);
    figure.previousElementSibling.textContent = said.map((row) => row[language]).join(" ");
  }

  // What the selectors say, so that a chart names its tow and method, also in print.
  function picked(figure) {
    const names = Object.values(JSON.parse(figure.dataset.follows)).flat();
    return names.map((name) => form?.elements[name]?.selectedOptions[0])
      .filter((option) => option?.value).map((option) => option.textContent.trim()).join(", ");
  }

  const LABELS = 150; // room for axis and legend beside a chart [px]
  const views = new Map(); // figure -> its Vega view
  const visible = new Set();

  async function draw(figure) {
    const place = figure.querySelector(".chart");
    const turn = (figure.turn = (figure.turn ?? 0) + 1);
    await loadCharts();
    await document.fonts.load('12px "Open Sans"'); // labels are measured with it
    if (turn !== figure.turn) return;
    const spec = structuredClone(window.HERIJK_FIGURES[figure.dataset.figure]);
    const rows = shownRows(figure);
    spec.datasets = { rows };
    fitWidth(spec, figure);
    place.hidden = rows.length === 0;
    figure.querySelector(".picked").textContent =
      picked(figure) + (place.hidden ? `: ${window.HERIJK_WORDS.no_values}` : "");
    tell(figure);
    tabulate(figure);
    views.get(figure)?.finalize();
    views.delete(figure);
    try {
      const made = await window.vegaEmbed(place, spec, {
        actions: false,
        ast: true, // expressions are interpreted: the page forbids eval
        renderer: "svg",
        formatLocale: LOCALES[language],
        loader: { target: "_self" },
        config: {
          aria: false, // the picture is described as a whole
          mark: { aria: false },
          font: "Open Sans",
          axis: { labelFontSize: 12, titleFontSize: 12, labelLimit: 200 },
          legend: { labelFontSize: 12, titleFontSize: 12, labelLimit: 220, titleLimit: 300 },
          header: { labelFontSize: 12, titleFontSize: 12 },
        },
      });
      if (turn !== figure.turn) { made.finalize(); return; }
      views.set(figure, made);
      link(figure, made.view);
      describe(figure, place);
    } catch (error) {
      place.textContent = String(error);
      place.classList.add("broken");
    }
    place.classList.add("drawn");
  }

  // The rows of a chart as a table, made when it is opened: for people who cannot see the chart.
  async function tabulate(figure) {
    const place = figure.querySelector(".values");
    if (!place.open) return;
    await loadCharts();
    const words = window.HERIJK_WORDS;
    const rows = shownRows(figure);
    const columns = columnsOf(rows);
    const table = document.createElement("table");
    table.createCaption().textContent = figure.dataset.caption;
    const head = table.createTHead().insertRow();
    for (const column of columns) {
      const cell = document.createElement("th");
      cell.scope = "col";
      cell.textContent = headingOf(words[`column.${column}`] ?? column);
      head.append(cell);
    }
    const body = table.createTBody();
    for (const row of rows) {
      const line = body.insertRow();
      for (const column of columns) {
        const value = row[column] ?? "";
        const cell = line.insertCell();
        if (typeof value !== "number") cell.className = "t";
        cell.textContent = words[`code.${column}.${value}`] ?? words[`${column}.${value}`] ?? inWords(value, words);
      }
    }
    place.querySelector(".scroll").replaceChildren(table);
  }

  function inWords(value, words) {
    if (typeof value === "string") return words[`code.${value}`] ?? value;
    if (Number.isInteger(value)) return String(value);
    if (typeof value === "number") return String(Number(value.toPrecision(5))).replace(".", decimal);
    return words[String(value)] ?? String(value);
  }

  function columnsOf(rows) {
    return [...new Set(rows.flatMap(Object.keys))].filter((column) => column !== "page");
  }

  // A chart wider than its page is made narrower, with its labels; so are small multiples.
  function fitWidth(spec, figure) {
    const room = figure.parentElement.clientWidth;
    const isNarrow = room < 550;
    if (typeof spec.width === "number" && spec.width + LABELS > room) {
      spec.width = room;
      spec.autosize = { type: "fit-x", contains: "padding" };
    }
    for (const part of (spec.vconcat ?? [spec]).filter((part) => part.facet)) {
      fitFacets(part, room, isNarrow);
    }
    if (!isNarrow) return;
    const legend = { ...spec.config?.legend, orient: "bottom", columns: 1 };
    spec.config = { ...spec.config, legend, axisX: { titleFontSize: 10 } };
  }

  function fitFacets(part, room, isNarrow) {
    const least = part.spec.width > 200 ? 1 : 2;
    if (isNarrow && part.columns) part.columns = least;
    const columns = part.columns ?? 2; // rows and columns of a pair
    const width = Math.floor((room - (isNarrow ? LABELS / 2 : LABELS)) / columns) - 20;
    part.spec.width = isNarrow ? width : Math.min(part.spec.width, width);
  }

  function describe(figure, place) {
    const picture = place.querySelector("svg");
    if (!picture) return;
    all("[role]", picture).forEach((part) => part.removeAttribute("role")); // of a brush
    picture.setAttribute("role", "img");
    picture.setAttribute("aria-label", `${figure.dataset.caption} ${picked(figure)}`.trim());
  }

  function redraw(figure) {
    if (visible.has(figure)) draw(figure);
  }

  // Dragging over a scatter chooses boats for the list.
  function link(figure, view) {
    if (!view.getState({ data: (name) => name === "brush_store" }).data.brush_store) return;
    view.addDataListener("brush_store", (_, chosen) => {
      if (!chosen.length) { select(null); return; }
      const { fields, values } = chosen[0];
      const inside = (row) => fields.every((field, i) => {
        const [low, high] = [...values[i]].sort((a, b) => a - b);
        return row[field.field] !== null && row[field.field] >= low && row[field.field] <= high;
      });
      select(new Set(shownRows(figure).filter(inside).map((row) => row.fsn_no)));
    });
    offerEnds(figure, view);
  }

  // The same by keyboard, or where dragging scrolls the page: from and to on either axis.
  function offerEnds(figure, view) {
    const { x, y } = window.HERIJK_FIGURES[figure.dataset.figure].spec.encoding;
    const ends = [x, y].map(({ title }) => ["from", "to"].map((end) => {
      const input = Object.assign(document.createElement("input"), { type: "number", step: "any" });
      input.setAttribute("aria-label", `${title}, ${window.HERIJK_WORDS[end]}`);
      return input;
    }));
    const place = figure.querySelector(".ends") ?? figure.querySelector(".chart").nextElementSibling.appendChild(
      Object.assign(document.createElement("div"), { className: "ends tools" }));
    place.replaceChildren(...ends.flatMap(([from, to], i) => [[x, y][i].title, from, "\u2013", to]));
    place.oninput = () => {
      const isOpen = ends.flat().every((input) => input.value === "");
      const values = ends.map(([from, to]) => [
        from.value === "" ? -Infinity : from.valueAsNumber, to.value === "" ? Infinity : to.valueAsNumber]);
      const fields = [x, y].map(({ field }) => ({ type: "R", field }));
      view.data("brush_store", isOpen ? [] : [{ unit: "", fields, values }]).runAsync();
    };
  }

  function select(boats) {
    selected = boats;
    tables.forEach(filter);
  }

  // Clicking a row of the list, or going there with the arrows, makes its point large in every scatter.
  function mark(boat) {
    marked = boat;
    tables.forEach(filter);
    for (const { view } of views.values()) {
      if ("chosen" in view.getState().signals) view.signal("chosen", boat).runAsync();
    }
  }

  function start(figure) {
    visible.add(figure);
    draw(figure);
  }

  const nameOf = (figure) => [document.querySelector("h1").textContent, figure.dataset.caption, picked(figure)]
    .filter(Boolean).join(", ");

  async function savePicture(figure, kind) {
    await draw(figure);
    const { view } = views.get(figure);
    const name = `${figure.dataset.figure}.${kind}`;
    if (kind === "svg") { save(name, [await view.toSVG()], "image/svg+xml"); return; }
    const canvas = await view.toCanvas(3);
    canvas.toBlob((blob) => save(name, [blob], "image/png"));
  }

  function cite(figure) {
    const page = `${root.dataset.site ? location.pathname.split("/").slice(-2).join("/") : location.pathname}`;
    figure.querySelector(".citation").textContent =
      `${document.querySelector(".home").textContent}: ${nameOf(figure)}. ${page}${location.search}. ` +
      document.querySelector("footer p").textContent.trim();
  }

  const charts = all("figure[data-figure]");
  for (const figure of charts) {
    figure.querySelector(".values").addEventListener("toggle", () => tabulate(figure));
    figure.querySelector(".csv").addEventListener("click", async () => {
      await loadCharts();
      const rows = shownRows(figure);
      const columns = columnsOf(rows);
      const words = window.HERIJK_WORDS;
      download(figure.dataset.figure, columns.map((c) => headingOf(words[`column.${c}`] ?? c)),
        rows.map((row) => columns.map((c) => row[c])));
    });
    all(".picture", figure).forEach((button) =>
      button.addEventListener("click", () => savePicture(figure, button.dataset.as)));
    figure.querySelector(".cite").addEventListener("click", () => cite(figure));
  }
  const watcher = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (entry.isIntersecting) { watcher.unobserve(entry.target); start(entry.target); }
    }
  }, { rootMargin: "200px" });

  // -- Begin ------------------------------------------------------------------------------------
  // A headline says what is shown at first: of another choice it would not be true.
  function hideHeadlines() {
    all("section:not(.answer) > .headline").forEach((headline) => { headline.hidden = isOtherChosen(); });
  }

  form?.addEventListener("change", () => {
    selected = null;
    hideHeadlines();
    tables.forEach(filter);
    charts.forEach(redraw);
    writeAddress();
  });
  window.addEventListener("beforeprint", () =>
    charts.filter((figure) => !visible.has(figure) && figure.offsetParent !== null).forEach(start));
  const sorted = readAddress()?.split(".");
  hideHeadlines();
  tables.forEach(filter);
  if (sorted) {
    const header = document.querySelector(`[data-table="${CSS.escape(sorted[0])}"] th[data-c="${CSS.escape(sorted[1])}"]`);
    if (header) sort(header.closest(".table"), header, sorted[2] === "descending");
  }
  writeAddress();
  // What an address points at is opened, so that it can be seen.
  const open = () => { document.getElementById(location.hash.slice(1))?.closest("details")?.setAttribute("open", ""); };
  window.addEventListener("hashchange", open);
  open();
  // The page can be read first; its charts come when the browser has time.
  const later = window.requestIdleCallback ?? ((work) => setTimeout(work, 200));
  window.addEventListener("load", () => later(() => charts.forEach((figure) => watcher.observe(figure))));
})();

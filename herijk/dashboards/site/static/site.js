"use strict";
// Language, tables and charts of every page. Data stand in the page; nothing is fetched.
(() => {
  const root = document.documentElement;
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const form = document.querySelector(".selects");
  const choice = (name) => form?.elements[name]?.value ?? "";

  // -- Language ---------------------------------------------------------------------------------
  const LOCALES = {
    nl: { decimal: ",", thousands: ".", grouping: [3], currency: ["€ ", ""], minus: "-" },
    en: { decimal: ".", thousands: ",", grouping: [3], currency: ["€", ""], minus: "-" },
  };
  // A browser may refuse storage to pages from disk; the choice then lasts as long as the page.
  const stored = {
    get: () => { try { return localStorage.getItem("herijk-language"); } catch { return null; } },
    set: (value) => { try { localStorage.setItem("herijk-language", value); } catch { /* none */ } },
  };

  function setLanguage(language) {
    root.lang = language;
    all("[data-language]").forEach((button) =>
      button.setAttribute("aria-pressed", String(button.dataset.language === language)));
    all("[data-nl]").forEach((element) => {
      const text = element.dataset[language];
      if (element.tagName === "OPTION") element.textContent = text;
      else element.setAttribute("aria-label", text);
    });
    setDecimal(LOCALES[language].decimal);
    all("figure[data-figure]").forEach(redraw);
  }

  let decimal = ","; // as the pages are written

  function setDecimal(mark) {
    if (mark === decimal) return;
    decimal = mark;
    for (const row of [...rowsOfTable.values()].flat()) {
      all("td.n, span.n", row).forEach((cell) => {
        cell.textContent = cell.textContent.replace(/[.,]/, mark);
      });
    }
  }

  // -- Downloads --------------------------------------------------------------------------------
  // Text that a spreadsheet would take for a formula is kept text.
  function csvCell(value) {
    if (value === null || value === undefined) return "";
    let text = String(value);
    if (/^[=+\-@\t\r]/.test(text) && !Number.isFinite(Number(text))) text = `'${text}`;
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  }

  function download(name, header, rows) {
    const text = [header, ...rows].map((row) => row.map(csvCell).join(",")).join("\r\n") + "\r\n";
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(["\ufeff", text], { type: "text/csv" }));
    link.download = `${name}.csv`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  // -- Tables -----------------------------------------------------------------------------------
  // A row that is not shown is not in the document: a browser lays out what is seen.
  const tables = all(".table");
  const rowsOfTable = new Map(tables.map((table) => [table,
    [...table.querySelector("tbody").rows, ...(table.querySelector("template")?.content.children ?? [])]]));
  let selected = null; // boats chosen in a chart, or null

  function filter(table) {
    const words = (table.querySelector(".search")?.value ?? "").toLowerCase().split(/\s+/).filter(Boolean);
    const linked = table.querySelector("table.linked");
    const follows = JSON.parse(table.dataset.follows).map((name) =>
      [name, all("th", table).findIndex((header) => header.dataset.c === name)]);
    const fits = (row) =>
      follows.every(([name, place]) => matches(name, // its cell, or where there is none a mark
        place < 0 ? row.getAttribute(`data-f-${name}`) : valueOf(row.cells[place]))) &&
      words.every((word) => row.textContent.toLowerCase().includes(word)) &&
      (!linked || selected === null || selected.has(row.dataset.boat));
    const shown = rowsOfTable.get(table).filter(fits);
    const body = table.querySelector("tbody");
    const isSame = shown.length === body.rows.length && shown.every((row, i) => row === body.rows[i]);
    if (!isSame) body.replaceChildren(...shown);
    table.querySelector(".count b").textContent = shown.length;
    const clear = table.querySelector(".clear");
    if (clear) clear.hidden = selected === null;
  }

  // What a selector says, or each of several: to see two types side by side. "All" says nothing.
  const chosenOf = (names) => [names].flat().map(choice).filter((text) => text !== "");

  function matches(names, value) {
    const wanted = chosenOf(names);
    return wanted.length === 0 || wanted.includes(String(value));
  }

  // What a cell holds: its text, unless it says otherwise.
  const valueOf = (cell) => cell.dataset.v ?? cell.textContent;

  function sort(table, header) {
    const place = [...header.parentElement.children].indexOf(header);
    const down = header.getAttribute("aria-sort") === "ascending";
    all("th", table).forEach((other) => other.removeAttribute("aria-sort"));
    header.setAttribute("aria-sort", down ? "descending" : "ascending");
    const numeric = header.classList.contains("n");
    const compare = new Intl.Collator("nl", { numeric: true }).compare;
    const rows = rowsOfTable.get(table).map((row) => [valueOf(row.cells[place]), row]);
    rows.sort(([a], [b]) => {
      if (a === "" || b === "") return (a === "") - (b === "");
      const order = numeric ? Number(a) - Number(b) : compare(a, b);
      return down ? -order : order;
    });
    rowsOfTable.set(table, rows.map(([, row]) => row));
    filter(table);
  }

  for (const table of tables) {
    table.querySelector(".search")?.addEventListener("input", () => filter(table));
    table.querySelector(".clear")?.addEventListener("click", () => select(null));
    all("th", table).forEach((header) =>
      header.querySelector("button").addEventListener("click", () => sort(table, header)));
    table.querySelector(".csv").addEventListener("click", () => {
      download(table.dataset.table, all("th", table).map((h) => h.dataset.c),
        all("tbody tr", table).map((row) => [...row.cells].map(valueOf)));
    });
    table.querySelector("table.linked")?.addEventListener("click", (event) => {
      const row = event.target.closest("tbody tr");
      if (row) mark(row.dataset.boat);
    });
  }

  // -- Charts -----------------------------------------------------------------------------------
  const frames = new Map();

  // Columns to rows.
  function asRows(columns) {
    const names = Object.keys(columns);
    const values = names.map((name) => valuesOf(columns[name]));
    return (values[0] ?? []).map((_, i) =>
      Object.fromEntries(names.map((name, j) => [name, values[j][i]])));
  }

  // A column may hold its values once, with the place of each and for how many rows it holds.
  function valuesOf(column) {
    if (Array.isArray(column)) return column;
    const found = [];
    for (let i = 0; i < column.runs.length; i += 2) {
      for (let n = column.runs[i + 1]; n > 0; n -= 1) found.push(column.values[column.runs[i]]);
    }
    return found;
  }

  function rowsOf(name) {
    if (!frames.has(name)) {
      const block = document.querySelector(`script[data-name="${name}"]`);
      frames.set(name, JSON.parse(block.textContent).flatMap(asRows));
    }
    return frames.get(name);
  }

  function shownRows(figure) {
    const follows = Object.entries(JSON.parse(figure.dataset.follows));
    return rowsOf(figure.dataset.data).filter((row) => follows.every(([column, names]) =>
      (row[column] ?? null) === null || matches(names, row[column])));
  }

  // What the selectors say, so that a chart names its tow and method, also in print.
  function picked(figure) {
    return Object.values(JSON.parse(figure.dataset.follows)).flatMap(chosenOf).join(", ");
  }

  const LABELS = 150; // room for axis and legend beside a chart [px]
  const views = new Map(); // figure -> its Vega view
  const visible = new Set();

  async function draw(figure) {
    const place = figure.querySelector(".chart");
    const turn = (figure.turn = (figure.turn ?? 0) + 1);
    const spec = structuredClone(window.HERIJK_FIGURES[root.lang][figure.dataset.figure]);
    const rows = shownRows(figure);
    spec.datasets = { rows };
    fitWidth(spec, figure);
    place.hidden = rows.length === 0;
    figure.querySelector(".picked").textContent =
      picked(figure) + (place.hidden ? `: ${window.HERIJK_WORDS[root.lang].no_values}` : "");
    tabulate(figure);
    views.get(figure)?.finalize();
    views.delete(figure);
    try {
      const made = await window.vegaEmbed(place, spec, {
        actions: false,
        ast: true, // expressions are interpreted: the page forbids eval
        renderer: "svg",
        formatLocale: LOCALES[root.lang],
        loader: { target: "_self" },
        config: {
          axis: { labelFontSize: 12, titleFontSize: 12, labelLimit: 200 },
          legend: { labelFontSize: 12, titleFontSize: 12, labelLimit: 220 },
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

  // The rows of a chart as a table, made when it is opened: for who cannot see the chart.
  function tabulate(figure) {
    const place = figure.querySelector("details");
    if (!place.open) return;
    const words = window.HERIJK_WORDS[root.lang];
    const rows = shownRows(figure);
    const columns = columnsOf(rows);
    const table = document.createElement("table");
    table.createCaption().textContent = figure.dataset[root.lang];
    const head = table.createTHead().insertRow();
    for (const column of columns) {
      const cell = document.createElement("th");
      cell.scope = "col";
      cell.textContent = words[`column.${column}`] ?? column;
      head.append(cell);
    }
    const body = table.createTBody();
    for (const row of rows) {
      const line = body.insertRow();
      for (const column of columns) {
        const value = row[column] ?? "";
        const cell = line.insertCell();
        if (typeof value === "number") cell.className = "i";
        cell.textContent = words[`code.${column}.${value}`] ?? inWords(value, words);
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
    picture.setAttribute("role", "img");
    picture.setAttribute("aria-label", `${figure.dataset[root.lang]} ${picked(figure)}`.trim());
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
  }

  function select(boats) {
    selected = boats;
    tables.forEach(filter);
  }

  // Clicking a row of the list makes its point large in every scatter.
  function mark(boat) {
    for (const row of [...rowsOfTable.values()].flat()) {
      row.classList.toggle("chosen", row.dataset.boat === boat);
    }
    for (const { view } of views.values()) {
      if ("chosen" in view.getState().signals) view.signal("chosen", boat).runAsync();
    }
  }

  function start(figure) {
    visible.add(figure);
    draw(figure);
  }

  const charts = all("figure[data-figure]");
  for (const figure of charts) {
    figure.querySelector("details").addEventListener("toggle", () => tabulate(figure));
    figure.querySelector(".csv").addEventListener("click", () => {
      const rows = shownRows(figure);
      const columns = columnsOf(rows);
      download(figure.dataset.figure, columns, rows.map((row) => columns.map((c) => row[c])));
    });
  }
  const watcher = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (entry.isIntersecting) { watcher.unobserve(entry.target); start(entry.target); }
    }
  }, { rootMargin: "400px" });

  // -- Begin ------------------------------------------------------------------------------------
  all("[data-language]").forEach((button) => button.addEventListener("click", () => {
    stored.set(button.dataset.language);
    setLanguage(button.dataset.language);
  }));
  form?.addEventListener("change", () => {
    selected = null;
    tables.forEach(filter);
    charts.forEach(redraw);
  });
  window.addEventListener("beforeprint", () =>
    charts.filter((figure) => !visible.has(figure)).forEach(start));
  setLanguage(stored.get() === "en" ? "en" : "nl");
  tables.forEach(filter);
  // The scripts of the charts come after this one: the tables need not wait for them.
  document.addEventListener("DOMContentLoaded", () =>
    charts.forEach((figure) => watcher.observe(figure)));
})();

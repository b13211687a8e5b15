"use strict";
// Search, tables and charts of every page. Scripts come from the site; nothing else is fetched.
(() => {
  const { lang: language, dataset: { site, root } } = document.documentElement;
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const make = (tag, properties = {}, ...children) => {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  };
  let form = document.querySelector(".selects");
  const choice = (name) => form?.elements[name]?.value ?? "";
  const [DECIMAL, SEPARATOR] = { nl: [",", ";"], en: [".", ","] }[language]; // as spreadsheets have them
  const plain = (text) => text.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase();
  const wordsOf = (text) => plain(text).split(/\s+/).filter(Boolean);

  // -- Scripts and data, when they are needed ---------------------------------------------------
  const loaded = {};

  function load(path) {
    loaded[path] ??= new Promise((resolve, reject) => {
      const onerror = () => reject(new Error(`${path} cannot be read`));
      document.head.append(make("script", { src: path, onload: resolve, onerror }));
    });
    return loaded[path];
  }

  // What the charts draw: column by column, deflated in a script, as a page from disk loads no other.
  let data = null;

  async function loadCharts() {
    const own = document.body.dataset.data;
    await Promise.all([`${site}static/charts-${language}.js`, `${site}static/vega.js`, own]
      .filter(Boolean).map(load));
    if (data) return;
    const packed = Uint8Array.from(atob(window.HERIJK_DATA), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    data = await new Response(stream).json();
  }

  // -- Search; a word with a typing error is found by its pairs of letters -------------------
  const find = document.querySelector(".find");
  const MOST_FOUND = 12;
  const pairs = (text) => new Set([...text].slice(1).map((letter, i) => text[i] + letter));

  function likeness(text, word) {
    if (/\d/.test(word)) {
      const isIt = (own) => own.replace(/^0+/, "") === word.replace(/^0+/, "");
      return text.split(" ").some(isIt) ? 1 : 0.6 * text.includes(word);
    }
    const own = pairs(text);
    const asked = [...pairs(word)];
    return asked.filter((pair) => own.has(pair)).length / Math.max(asked.length, 1);
  }

  const likenessOfAll = (text, words) => {
    const all = words.map((word) => likeness(text, word));
    return Math.min(...all) < 0.6 ? 0 : all.reduce((sum, one) => sum + one);
  };

  async function search() {
    await load(`${site}static/find.js`);
    const words = wordsOf(find.querySelector("input").value);
    const texts = words.length ? window.HERIJK_FIND.map((one) => [plain(`${one[0]} ${one[1]}`), one]) : [];
    let found = texts.filter(([text]) => words.every((word) => text.includes(word)));
    if (!found.length) {
      found = texts.map(([text, one]) => [likenessOfAll(text, words), one])
        .filter(([like]) => like).sort(([a], [b]) => b - a);
    }
    const list = find.querySelector("ul");
    list.hidden = words.length === 0;
    list.replaceChildren(...found.slice(0, MOST_FOUND).map(([, [name, , page]]) =>
      make("li", {}, make("a", { href: root + page, textContent: name }))));
    if (!found.length) list.append(make("li", { textContent: "\u2013" }));
  }

  find?.addEventListener("input", search);
  find?.addEventListener("submit", (event) => {
    event.preventDefault();
    find.querySelector("li a")?.click();
  });

  // -- The address holds what is chosen -----------------------------------------------------------
  const SELECTS = ".selects select:not([data-asks])"; // the others ask the workbench something else
  const fields = () => all(`${SELECTS}, .tools .search`);
  const defaults = new Map();
  const isOtherChosen = () => all(SELECTS).some((one) => one.value !== defaults.get(one.name));

  function readAddress() {
    const wanted = new URLSearchParams(location.search);
    for (const field of fields().filter(({ name }) => wanted.has(name))) {
      const before = field.value;
      field.value = wanted.get(field.name);
      if (field.value === "") field.value = before; // there is no such choice
    }
  }

  function writeAddress() {
    const asked = new URLSearchParams(location.search);
    for (const { name, value } of fields()) {
      if (value === defaults.get(name)) asked.delete(name);
      else asked.set(name, value);
    }
    const text = asked.toString();
    try {
      history.replaceState(null, "", (text ? `?${text}` : location.pathname) + location.hash);
    } catch { /* a browser may keep a page from disk from changing its address */ }
    const other = document.querySelector(".language");
    other.href = other.getAttribute("href").replace(/\?.*$/, "") + (text ? `?${text}` : "");
  }

  // -- Tables: search, sort, download ---------------------------------------------------------------
  let selected = null; // boats chosen in a chart, or null

  // What selectors say, one or several: to see two types side by side. "All" says nothing.
  function matches(names, value) {
    const wanted = [names].flat().map(choice).filter((text) => text !== "");
    return wanted.length === 0 || [value].flat().some((one) => wanted.includes(String(one)));
  }

  function filter(table) {
    const words = wordsOf(table.querySelector(".search")?.value ?? "");
    const follows = JSON.parse(table.dataset.follows);
    const chosen = JSON.parse(table.dataset.keys)
      .map((key) => key.every((value, i) => matches(follows[i], value)));
    const rows = all("tbody tr", table);
    for (const row of rows) {
      const text = words.length ? plain(row.textContent) : "";
      row.hidden = !((chosen[row.dataset.k] ?? true) && words.every((word) => text.includes(word))
        && (selected === null || !row.dataset.boat || selected.has(row.dataset.boat)));
    }
    table.querySelector(".count b").textContent = rows.filter((row) => !row.hidden).length;
    const clear = table.querySelector(".clear");
    if (clear) clear.hidden = selected === null;
  }

  function valueOf(cell) {
    if (cell.className) return cell.textContent;
    const text = cell.textContent.replace(DECIMAL, ".").replace("\u2212", "-");
    return text === "" ? "" : Number(text);
  }

  function sort(table, header) {
    const down = header.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    all("th", table).forEach((other) => other.removeAttribute("aria-sort"));
    header.setAttribute("aria-sort", down < 0 ? "descending" : "ascending");
    const place = [...header.parentElement.children].indexOf(header);
    const { compare } = new Intl.Collator("nl", { numeric: true });
    const rows = all("tbody tr", table).map((row) => [valueOf(row.cells[place]), row]);
    rows.sort(([a], [b]) => {
      if (a === "" || b === "") return (a === "") - (b === "");
      return down * (typeof a === "number" ? a - b : compare(a, b));
    });
    table.querySelector("tbody").append(...rows.map(([, row]) => row));
  }

  // Text that a spreadsheet would take for a formula, also after a separator of another language,
  // is kept text.
  function csvCell(value) {
    if (typeof value === "number") return String(value).replace(".", DECIMAL);
    const text = value.replace(/[\u00ad\u200b]/g, "").trim().replace(/(^|[;,\t\r\n])(\s*)([=+\-@])/g, "$1$2'$3");
    return /[",;\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  }

  function download(table) {
    const rows = all("tbody tr", table).filter((row) => !row.hidden);
    const lines = [all("th", table).map((head) => head.textContent),
      ...rows.map((row) => [...row.cells].map(valueOf))];
    const text = `\ufeff${lines.map((line) => line.map(csvCell).join(SEPARATOR)).join("\r\n")}\r\n`;
    const href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    make("a", { href, download: `${table.dataset.table}.csv` }).click();
    setTimeout(() => URL.revokeObjectURL(href), 1000);
  }

  document.addEventListener("click", ({ target }) => {
    const table = target.closest(".table");
    if (target.matches(".sort")) sort(table, target.parentElement);
    if (target.matches(".csv")) download(table);
    if (target.matches(".clear")) select(null);
  });
  document.addEventListener("input", ({ target }) => {
    if (!target.matches(".tools .search")) return;
    filter(target.closest(".table"));
    writeAddress();
  });

  // -- Charts ---------------------------------------------------------------------------------------
  const views = new Map(); // figure -> its Vega view

  const asRows = (columns) => (Object.values(columns)[0] ?? []).map((_, i) =>
    Object.fromEntries(Object.entries(columns).map(([name, values]) => [name, values[i]])));

  // Rows that the selectors say; one of several methods is here for the one that is chosen.
  function rowsOf(name, figure) {
    const follows = Object.entries(JSON.parse(figure.dataset.follows));
    const own = data.charts[name].flatMap(asRows).filter((row) => follows.every(([column, names]) =>
      (row[column] ?? null) === null || matches(names, row[column])));
    return own.map((row) => Object.fromEntries(Object.entries(row).map(([column, value]) =>
      [column, Array.isArray(value) ? choice(column) || value[0] : value])));
  }

  // What the selectors say, so that a chart names its tow and method, also in print.
  function picked(figure) {
    const names = Object.values(JSON.parse(figure.dataset.follows)).flat();
    return names.map((name) => form?.elements[name]?.selectedOptions?.[0])
      .filter((option) => option?.value).map((option) => option.textContent.trim()).join(", ");
  }

  // A chart is as wide as its text; small multiples share that width.
  const BESIDE = 60; // room for an axis beside panels [px]

  function fit(spec, room) {
    const isNarrow = room < 550;
    spec.config.legend = { ...spec.config.legend, columns: isNarrow ? 1 : 3 };
    for (const part of (spec.vconcat ?? [spec]).filter(({ facet }) => facet)) {
      if (isNarrow) part.columns = part.spec.width > 200 ? 1 : 2;
      part.spec.width = (room - BESIDE) / part.columns - 25;
    }
    if (!spec.facet && !spec.vconcat) {
      Object.assign(spec, { width: room, autosize: { type: "fit-x", contains: "padding" } });
    }
    if (isNarrow) spec.config.axisY = { ...spec.config.axisY, labelLimit: 130 };
  }

  async function draw(figure) {
    const place = figure.querySelector(".chart");
    const turn = (figure.turn = (figure.turn ?? 0) + 1);
    await loadCharts();
    await document.fonts.load('12px "Open Sans"'); // labels are measured with it
    if (turn !== figure.turn) return;
    const words = window.HERIJK_WORDS;
    const { figure: name, caption, data: source } = figure.dataset;
    const spec = structuredClone(window.HERIJK_FIGURES[name]);
    const rows = rowsOf(source, figure);
    spec.datasets = { rows };
    fit(spec, figure.clientWidth);
    place.hidden = rows.length === 0;
    figure.querySelector(".picked").textContent = picked(figure) + (rows.length ? "" : `: ${words.no_values}`);
    tabulate(figure, rows, words);
    const made = await window.vegaEmbed(place, spec, {
      actions: { export: true, source: false, compiled: false, editor: false },
      i18n: { CLICK_TO_VIEW_ACTIONS: words.picture, PNG_ACTION: "PNG", SVG_ACTION: "SVG" },
      downloadFileName: name, ast: true, // expressions are interpreted: the page forbids eval
      renderer: "svg", formatLocale: window.HERIJK_LOCALE, loader: { target: "_self" },
      config: { aria: false, mark: { aria: false } }, // the picture is described as a whole
    });
    views.get(figure)?.finalize();
    views.set(figure, made);
    const picture = place.querySelector("svg.marks");
    all("[role]", picture).forEach((part) => part.removeAttribute("role")); // of a brush
    picture.setAttribute("role", "img");
    picture.setAttribute("aria-label", `${caption} ${picked(figure)}`.trim());
    place.querySelector("summary").setAttribute("aria-label", `${words.picture}: ${caption}`);
    place.querySelector("summary svg").setAttribute("aria-hidden", "true");
    if (spec.params?.some((one) => one.name === "brush")) link(made.view, rows);
    place.classList.add("drawn");
  }

  // Dragging over a scatter chooses boats for the list.
  function link(view, rows) {
    view.addDataListener("brush_store", (_, [brush]) => {
      const inside = (row) => brush.fields.every(({ field }, i) => {
        const [low, high] = [...brush.values[i]].sort((a, b) => a - b);
        const value = row[field.replace("_seen", "")];
        return value !== null && value >= low && value <= high;
      });
      select(brush ? new Set(rows.filter(inside).map((row) => row.fsn_no)) : null);
    });
  }

  function select(boats) {
    selected = boats;
    all(".table").forEach(filter);
  }

  // The rows of a chart as a table, for people who cannot see it or want its numbers.
  function tabulate(figure, rows, words) {
    const table = figure.querySelector(".values .table");
    const columns = [...new Set(rows.flatMap(Object.keys))].filter((column) => !["page", "kind"].includes(column));
    table.querySelector("thead").replaceChildren(make("tr", {}, ...columns.map((column) =>
      make("th", { scope: "col" }, make("button", { type: "button", className: "sort", textContent: words[`column.${column}`] ?? column })))));
    table.querySelector("tbody").replaceChildren(...rows.map((row) => make("tr", {}, ...columns.map((column) => {
      const value = row[column] ?? "";
      const word = words[`code.${column}.${value}`] ?? words[`${column}.${value}`];
      if (typeof value === "number" && !word) {
        return make("td", { textContent: String(Number(value.toPrecision(5))).replace(".", DECIMAL) });
      }
      return make("td", { className: "t", textContent: word ?? words[`code.${value}`] ?? words[value] ?? value });
    }))));
    filter(table);
  }

  const watcher = new IntersectionObserver((entries) => {
    for (const { target } of entries.filter(({ isIntersecting }) => isIntersecting)) {
      watcher.unobserve(target);
      draw(target);
    }
  }, { rootMargin: "200px" });

  // -- Begin ------------------------------------------------------------------------------------
  // A headline says what is shown at first: of another choice it would not be true.
  function choose() {
    all("section:not(.answer) > .headline").forEach((headline) => { headline.hidden = isOtherChosen(); });
    selected = null;
    all(".table").forEach(filter);
    [...views.keys()].forEach(draw);
  }

  // Starts the tables and charts of a part of the page; the workbench has its data in the part.
  function start(part) {
    const own = part.querySelector("#data");
    if (own) data = JSON.parse(own.textContent);
    form = document.querySelector(".selects");
    fields().forEach(({ name, value }) => defaults.set(name, value));
    readAddress();
    views.forEach((made) => made.finalize());
    views.clear();
    all("figure[data-figure]", part).forEach((figure) => watcher.observe(figure));
    choose();
  }

  document.addEventListener("change", ({ target }) => {
    if (target.matches(SELECTS)) { choose(); writeAddress(); }
  });
  window.addEventListener("beforeprint", () => all("figure[data-figure]")
    .filter((figure) => !views.has(figure) && figure.offsetParent).forEach(draw));
  // What an address points at is opened, so that it can be seen.
  const open = () => document.getElementById(location.hash.slice(1))?.closest("details")?.setAttribute("open", "");
  window.addEventListener("hashchange", open);
  window.herijk = { start };
  start(document);
  open();
})();

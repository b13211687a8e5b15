"use strict";
// Selectors, tables and the search of every page. Without this script all is there, at its first choice.
(() => {
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const { lang, dataset: { root } } = document.documentElement;
  const plain = (text) => text.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase();
  const has = (text, words) => plain(words).split(/\s+/).every((word) => text.includes(word));
  const [DECIMAL, SEPARATOR] = lang === "nl" ? [",", ";"] : [".", ","]; // as spreadsheets have them

  // What selectors say is shown of all that is chosen by them; the address holds it.
  const own = () => all(".selects select:not([data-asks])"); // the others ask the workbench something else
  let selects = own();
  let first = new Map();
  const isChosen = (part) => selects.every(({ name, value }) =>
    part.dataset[name] === undefined || part.dataset[name].split("|").includes(value));

  const isShown = (row) => !row.hidden && !row.parentElement.hidden;

  function show() {
    selects = own();
    const chosen = selects.map(({ name }) => `[data-${name}]`).join();
    if (chosen) for (const part of all(chosen)) part.toggleAttribute("hidden", !isChosen(part)); // of a picture, too
    for (const table of all(".table")) {
      const words = table.querySelector("[type=search]")?.value ?? "";
      for (const row of all("tbody tr", table)) row.hidden = !has(plain(row.textContent), words);
      table.querySelector(".tools b").textContent = all("tbody tr", table).filter(isShown).length;
    }
    const isFirst = selects.every(({ name, value }) => first.get(name) === value);
    for (const said of all("main [data-said]")) said.classList.toggle("unseen", !isFirst && !said.closest(".answer"));
  }

  function keep() {
    const asked = new URLSearchParams(location.search);
    for (const { name, value } of selects) {
      if (first.get(name) === value) asked.delete(name);
      else asked.set(name, value);
    }
    try { history.replaceState(null, "", `?${asked}${location.hash}`); } catch { /* of a page from disk it may not change */ }
    for (const other of all(".language")) other.search = asked; // where there is another one
  }

  // Tables: what needs this script, it adds. A click on a heading sorts; the headings of texts have a class.
  function equip(table) {
    const make = (tag, own, ...parts) => { const made = Object.assign(document.createElement(tag), own); made.append(...parts); return made; };
    const { search, rows, csv } = document.documentElement.dataset;
    const tools = make("div", { className: "tools" });
    if ("search" in table.dataset) tools.append(make("label", {}, `${search} `, make("input", { type: "search", autocomplete: "off" })));
    const count = make("span", {}, `${rows} `, make("b"));
    count.setAttribute("role", "status");
    tools.append(count, make("button", { type: "button", className: "csv", title: csv }, "CSV"));
    table.prepend(tools);
    for (const head of all("thead th", table)) head.append(make("button", { type: "button" }, ...head.childNodes));
  }

  function value(cell) {
    const isText = cell.closest("table").tHead.rows[0].cells[cell.cellIndex].classList.contains("t");
    if (isText || cell.textContent === "") return cell.textContent;
    const number = Number(cell.textContent.replace(DECIMAL, ".").replace("\u2212", "-").replace(/[\u00a0%]/g, ""));
    return Number.isNaN(number) ? cell.textContent : number;
  }

  function sort(head) {
    const down = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", down < 0 ? "descending" : "ascending");
    const { compare } = new Intl.Collator(lang, { numeric: true });
    const order = (a, b) => (a === "" || b === "" ? (a === "") - (b === "") : down * (typeof a === "number" && typeof b === "number" ? a - b : compare(a, b)));
    for (const body of head.closest("table").tBodies) body.append(...[...body.rows].map((row) => [value(row.cells[head.cellIndex]), row]).sort(([a], [b]) => order(a, b)).map(([, row]) => row));
  }

  function download(table) { // a text that a spreadsheet would take for a formula is kept text
    const cell = (text) => (typeof text === "number" ? String(text).replace(".", DECIMAL)
      : `"${text.replace(/\u00ad/g, "").replace(/(^|[;,\t\r\n])(\s*)([=+\-@])/g, "$1$2'$3").replaceAll('"', '""')}"`);
    const rows = all("tr", table).filter(isShown).map((row) => [...row.cells].map(value).map(cell).join(SEPARATOR));
    const href = URL.createObjectURL(new Blob([`\ufeff${rows.join("\r\n")}\r\n`], { type: "text/csv" }));
    Object.assign(document.createElement("a"), { href, download: `${document.title}.csv` }).click();
  }

  document.addEventListener("change", ({ target }) => { if (target.matches(".selects select:not([data-asks])")) { show(); keep(); } });
  document.addEventListener("input", ({ target }) => { if (target.matches(".tools [type=search]")) show(); });
  document.addEventListener("click", ({ target }) => {
    if (target.matches("th button")) sort(target.parentElement);
    if (target.matches(".csv")) download(target.closest(".table"));
  });

  // A night that did not run makes nothing: the page about the last run says itself that it is old.
  const OLD_MS = 36 * 3600 * 1000;
  for (const warning of all("[data-ended]")) warning.hidden = Date.now() - Date.parse(warning.dataset.ended) < OLD_MS;

  // The search for a boat, type or race. A word with a typing error is found by its pairs of letters.
  const form = document.querySelector("header form");
  const MOST_FOUND = 12;
  const LEAST_LIKENESS = 0.6; // share of a word's pairs of letters
  const pairs = (text) => [...text].slice(1).map((letter, i) => text[i] + letter);
  const texts = () => (window.FIND ?? []).map((one) => [plain(`${one[0]} ${one[1]}`), one]);

  function likeness(text, word) {
    if (/\d/.test(word)) { // a number is right or it is not
      const isIt = (own) => own.replace(/^0+/, "") === word.replace(/^0+/, "");
      return text.split(" ").some(isIt) ? 1 : LEAST_LIKENESS * text.includes(word);
    }
    const own = new Set(pairs(text));
    const asked = pairs(word);
    return asked.filter((pair) => own.has(pair)).length / Math.max(asked.length, 1);
  }

  function search(words) {
    const found = texts().filter(([text]) => words.every((word) => text.includes(word)));
    if (found.length) return found.map(([, one]) => one);
    return texts().map(([text, one]) => [words.map((word) => likeness(text, word)), one])
      .filter(([like]) => Math.min(...like) >= LEAST_LIKENESS)
      .sort(([a], [b]) => Math.min(...b) - Math.min(...a)).map(([, one]) => one);
  }

  form?.addEventListener("submit", (event) => { event.preventDefault(); form.querySelector("a")?.click(); });
  form?.addEventListener("input", () => {
    const list = form.querySelector("ul");
    const words = plain(form.querySelector("input").value).split(/\s+/).filter(Boolean);
    const found = words.length ? search(words).slice(0, MOST_FOUND) : [];
    list.hidden = !words.length;
    list.replaceChildren(...found.map(([name, , page]) => {
      const item = document.createElement("li");
      item.append(Object.assign(document.createElement("a"), { href: root + page, textContent: name }));
      return item;
    }));
    if (!found.length) list.append(Object.assign(document.createElement("li"), { textContent: "\u2013" }));
  });

  // A card about one's own boat leads to the search.
  for (const card of all(".to-find")) card.addEventListener("click", (event) => {
    event.preventDefault();
    form?.querySelector("input").focus();
  });
  // A card, which a phone shows in place of a row, names what its cells hold.
  function label(table) {
    const titles = all("thead th", table).map((head) => head.textContent.replaceAll("\u00ad", ""));
    for (const row of all("tbody tr", table)) for (const cell of row.cells) cell.dataset.label = titles[cell.cellIndex];
  }

  function start() {
    all(".table:not(:has(.tools))").forEach(equip);
    all("table.cards").forEach(label);
    selects = own();
    first = new Map(selects.map((one) => [one.name, one.value]));
    const asked = new URLSearchParams(location.search);
    for (const one of selects) if ([...one.options].some((option) => option.value === asked.get(one.name))) one.value = asked.get(one.name);
    show();
    if (location.search) keep();
  }

  start();
  window.herijk = { start };
  document.getElementById(location.hash.slice(1))?.closest("details")?.setAttribute("open", "");
})();

"use strict";
// The workbench: controls made from the model of a method, answers from the server as data.
// One question at a time is on its way; of those that come meanwhile only the last is asked.
(() => {
  const root = document.documentElement;
  const start = JSON.parse(document.getElementById("start").textContent);
  const byId = (id) => document.getElementById(id);
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];

  function make(tag, properties = {}, ...children) {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  }

  // -- Texts ------------------------------------------------------------------------------------
  const LANGUAGES = ["nl", "en"];
  const pair = (key) => start.words[key] ?? [key, key].map((k) => k.split(".").at(-1));
  const word = (key) => pair(key)[LANGUAGES.indexOf(root.lang)];
  const code = (value) => (start.words[`code.${value}`] ? word(`code.${value}`) : String(value));

  // A text in both languages; the style sheet hides the one that is not chosen.
  function say(key) {
    const [nl, en] = pair(key);
    return make("span", {}, make("span", { lang: "nl" }, nl), make("span", { lang: "en" }, en));
  }

  function number(value, digits, sign = false) {
    const text = value.toFixed(digits);
    return (sign && value > 0 ? "+" : "") + (root.lang === "nl" ? text.replace(".", ",") : text);
  }

  function seasonsText(first, last) {
    if (last >= 9999) return make("span", {}, `${first} `, say("and_later"));
    return make("span", {}, first === last ? `${first}` : `${first}-${last}`);
  }

  // -- The method on trial ----------------------------------------------------------------------
  let source = { name: start.base }; // the base as the server knows it
  let base = null; // its name, title and ranges
  let steps = []; // of each range
  let shownControls = []; // functions that show the state in a control

  const everywhere = () => steps.map((_, place) => place);

  function held(step, option, places) {
    const values = places.map((place) => steps[place][step][option]);
    const same = values.every((v) => JSON.stringify(v) === JSON.stringify(values[0]));
    return { same, value: values[0] };
  }

  function change(step, option, places, value) {
    for (const place of places) steps[place][step][option] = value;
    refresh();
    ask();
  }

  const refresh = () => shownControls.forEach((show) => show());

  async function load(wanted) {
    const found = await post("base", wanted);
    if (!found) return;
    source = wanted;
    base = found;
    steps = base.ranges.map((range) => structuredClone(range.steps));
    buildForm();
    ask();
  }

  const wide = window.matchMedia("(min-width: 60rem)"); // as in the style sheet

  // -- Controls ---------------------------------------------------------------------------------
  let made = 0;
  const newId = () => `c${(made += 1)}`;

  const mixed = () => make("span", { className: "mixed" }, say("differs"));

  function labelOf(step, control) {
    const label = make("span", { className: "label" }, say(`${step}.${control.option}`));
    if (control.unit) label.append(` [${control.unit}]`);
    return label;
  }

  const KINDS = {
    choice(step, control, places) {
      const name = newId();
      const note = mixed();
      const inputs = control.values.map((value) =>
        make("input", { type: "radio", name, onchange: () =>
          change(step, control.option, places, value) }));
      const choices = inputs.map((input, i) =>
        make("label", {}, input, say(`choice.${control.values[i]}`)));
      shownControls.push(() => {
        const { same, value } = held(step, control.option, places);
        inputs.forEach((input, i) => { input.checked = same && control.values[i] === value; });
        note.hidden = same;
      });
      return make("fieldset", { className: "option choice" },
        make("legend", {}, labelOf(step, control), note), ...choices);
    },

    number(step, control, places) {
      const id = newId();
      const note = mixed();
      const set = (text) => {
        if (text !== "" && Number.isFinite(Number(text))) {
          change(step, control.option, places, Number(text));
        }
      };
      const bounds = { min: control.least, max: control.most };
      const slider = make("input", { type: "range", ...bounds, step: control.by,
        oninput: () => set(slider.value) });
      const exact = make("input", { type: "number", id, ...bounds, step: control.whole ? 1 : "any",
        oninput: () => set(exact.value) });
      const label = make("label", { htmlFor: id, id: `${id}l` }, labelOf(step, control), note);
      slider.setAttribute("aria-labelledby", label.id);
      shownControls.push(() => {
        const { same, value } = held(step, control.option, places);
        slider.value = value;
        if (document.activeElement !== exact) exact.value = same ? value : "";
        note.hidden = same;
      });
      return make("div", { className: "option number" }, label, slider, exact);
    },

    several(step, control, places) {
      const note = make("span", { className: "mixed" });
      const inputs = control.values.map((value) => make("input", { type: "checkbox", value,
        onchange: () => change(step, control.option, places,
          inputs.filter((i) => i.checked).map((i) => i.value)) }));
      shownControls.push(() => {
        const { same, value } = held(step, control.option, places);
        inputs.forEach((input) => { input.checked = same && value.includes(input.value); });
        note.replaceChildren(same ? (value.length ? `${value.length}` : say("nothing"))
          : say("differs"));
      });
      const choices = inputs.map((input) => make("label", {}, input, say(`code.${input.value}`)));
      return make("details", { className: "option several" },
        make("summary", {}, labelOf(step, control), note), ...choices);
    },

    fixed(step, control, places) {
      const shown = make("output");
      shownControls.push(() => {
        const { same, value } = held(step, control.option, places);
        shown.replaceChildren(same ? JSON.stringify(value) : say("differs"));
      });
      return make("div", { className: "option" }, labelOf(step, control), " ", shown, " (",
        say("fixed"), ")");
    },
  };

  function optionsOf(step, places) {
    return step.options.map((control) => {
      const element = KINDS[control.kind](step.step, control, places);
      element.dataset.option = `${step.step}.${control.option}`;
      return element;
    });
  }

  function buildForm() {
    shownControls = [];
    byId("steps").replaceChildren(...start.controls.map((step) =>
      make("details", { className: "step", open: wide.matches },
        make("summary", { title: step.meaning }, say(`step.${step.step}`)),
        ...optionsOf(step, everywhere()), perSeason(step))));
    refresh();
  }

  // The same controls once for every range of seasons; made when they are asked for.
  function perSeason(step) {
    const details = make("details", { className: "seasons" },
      make("summary", {}, say("per_season")));
    details.addEventListener("toggle", () => {
      for (const [place, range] of base.ranges.entries()) {
        const legend = make("legend", {}, seasonsText(range.first, range.last));
        if (!range.seasons.length) legend.append(" (", say("no_tows"), ")");
        details.append(make("fieldset", { className: "season" }, legend,
          ...optionsOf(step, [place])));
      }
      refresh();
    }, { once: true });
    return details;
  }

  // -- Questions --------------------------------------------------------------------------------
  let answer = null; // the last one shown
  let asked = false; // a question waits
  let busy = false; // one is on its way
  let since = 0; // when the last change was made

  const complaints = new Map(); // path -> why the last question there has no answer

  function complain(path, message = "", where = "") {
    complaints.set(path, message);
    const texts = [...complaints.values()].filter(Boolean);
    byId("refused").hidden = !texts.length;
    byId("refused").replaceChildren(...texts.map((text) => make("p", {}, say("refused"), ` ${text}`)));
    if (path !== "answer") return;
    for (const element of all("[data-option]")) {
      const wrong = element.dataset.option === where;
      element.classList.toggle("wrong", wrong);
      all("input", element).forEach((input) => input.setAttribute("aria-invalid", String(wrong)));
    }
  }

  // What the server says, or null after telling why there is nothing.
  async function post(path, body) {
    let response;
    try {
      response = await fetch(path, { method: "POST", body: JSON.stringify(body),
        headers: { "Content-Type": "application/json" } });
    } catch {
      complain(path, word("gone"));
      return null;
    }
    if (!response.ok) { complain(path, word("failed")); return null; }
    const found = await response.json();
    complain(path, found.refused, found.where);
    return found.refused ? null : found;
  }

  async function ask() {
    asked = true;
    since = performance.now();
    if (busy) return;
    busy = true;
    root.setAttribute("aria-busy", "true");
    byId("state").replaceChildren(say("busy"));
    while (asked) {
      asked = false;
      const found = await post("answer", { base: source, steps, against: byId("against").value,
        boat: byId("boat").value });
      if (asked) continue;
      if (found) { answer = found; await show(); }
      const seconds = (performance.now() - since) / 1000;
      root.dataset.seconds = seconds;
      byId("state").replaceChildren(...(found ? [`${start.tows} `, say("tows_in_all"), ". ",
        say("done_in"), ` ${number(seconds, 1)} s.`] : []));
    }
    busy = false;
    root.setAttribute("aria-busy", "false");
  }

  // -- Answers ----------------------------------------------------------------------------------
  async function show() {
    showChanges();
    showSummary();
    fillSelect(byId("tow"), [...new Set(answer.boat_curves.map((row) => row.tow_id))].reverse());
    tables.forEach(fill);
    for (const figure of figures) await draw(figure);
  }

  function showChanges() {
    const items = answer.changed_options.map((d) => make("li", {},
      make("b", {}, say(`step.${d.step}`)), ", ", say(`${d.step}.${d.option}`), ": ",
      ...joined(d.before.map(valueOf)), " → ", valueOf(d.after), " (",
      isWhole(d) ? say("all_seasons") : seasonsText(d.first, d.last), ")"));
    byId("changed").replaceChildren(...(items.length ? items
      : [make("li", {}, say("nothing_changed"))]));
    byId("reset").hidden = !items.length;
  }

  const isWhole = (d) => d.first === base.ranges[0].first && d.last === base.ranges.at(-1).last;
  const joined = (parts) => parts.flatMap((part, i) => (i ? ["; ", part] : [part]));

  function valueOf(value) {
    if (Array.isArray(value)) {
      return value.length ? make("span", {}, ...joined(value.map((v) => say(`code.${v}`))))
        : say("nothing");
    }
    return typeof value === "number" ? make("span", {}, `${value}`) : say(`choice.${value}`);
  }

  function showSummary() {
    const s = answer.summary;
    const [before, after] = [answer.before, start.trial].map((method) =>
      answer.reproducibility.find((row) => row.method === method && row.scope === "all"));
    const per_cent = (v) => (v === null ? "-" : `${number(100 * v, 1)} %`);
    const tiles = [
      ["count_changed", `${s.changed} / ${s.lines}`],
      ["count_gains", `${s.gains}`],
      ["count_loses", `${s.loses}`],
      ...(s.added ? [["count_added", `${s.added}`]] : []),
      ...(s.removed ? [["count_removed", `${s.removed}`]] : []),
      ["median_cw", s.median_ratio === null ? "-" : number(s.median_ratio, 4)],
      ...[["within_1", "share_within_1pct"], ["within_2", "share_within_2pct"],
        ["sd_tow", "sd_ratio"]].map(([key, column]) =>
        [key, per_cent(after?.[column] ?? null), per_cent(before?.[column] ?? null)]),
    ];
    byId("summary").replaceChildren(...tiles.map(([key, value, was]) => make("div",
      { id: key }, make("dt", {}, say(key)), make("dd", {}, value,
        ...(was ? [make("small", {}, " ", say("was"), ` ${was}`)] : [])))));
  }

  // -- Tables -----------------------------------------------------------------------------------
  const tables = all(".table");
  const order = new Map(); // table -> [column, direction]

  function rowsOf(table) {
    const name = table.dataset.table;
    const words = (table.querySelector(".search")?.value ?? "").toLowerCase().split(/\s+/);
    const rows = answer[name].filter((row) => {
      const text = Object.values(row).join(" ").toLowerCase();
      return words.every((part) => text.includes(part));
    });
    if (!order.has(name)) return rows;
    const [column, direction] = order.get(name);
    const compare = new Intl.Collator("nl", { numeric: true }).compare;
    const empty = (v) => v === null;
    return rows.sort(({ [column]: a }, { [column]: b }) => {
      if (empty(a) || empty(b)) return empty(a) - empty(b);
      return direction * (typeof a === "number" ? a - b : compare(a, b));
    });
  }

  function fill(table) {
    const columns = start.columns[table.dataset.table];
    table.querySelector("thead").replaceChildren(make("tr", {}, ...columns.map((column) =>
      header(table, column))));
    const rows = rowsOf(table);
    table.querySelector("tbody").replaceChildren(...rows.map((row) => {
      const line = make("tr", {}, ...columns.map((column) => cell(row, column)));
      line.classList.toggle("chosen", row.fsn_no !== undefined && row.fsn_no === byId("boat").value);
      return line;
    }));
    table.querySelector(".count b").textContent = rows.length;
  }

  function header(table, column) {
    const name = table.dataset.table;
    const [sorted, direction] = order.get(name) ?? [];
    const turn = () => {
      order.set(name, [column, sorted === column ? -direction : 1]);
      fill(table);
      table.querySelector(`th[data-c="${column}"] button`).focus();
    };
    const element = make("th", { scope: "col" },
      make("button", { type: "button", className: "sort", onclick: turn }, say(`column.${column}`)));
    element.dataset.c = column;
    if (answer[name].some((row) => typeof row[column] === "number")) element.className = "n";
    if (sorted === column) {
      element.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
    }
    return element;
  }

  const digitsOf = (column) =>
    (start.digits.find(([ending]) => column.endsWith(ending)) ?? ["", 4])[1];

  function cell(row, column) {
    const value = row[column];
    if (value === null) return make("td");
    if (column === "fsn_no") {
      return make("td", {}, make("button", { type: "button", className: "to-boat",
        onclick: () => chooseBoat(value) }, value));
    }
    if (typeof value === "boolean") return make("td", {}, say(value ? "yes" : "no"));
    if (typeof value === "number") {
      const text = Number.isInteger(value) ? `${value}`
        : number(value, digitsOf(column), column.startsWith("gain"));
      return make("td", { className: "n" }, text);
    }
    const codes = Array.isArray(value) ? value : [value];
    return make("td", {}, codes.map(code).join(", "));
  }

  // Text that a spreadsheet would take for a formula is kept text.
  function csvCell(value) {
    if (value === null || value === undefined) return "";
    let text = Array.isArray(value) ? value.join(" ") : String(value);
    if (/^[=+\-@\t\r]/.test(text) && !Number.isFinite(Number(text))) text = `'${text}`;
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  }

  function download(name, text, type) {
    const link = make("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  function downloadRows(name, columns, rows) {
    const lines = [columns, ...rows.map((row) => columns.map((column) => row[column]))];
    const text = lines.map((line) => line.map(csvCell).join(",")).join("\r\n");
    download(`${name}.csv`, `\ufeff${text}\r\n`, "text/csv");
  }

  // -- Charts -----------------------------------------------------------------------------------
  const figures = all("figure[data-figure]");
  const views = new Map(); // figure -> its Vega view
  const LOCALES = {
    nl: { decimal: ",", thousands: ".", grouping: [3], currency: ["€ ", ""], minus: "-" },
    en: { decimal: ".", thousands: ",", grouping: [3], currency: ["€", ""], minus: "-" },
  };

  const toBoat = (row) => ({ ...row, page: "#boat" }); // a point of a boat leads to the boat

  const ROWS = {
    changed: () => answer.register.filter((row) => row.change === "changed").map(toBoat),
    types: (side) => answer.types.filter((row) =>
      row.method === (side === "before" ? answer.before : start.trial)
      && ["", row.boat_type].includes(byId("boat_type").value)).map(toBoat),
    boat_figure: () => answer.boat_figure.filter((row) => row.tow_id === byId("tow").value),
  };

  const figureRows = ({ dataset: { data, side } }) => (ROWS[data] ?? (() => answer[data]))(side);

  async function draw(figure) {
    const rows = figureRows(figure);
    if (views.has(figure)) {
      await views.get(figure).view.data("rows", structuredClone(rows)).runAsync();
      return;
    }
    const spec = structuredClone(window.HERIJK_FIGURES[root.lang][figure.dataset.figure]);
    spec.datasets = { rows: structuredClone(rows) };
    const columns = wide.matches ? 2 : 1;
    spec.width = Math.max(Math.min(spec.width, byId("results").clientWidth / columns - 110), 190);
    spec.height = Math.min(spec.height, 260);
    const place = figure.querySelector(".chart");
    const drawn = await window.vegaEmbed(place, spec, {
      actions: false, renderer: "svg", formatLocale: LOCALES[root.lang],
      config: { legend: { labelFontSize: 12, titleFontSize: 12, labelLimit: 220,
        orient: "bottom", columns: columns + 1 },
        axis: { labelFontSize: 12, titleFontSize: 12, labelLimit: 200 } },
    });
    drawn.view.addEventListener("click", (_, item) => {
      if (item?.datum?.fsn_no) chooseBoat(item.datum.fsn_no);
    });
    const picture = place.querySelector("svg");
    picture.setAttribute("role", "img");
    picture.setAttribute("aria-label", figure.dataset[root.lang]);
    views.set(figure, drawn);
  }

  function forgetCharts() {
    views.forEach((drawn) => drawn.finalize());
    views.clear();
  }

  // -- Choices and buttons ----------------------------------------------------------------------
  function fillSelect(select, values, texts = values) {
    const chosen = select.value;
    select.replaceChildren(...values.map((value, i) => make("option", { value }, texts[i])));
    if (values.includes(chosen)) select.value = chosen;
  }

  function group(key, names) {
    const element = make("optgroup", {}, ...names.map((name) => make("option", { value: name }, name)));
    [element.dataset.nl, element.dataset.en] = pair(key);
    return element;
  }

  function fillSources() {
    const groups = [["group_methods", start.methods], ["group_saved", start.saved]];
    byId("base").replaceChildren(...groups.filter(([, n]) => n.length).map((g) => group(...g)));
    const old = [["group_methods", start.methods], ["group_editions", start.editions]];
    byId("against").replaceChildren(...old.filter(([, n]) => n.length).map((g) => group(...g)));
    setLanguage(root.lang);
  }

  function chooseBoat(fsn_no) {
    byId("boat").value = fsn_no;
    byId("boat").dispatchEvent(new Event("change"));
    byId("boat").scrollIntoView({ block: "center" });
  }

  function setLanguage(language) {
    root.lang = language;
    localStorage.setItem("herijk-language", language);
    all("[data-language]").forEach((button) =>
      button.setAttribute("aria-pressed", String(button.dataset.language === language)));
    all("[data-nl]").forEach((element) => {
      const text = element.dataset[language];
      if (element.tagName === "OPTGROUP") element.label = text;
      else if (element.tagName === "OPTION") element.textContent = text;
      else element.setAttribute("aria-label", text);
    });
    document.title = word("workbench");
    if (answer) { forgetCharts(); show(); }
  }

  const wished = () => ({ base: source, steps, name: byId("name").value,
    title: byId("title").value, reason: byId("reason").value });

  const isNamed = () => ["name", "title", "reason"].every((id) => byId(id).reportValidity());

  byId("save").addEventListener("click", async () => {
    byId("saved").replaceChildren();
    if (!isNamed()) return;
    const found = await post("save", wished());
    if (!found) return;
    byId("saved").replaceChildren(say("saved_as"), make("br"), make("code", {}, found.command));
    start.saved = [...start.saved, byId("name").value].sort();
    const { base: from, against } = Object.fromEntries(["base", "against"].map((id) => [id, byId(id).value]));
    fillSources();
    byId("base").value = from;
    byId("against").value = against;
  });
  byId("download").addEventListener("click", async () => {
    if (!isNamed()) return;
    const found = await post("file", wished());
    if (found) download(`${byId("name").value}.toml`, found.text, "application/toml");
  });
  byId("reset").addEventListener("click", () => {
    steps = base.ranges.map((range) => structuredClone(range.steps));
    refresh();
    ask();
  });
  byId("form").addEventListener("submit", (event) => event.preventDefault());
  byId("base").addEventListener("change", () => load({ name: byId("base").value }));
  byId("open").addEventListener("change", async () => {
    const [file] = byId("open").files;
    if (file) load({ name: file.name, text: await file.text() });
  });
  byId("against").addEventListener("change", ask);
  byId("boat").addEventListener("change", ask);
  byId("tow").addEventListener("change", () => figures.forEach(draw));
  byId("boat_type").addEventListener("change", () => figures.forEach(draw));
  tables.forEach((table) => {
    table.querySelector(".search")?.addEventListener("input", () => fill(table));
    table.querySelector(".csv").addEventListener("click", () => downloadRows(
      table.dataset.table, start.columns[table.dataset.table], rowsOf(table)));
  });
  figures.forEach((figure) => figure.querySelector(".csv").addEventListener("click", () => {
    const rows = figureRows(figure);
    downloadRows(figure.dataset.figure, [...new Set(rows.flatMap(Object.keys))], rows);
  }));
  all("[data-language]").forEach((button) =>
    button.addEventListener("click", () => setLanguage(button.dataset.language)));

  // -- Begin ------------------------------------------------------------------------------------
  root.lang = localStorage.getItem("herijk-language") === "en" ? "en" : "nl";
  fillSelect(byId("boat"), start.boats.map((b) => b.fsn_no),
    start.boats.map((b) => `${b.name ?? ""} (${b.fsn_no})`));
  const anyType = make("option", { value: "" });
  [anyType.dataset.nl, anyType.dataset.en] = pair("all");
  byId("boat_type").append(anyType, ...start.types.map((type) => make("option", { value: type }, type)));
  fillSources();
  byId("base").value = start.base;
  byId("against").value = start.against;
  load(source);
})();

// The workbench: a scenario, questions about it to the server, and what the answers show.
// One question at a time is on its way; of those that come meanwhile only the last is asked.
import { outdateCharts, redrawCharts } from "./charts.js";
import { buildForm, markWrong } from "./controls.js";
import { all, byId, exact, make, number, pair, root, say, seasonsText, start, state, word } from "./page.js";
import { updateSeen } from "./seen.js";
import { download, outdateTables } from "./tables.js";

// -- Questions ------------------------------------------------------------------------------------
let asked = false; // a question waits
let busy = false; // one is on its way
let since = 0; // when the last change was made

const complaints = new Map(); // path -> why the last question there has no answer

function complain(path, found = {}) {
  complaints.set(path, found);
  const refusals = [...complaints.values()].filter(({ refused }) => refused);
  byId("refused").hidden = !refusals.length;
  byId("refused").replaceChildren(...refusals.map((one) => make("p", {}, say("refused"), " ", ...inWords(one))));
  if (path === "answer") markWrong(found.where ?? "");
}

// A refusal with the label that the option has on this page; what it has no words for, as it came.
function inWords({ refused, where, kind, limit }) {
  if (!(`refusal.${kind}` in start.words)) return [refused];
  const end = limit === null ? "." : ` ${exact(limit)}.`;
  return [say(where), " ", say(`refusal.${kind}`), end];
}

// What the server says, or null after telling why there is nothing.
async function post(path, body) {
  let response;
  try {
    response = await fetch(path, { method: "POST", body: JSON.stringify(body),
      headers: { "Content-Type": "application/json" } });
  } catch {
    complain(path, { refused: word("gone") });
    return null;
  }
  if (!response.ok) { complain(path, { refused: word("failed") }); return null; }
  const found = await response.json();
  complain(path, found.refused ? found : {});
  return found.refused ? null : found;
}

function tellState(found) {
  byId("state").replaceChildren(...(found ? [`${start.tows} `, say("tows_in_all"), ". ",
    say("done_in"), ` ${number(Number(root.dataset.seconds), 1)} s.`] : []));
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
    const found = await post("answer", { base: state.source, steps: state.steps, against: byId("against").value,
      boat: byId("boat").value, tows: byId("tows").value });
    if (asked) continue;
    if (found) { state.answer = found; writeAddress(); await show(); }
    root.dataset.seconds = (performance.now() - since) / 1000;
    tellState(found);
  }
  busy = false;
  root.setAttribute("aria-busy", "false");
}

let wantedBase = null;

async function load(wanted, changes = []) {
  wantedBase = wanted;
  const found = await post("base", wanted);
  if (!found || wantedBase !== wanted) return; // another was chosen meanwhile
  state.source = wanted;
  state.base = found;
  reset(changes);
}

function reset(changes = []) {
  state.steps = state.base.ranges.map((range) => structuredClone(range.steps));
  for (const [place, step, option, value] of changes) {
    if (option in (state.steps[place]?.[step] ?? {})) state.steps[place][step][option] = value;
  }
  buildForm(ask);
  ask();
}

// -- A change as a link: the address holds what is asked ------------------------------------------
function changesMade() {
  const isSame = (a, b) => JSON.stringify(a) === JSON.stringify(b);
  return state.base.ranges.flatMap(({ steps }, place) => Object.entries(steps).flatMap(([step, options]) =>
    Object.entries(state.steps[place][step]).filter(([option, value]) => !isSame(value, options[option]))
      .map(([option, value]) => [place, step, option, value])));
}

function writeAddress() {
  const asked = { base: state.source, against: byId("against").value, changes: changesMade(),
    boat: byId("boat").value, tows: byId("tows").value };
  history.replaceState(null, "", `#${encodeURIComponent(JSON.stringify(asked))}`);
  byId("shared").replaceChildren();
}

function readAddress() {
  try {
    return JSON.parse(decodeURIComponent(location.hash.slice(1)));
  } catch {
    return {}; // no link, or a damaged one: begin as always
  }
}

async function share() {
  const done = await navigator.clipboard.writeText(location.href).then(() => true, () => false);
  byId("shared").replaceChildren(say(done ? "shared" : "not_shared"));
}

// -- Answers --------------------------------------------------------------------------------------
function show() {
  showChanges();
  showSummary();
  fillSelect(byId("tow"), [...new Set(state.answer.boat_curves.map((row) => row.tow_id))].reverse());
  outdateTables();
  outdateCharts();
  return updateSeen();
}

function showChanges() {
  const items = state.answer.changed_options.map((d) => make("li", {},
    make("b", {}, say(`step.${d.step}`)), ", ", say(`${d.step}.${d.option}`), ": ",
    ...joined(d.before.map(valueOf)), " → ", valueOf(d.after), " (",
    isWhole(d) ? say("all_seasons") : seasonsText(d.first, d.last), ")"));
  byId("changed").replaceChildren(...(items.length ? items
    : [make("li", {}, say("nothing_changed"))]));
  byId("reset").hidden = !items.length;
}

const isWhole = (d) => d.first === state.base.ranges[0].first && d.last === state.base.ranges.at(-1).last;
const joined = (parts) => parts.flatMap((part, i) => (i ? ["; ", part] : [part]));

function valueOf(value) {
  if (Array.isArray(value)) {
    return value.length ? make("span", {}, ...joined(value.map((v) => say(`code.${v}`))))
      : say("nothing");
  }
  return typeof value === "number" ? make("span", {}, exact(value)) : say(`choice.${value}`);
}

function showSummary() {
  const s = state.answer.summary;
  const [before, after] = [state.answer.before, start.scenario].map((method) =>
    state.answer.reproducibility.find((row) => row.method === method && row.scope === "all"));
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
  byId("explained").replaceChildren(...tiles.flatMap(([key]) => [
    make("dt", {}, say(key)), make("dd", {}, say(`means.${key}`))]));
}

// -- Choices and buttons --------------------------------------------------------------------------
function fillSelect(select, values, texts = values) {
  const chosen = select.value;
  select.replaceChildren(...values.map((value, i) => make("option", { value }, texts[i])));
  if (values.includes(chosen)) select.value = chosen;
}

function addTows(value) {
  const option = make("option", { value }, value.replace(":", "\u2013"));
  if (start.words[`code.${value}`]) [option.dataset.nl, option.dataset.en] = pair(`code.${value}`);
  byId("tows").append(option);
}

// Tows by name, as the server knows them; a range of seasons of one's own becomes a choice too.
function chooseTows(value) {
  if (![...byId("tows").options].some((option) => option.value === value)) addTows(value);
  byId("tows").value = value;
  const ends = value.match(/\d{4}/g) ?? [start.seasons[0], start.seasons.at(-1)];
  byId("first").value = ends[0];
  byId("last").value = ends.at(-1);
}

function chooseSeasons() {
  const ends = ["first", "last"].map((id) => byId(id).value).sort();
  chooseTows([...new Set(ends)].join(":"));
  ask();
}

// A method that ships goes by its name in words.
function named(name) {
  const option = make("option", { value: name }, name);
  if (start.words[`method.${name}`]) [option.dataset.nl, option.dataset.en] = pair(`method.${name}`);
  return option;
}

function group(key, names) {
  const element = make("optgroup", {}, ...names.map(named));
  [element.dataset.nl, element.dataset.en] = pair(key);
  return element;
}

function fillSources() {
  const groups = [["group_methods", start.methods], ["group_saved", start.saved]];
  byId("base").replaceChildren(...groups.filter(([, n]) => n.length).map((g) => group(...g)));
  const old = [["group_methods", start.methods], ["group_editions", start.editions], ["group_saved", start.saved]];
  byId("against").replaceChildren(...old.filter(([, n]) => n.length).map((g) => group(...g)));
  setLanguage(root.lang);
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
  if (state.answer) show();
  if (root.dataset.seconds) tellState(state.answer);
}

const wished = () => ({ base: state.source, steps: state.steps,
  name: byId("name").value, title: byId("title").value, reason: byId("reason").value });

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
byId("reset").addEventListener("click", () => reset());
byId("share").addEventListener("click", share);
byId("form").addEventListener("submit", (event) => event.preventDefault());
byId("base").addEventListener("change", () => load({ name: byId("base").value }));
byId("open").addEventListener("change", async () => {
  const [file] = byId("open").files;
  if (file) load({ name: file.name, text: await file.text() });
});
byId("against").addEventListener("change", ask);
byId("boat").addEventListener("change", ask);
byId("tow").addEventListener("change", redrawCharts);
byId("boat_type").addEventListener("change", redrawCharts);
byId("tows").addEventListener("change", () => { chooseTows(byId("tows").value); ask(); });
["first", "last"].forEach((id) => byId(id).addEventListener("change", chooseSeasons));
all("[data-language]").forEach((button) =>
  button.addEventListener("click", () => setLanguage(button.dataset.language)));

// -- Begin ----------------------------------------------------------------------------------------
root.lang = localStorage.getItem("herijk-language") === "en" ? "en" : "nl";
fillSelect(byId("boat"), start.boats.map((b) => b.fsn_no),
  start.boats.map((b) => `${b.name ?? ""} (${b.fsn_no})`));
const anyType = make("option", { value: "" });
[anyType.dataset.nl, anyType.dataset.en] = pair("all");
byId("boat_type").append(anyType, ...start.types.map((type) => make("option", { value: type }, type)));
start.choices.forEach(addTows);
fillSelect(byId("first"), start.seasons.map(String));
fillSelect(byId("last"), start.seasons.map(String));
byId("last").value = start.seasons.at(-1);
fillSources();
const linked = readAddress();
byId("base").value = linked.base?.name ?? start.base;
byId("against").value = linked.against ?? start.against;
if (linked.tows) chooseTows(linked.tows);
if (start.boats.some((boat) => boat.fsn_no === linked.boat)) byId("boat").value = linked.boat;
load(linked.base ?? state.source, linked.changes);

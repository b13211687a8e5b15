// Tables of an answer: sorted, searched, downloaded.
import { all, byId, code, make, method, number, say, start, state } from "./page.js";
import { outdate, watch } from "./seen.js";

export function chooseBoat(fsn_no) {
  byId("boat").value = fsn_no;
  byId("boat").dispatchEvent(new Event("change"));
  byId("boat").scrollIntoView({ block: "center" });
}

const tables = all(".table");
const order = new Map(); // table -> [column, direction]

function rowsOf(table) {
  const name = table.dataset.table;
  const words = (table.querySelector(".search")?.value ?? "").toLowerCase().split(/\s+/);
  const rows = state.answer[name].filter((row) => {
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

export const outdateTables = () => outdate(tables, fill);

function fill(table) {
  const columns = start.columns[table.dataset.table];
  table.querySelector("thead").replaceChildren(make("tr", {}, ...columns.map((column) =>
    header(table, column))));
  const rows = rowsOf(table);
  const counts = new Set(columns.filter((column) =>
    state.answer[table.dataset.table].every((row) => isCount(row[column])) && !column.startsWith("share")));
  table.querySelector("tbody").replaceChildren(...rows.map((row) => {
    const line = make("tr", {}, ...columns.map((column) =>
      cell(row, column, counts.has(column))));
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
  if (state.answer[name].some((row) => typeof row[column] === "number")) element.className = "n";
  if (sorted === column) {
    element.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
  }
  return element;
}

const digitsOf = (column) =>
  (start.digits.find(([ending]) => column.endsWith(ending)) ?? ["", 4])[1];

// A column of nothing but whole numbers counts something, unless it holds shares; in another a 1
// has decimals too.
const isCount = (value) => value === null || Number.isInteger(value);

function cell(row, column, isOfCounts) {
  const value = row[column];
  if (value === null) return make("td");
  if (column === "fsn_no") {
    return make("td", {}, make("button", { type: "button", className: "to-boat",
      onclick: () => chooseBoat(value) }, value));
  }
  if (typeof value === "boolean") return make("td", { className: "t" }, say(value ? "yes" : "no"));
  if (typeof value === "number") {
    const text = isOfCounts ? `${value}`
      : number(value, digitsOf(column), column.startsWith("gain"));
    return make("td", { className: "n" }, text);
  }
  const codes = Array.isArray(value) ? value : [value];
  const className = start.long.includes(column) ? "w" : "t";
  return make("td", { className }, codes.map(column === "method" ? method : code).join(", "));
}

// Text that a spreadsheet would take for a formula is kept text.
function csvCell(value) {
  if (value === null || value === undefined) return "";
  if (typeof value === "number") return String(value);
  const text = (Array.isArray(value) ? value.join(" ") : String(value))
    .replace(/(^|[;,\t\r\n])(\s*)([=+\-@])/g, "$1$2'$3");
  return /[",;\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

export function download(name, text, type) {
  const link = make("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export function downloadRows(name, columns, rows) {
  const lines = [columns, ...rows.map((row) => columns.map((column) => row[column]))];
  const text = lines.map((line) => line.map(csvCell).join(",")).join("\r\n");
  download(`${name}.csv`, `\ufeff${text}\r\n`, "text/csv");
}

tables.forEach((table) => {
  watch(table);
  table.querySelector(".search")?.addEventListener("input", () => fill(table));
  table.querySelector(".csv").addEventListener("click", () => downloadRows(
    table.dataset.table, start.columns[table.dataset.table], rowsOf(table)));
});

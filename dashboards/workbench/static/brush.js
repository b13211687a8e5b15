// Brushing a scatter: dragging over it, or typing from and to below it, lists the boats inside.
import { make, say, word } from "./page.js";
import { chooseBoat } from "./tables.js";

export function offerBrush(figure, view, { x, y }, rowsNow) {
  const ends = [x, y].map(({ title }) => ["from", "to"].map((end) => {
    const input = make("input", { type: "number", step: "any" });
    input.setAttribute("aria-label", `${title}, ${word(end)}`);
    return input;
  }));
  const inputs = ends.flat();
  const found = make("output");
  const set = (chosen) => view.data("brush_store", chosen).runAsync();
  const empty = () => {
    inputs.forEach((input) => { input.value = ""; });
    set([]);
  };
  const clear = make("button", { type: "button", className: "clear", hidden: true, onclick: empty }, say("clear"));
  const fields = make("div", { className: "tools" },
    ...ends.flatMap(([from, to], i) => [[x, y][i].title, from, "\u2013", to]), clear);
  fields.oninput = () => {
    const values = ends.map(([from, to]) => [
      from.value === "" ? -Infinity : from.valueAsNumber, to.value === "" ? Infinity : to.valueAsNumber]);
    const isOpen = inputs.every((input) => input.value === "");
    set(isOpen ? [] : [{ unit: "", fields: [x, y].map(({ field }) => ({ type: "R", field })), values }]);
  };
  fields.onkeydown = ({ key }) => { if (key === "Escape") empty(); };
  view.addDataListener("brush_store", (_, chosen) => {
    clear.hidden = !chosen.length;
    found.replaceChildren(...(chosen.length ? list(boatsInside(rowsNow(), chosen[0])) : []));
  });
  figure.querySelector(".brush")?.remove();
  figure.append(make("div", { className: "brush" }, fields, found));
}

function boatsInside(rows, { fields, values }) {
  const inside = (row) => fields.every(({ field }, i) => {
    const [low, high] = [...values[i]].sort((a, b) => a - b);
    const value = row[field.replace("_seen", "")];
    return value !== null && value >= low && value <= high;
  });
  return [...new Set(rows.filter(inside).map((row) => row.fsn_no))].sort();
}

const list = (boats) => [say("boats_inside"), ` ${boats.length}: `, ...boats.map((boat) =>
  make("button", { type: "button", className: "to-boat", onclick: () => chooseBoat(boat) }, boat))];

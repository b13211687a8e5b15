"use strict";
// Switches for the parts of a proposal. Rows hold a value for each combination: bit i of its place is switch i.
(() => {
  const all = (selector, within = document) => [...within.querySelectorAll(selector)];
  const HASH = "#on=";
  const NONE = "\u2013";
  const switches = all("[role=switch]");

  const getPlace = () => switches.reduce((place, one, bit) => place + (one.checked << bit), 0);
  const pick = (values, place) => { const value = values.split(" ")[place]; return value === "" ? null : Number(value); };
  const sign = (number) => `${number < 0 ? "\u2212" : "+"}${Math.abs(number)}`;

  function showGain(row, place) {
    const seconds = pick(row.dataset.seconds, place);
    const bar = row.querySelector("rect");
    row.cells[2].textContent = seconds === null ? NONE : sign(seconds);
    bar.setAttribute("x", Math.min(seconds ?? 0, 0));
    bar.setAttribute("width", Math.abs(seconds ?? 0));
    bar.classList.toggle("faster", seconds < 0);
  }

  function showPodium(table, place) {
    const body = table.tBodies[0];
    const rows = [...body.rows].map((row) => [pick(row.dataset.new, place) ?? Infinity, row]);
    for (const [rank, row] of rows) {
      const before = pick(row.dataset.old, place) ?? NONE;
      row.hidden = rank > table.dataset.places;
      row.classList.toggle("moved", rank !== before);
      row.cells[0].textContent = rank;
      row.cells[2].textContent = before;
    }
    body.append(...rows.sort(([a], [b]) => a - b).map(([, row]) => row));
  }

  function show() {
    const place = getPlace();
    for (const said of all("[data-place]")) said.hidden = Number(said.dataset.place) !== place;
    for (const row of all("[data-seconds]")) showGain(row, place);
    for (const table of all(".podium")) showPodium(table, place);
    for (const other of all(".language")) other.hash = location.hash; // where there is another one
  }

  function read() { // without a choice in the address, all is on
    const on = location.hash.startsWith(HASH) ? location.hash.slice(HASH.length).split(",") : null;
    for (const one of switches) one.checked = on === null || on.includes(one.name);
    show();
  }

  function keep() {
    location.replace(HASH + switches.filter((one) => one.checked).map((one) => one.name));
  }

  for (const one of switches) {
    one.disabled = false;
    one.addEventListener("change", keep);
  }
  addEventListener("hashchange", read);
  read();
})();

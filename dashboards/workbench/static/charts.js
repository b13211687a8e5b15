// Charts of an answer: drawn once, then given new rows, when they are in view.
import { offerBrush } from "./brush.js";
import { all, byId, root, state, wide } from "./page.js";
import { outdate, updateSeen, watch } from "./seen.js";
import { chooseBoat, downloadRows } from "./tables.js";

const figures = all("figure[data-figure]");
const views = new Map(); // figure -> its Vega view and the language of its texts
const LOCALES = {
  nl: { decimal: ",", thousands: ".", grouping: [3], currency: ["€ ", ""], minus: "-" },
  en: { decimal: ".", thousands: ",", grouping: [3], currency: ["€", ""], minus: "-" },
};

const toBoat = (row) => ({ ...row, page: "#boat" }); // a point of a boat leads to the boat

const ROWS = {
  changed: () => state.answer.register.filter((row) => row.change === "changed").map(toBoat),
  types: () => state.answer.types.filter((row) =>
    ["", row.boat_type].includes(byId("boat_type").value)).map(toBoat),
  boat_figure: () => state.answer.boat_figure.filter((row) => row.tow_id === byId("tow").value),
};

const figureRows = ({ dataset: { data } }) => (ROWS[data] ?? (() => state.answer[data]))();

const drawing = new Map(); // figure -> its drawing on the way

// One drawing of a figure after the other; each takes the rows as they are by then.
function draw(figure) {
  drawing.set(figure, (drawing.get(figure) ?? Promise.resolve()).then(() => drawNow(figure)));
  return drawing.get(figure);
}

export const outdateCharts = () => outdate(figures, draw);

export function redrawCharts() {
  outdateCharts();
  return updateSeen();
}

// The boat that is chosen is large in the scatters.
const mark = (view) => ("chosen" in view.getState().signals ? view.signal("chosen", byId("boat").value) : view);

async function drawNow(figure) {
  const rows = figureRows(figure);
  const known = views.get(figure);
  if (known?.language === root.lang) {
    await mark(known.view.data("rows", structuredClone(rows))).runAsync();
    return;
  }
  known?.view.finalize();
  const language = root.lang;
  const spec = structuredClone(window.HERIJK_FIGURES[root.lang][figure.dataset.figure]);
  spec.datasets = { rows: structuredClone(rows) };
  const columns = wide.matches ? 2 : 1;
  const beside = spec.facet ? 1 : columns; // a pair of scatters has a row of its own
  const room = byId("results").clientWidth / beside - 110;
  if (spec.facet) {
    spec.columns = columns;
    spec.spec.width = Math.min(spec.spec.width, room / columns);
  } else {
    spec.width = Math.min(spec.width, room);
    spec.height = Math.min(spec.height, 260);
  }
  const place = figure.querySelector(".chart");
  const { view } = await window.vegaEmbed(place, spec, {
    actions: false, renderer: "svg", formatLocale: LOCALES[root.lang],
    config: { font: "Open Sans", aria: false, mark: { aria: false }, legend: { labelFontSize: 12, titleFontSize: 12, labelLimit: 220,
      orient: "bottom", columns: columns + 1 },
      axis: { labelFontSize: 12, titleFontSize: 12, labelLimit: 200 } },
  });
  view.addEventListener("click", (_, item) => {
    if (item?.datum?.fsn_no) chooseBoat(item.datum.fsn_no);
  });
  const scatter = spec.spec?.layer?.find(({ encoding }) => encoding?.href);
  if (scatter) offerBrush(figure, view, scatter.encoding, () => figureRows(figure));
  await mark(view).runAsync();
  const picture = place.querySelector("svg");
  picture.setAttribute("role", "img");
  picture.setAttribute("aria-label", figure.dataset[root.lang]);
  views.set(figure, { view, language });
}

figures.forEach((figure) => {
  watch(figure);
  figure.querySelector(".csv").addEventListener("click", () => {
    const rows = figureRows(figure);
    downloadRows(figure.dataset.figure, [...new Set(rows.flatMap(Object.keys))], rows);
  });
});

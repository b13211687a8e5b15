// Controls of a method's options, made from what the server says that each may be.
import { all, byId, make, say, seasonsText, start, state, wide } from "./page.js";

let shownControls = []; // functions that show the state in a control
let changed = () => {}; // is told of every change

const everywhere = () => state.steps.map((_, place) => place);

function held(step, option, places) {
  const values = places.map((place) => state.steps[place][step][option]);
  const same = values.every((v) => JSON.stringify(v) === JSON.stringify(values[0]));
  return { same, value: values[0] };
}

function change(step, option, places, value) {
  for (const place of places) state.steps[place][step][option] = value;
  refresh();
  changed();
}

export const refresh = () => shownControls.forEach((show) => show());

// The option that the server refuses is marked; none where there is no complaint.
export function markWrong(where) {
  for (const element of all("[data-option]")) {
    const wrong = element.dataset.option === where;
    element.classList.toggle("wrong", wrong);
    all("input", element).forEach((input) => input.setAttribute("aria-invalid", String(wrong)));
  }
}

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

// Makes all controls of the base; each change of an option is reported.
export function buildForm(report) {
  changed = report;
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
    for (const [place, range] of state.base.ranges.entries()) {
      const legend = make("legend", {}, seasonsText(range.first, range.last));
      if (!range.seasons.length) legend.append(" (", say("no_tows"), ")");
      details.append(make("fieldset", { className: "season" }, legend,
        ...optionsOf(step, [place])));
    }
    refresh();
  }, { once: true });
  return details;
}

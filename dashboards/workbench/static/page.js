// The page and its state: elements, texts in two languages, what is asked and answered.
export const root = document.documentElement;
export const start = JSON.parse(document.getElementById("start").textContent);
export const byId = (id) => document.getElementById(id);
export const all = (selector, within = document) => [...within.querySelectorAll(selector)];

export function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

// What everything else looks at and changes.
export const state = {
  source: { name: start.base }, // where the method starts, as the server knows it
  base: null, // its name, title and ranges
  steps: [], // of each range, as they are now
  answer: null, // the last one shown
};

export const wide = window.matchMedia("(min-width: 60rem)"); // as in the style sheet

// -- Texts ----------------------------------------------------------------------------------------
const LANGUAGES = ["nl", "en"];
export const pair = (key) => start.words[key] ?? [key, key].map((k) => k.split(".").at(-1));
export const word = (key) => pair(key)[LANGUAGES.indexOf(root.lang)];
export const code = (value) => (start.words[`code.${value}`] ? word(`code.${value}`) : String(value));

// A method that ships goes by its name in words.
export const method = (name) => (start.words[`method.${name}`] ? word(`method.${name}`) : name);

// A text in both languages; the style sheet hides the one that is not chosen.
export function say(key) {
  const [nl, en] = pair(key);
  return make("span", {}, make("span", { lang: "nl" }, nl), make("span", { lang: "en" }, en));
}

export function number(value, digits, sign = false) {
  const text = value.toFixed(digits).replace(/^-(?=[0.]+$)/, ""); // nothing has no sign
  const plus = sign && Number(text) > 0 ? "+" : "";
  return plus + (root.lang === "nl" ? text.replace(".", ",") : text);
}

// A number with the decimals that it has.
export const exact = (value) => String(value).replace(".", root.lang === "nl" ? "," : ".");

export function seasonsText(first, last) {
  if (last >= 9999) return make("span", {}, `${first} `, say("and_later"));
  return make("span", {}, first === last ? `${first}` : `${first}-${last}`);
}

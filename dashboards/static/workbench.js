"use strict";
// The workbench: the address holds what is asked. A change is written into it, and the parts of the
// page that answer take the place of those that are there. Of quick changes the last one counts.
(() => {
  const byId = (id) => document.getElementById(id);
  const form = byId("form");
  let turn = 0;

  async function ask(asked) {
    const mine = (turn += 1);
    const address = `${location.pathname}?${asked}`;
    document.documentElement.setAttribute("aria-busy", "true");
    byId("refused").textContent = "";
    try {
      const response = await fetch(address);
      if (!response.ok) throw new Error(response.statusText);
      const page = new DOMParser().parseFromString(await response.text(), "text/html");
      if (mine === turn) show(page, asked);
    } catch {
      if (mine === turn) byId("refused").textContent = form.dataset.gone;
    }
    if (mine === turn) document.documentElement.removeAttribute("aria-busy");
  }

  function show(page, asked) {
    const refused = page.getElementById("refused").textContent.trim();
    byId("refused").textContent = refused;
    if (refused) return;
    for (const id of ["content", "changed", "sources"]) byId(id).replaceWith(page.getElementById(id));
    const here = (part) => part.contains(document.activeElement);
    const options = byId("options");
    if (!here(options)) options.replaceWith(page.getElementById("options"));
    else for (const control of options.querySelectorAll(".option")) { // but for the one that is typed in
      if (!here(control)) control.replaceWith(page.getElementById(control.id));
    }
    history.replaceState(null, "", `?${asked}${location.hash}`);
    document.querySelector(".language").href = page.querySelector(".language").getAttribute("href");
    window.herijk.start();
  }

  // A change for all seasons takes the place of those for some.
  function changed(field) {
    const asked = new URLSearchParams(location.search);
    const { name } = field;
    const several = form.querySelectorAll(`[type=checkbox][name="${name}"]`);
    for (const key of [...asked.keys()]) if (key.startsWith(`${name}.`)) asked.delete(key);
    asked.set(name, several.length ? [...several].filter((box) => box.checked).map((box) => box.value).join(",") : field.value);
    if (name === "base") [...asked.keys()].filter((key) => key.includes(".") || ["against", "at"].includes(key)).forEach((key) => asked.delete(key));
    if (name === "boat") asked.delete("tow_id");
    return asked;
  }

  document.addEventListener("change", ({ target }) => {
    const isCleared = target.type === "number" && target.value === "";
    if (target.matches("[data-asks]") && !isCleared) ask(changed(target));
  });
  document.addEventListener("click", (event) => {
    const link = event.target.closest('td a[href^="?"]');
    if (!link) return;
    event.preventDefault();
    ask(new URLSearchParams(link.search)).then(() => byId("boat").scrollIntoView());
  });
  form.addEventListener("submit", (event) => event.preventDefault());

  byId("save").addEventListener("click", async () => {
    const fields = ["name", "title", "reason"].map(byId);
    if (!fields.every((field) => field.reportValidity())) return;
    const [name, title, reason] = fields.map((field) => field.value);
    const address = Object.fromEntries(new URLSearchParams(location.search));
    const response = await fetch(form.dataset.save, { method: "POST",
      headers: { "Content-Type": "application/json" }, body: JSON.stringify({ address, name, title, reason }) });
    const { refused, command } = await response.json();
    byId("refused").textContent = refused ?? "";
    byId("saved").hidden = !command;
    byId("saved").querySelector("code").textContent = command ?? "";
  });
})();

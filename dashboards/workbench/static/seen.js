// Parts of the page that are brought up to date when they are seen: a change need not wait for what
// is out of view. Printing shows everything.
const stale = new Map(); // part -> how it is brought up to date
const inView = new Set();

const watcher = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (isIntersecting) inView.add(target);
    else inView.delete(target);
  }
  updateSeen();
}, { rootMargin: "100px" });

const updateAll = (parts) => Promise.all(parts.map((part) => {
  const update = stale.get(part);
  stale.delete(part);
  return update(part);
}));

export const watch = (part) => watcher.observe(part);

// These parts are out of date from now on; call `updateSeen` after.
export const outdate = (parts, update) => parts.forEach((part) => stale.set(part, update));

export const updateSeen = () => updateAll([...stale.keys()].filter((part) => inView.has(part)));

window.addEventListener("beforeprint", () => updateAll([...stale.keys()]));

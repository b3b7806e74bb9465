// What is wrong, above everything else, and what to do about it.
import { element, fill, make, setText } from "./dom.js";

const lingers_ms = 2000;
const announces_every_ms = 4000;
const worst = ["No answer from diminish", "no new picture"];

// Of each kind (a text without its numbers), what was said last. A problem that comes and goes with
// every frame stays long enough to be read, and the picture does not jump.
const shown = new Map();
let announced = new Set();
let announcedAt = -Infinity;

const kindOf = (text) => text.replace(/\d+(\.\d+)?/g, "#");
const isWorst = ({ text }) => worst.some((begin) => text.startsWith(begin));

export function showProblems(problems) {
  const now = performance.now();
  for (const problem of problems) shown.set(kindOf(problem.text), { ...problem, until: now + lingers_ms });
  for (const [kind, { until }] of shown) if (until < now) shown.delete(kind);
  const all = [...shown.values()].sort((a, b) => isWorst(b) - isWorst(a));
  const warnings = element("warnings");
  const wasHidden = warnings.hidden;
  warnings.hidden = all.length === 0;
  warnings.classList.toggle("bad", all.some(isWorst));
  fill(warnings.firstElementChild, all, () => make("li", {}, make("b"), make("span")), (item, { text, toDo }) => {
    setText(item.firstElementChild, text);
    setText(item.lastElementChild, toDo ? `To do: ${toDo}.` : "");
  });
  if (warnings.hidden !== wasHidden) dispatchEvent(new Event("resize"));
  announce(now);
}

// Once for each kind: figures in a text that change are no news.
function announce(now) {
  if (now - announcedAt < announces_every_ms) return;
  const news = [...shown].filter(([kind]) => !announced.has(kind)).map(([, { text, toDo }]) => `${text}. ${toDo}`);
  if (news.length > 0) {
    setText(element("announcement"), news.join(" "));
  } else if (announced.size > 0 && shown.size === 0) {
    setText(element("announcement"), "Nothing is wrong any more.");
  } else {
    return;
  }
  announced = new Set(shown.keys());
  announcedAt = now;
}

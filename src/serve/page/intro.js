// Explains the page: on the first visit by itself, later when asked.
import { element, setText } from "./dom.js";

const key = "diminish-intro";

// A browser may forbid a page to remember.
function recall() {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

function show(isShown) {
  element("intro").hidden = !isShown;
  element("help").setAttribute("aria-expanded", String(isShown));
  dispatchEvent(new Event("resize"));
}

export function explain(objects) {
  setText(element("intro-objects"), objects.length ? `Here it takes out: ${objects.join(", ")}.` : "");
  element("help").onclick = () => {
    const isShown = element("intro").hidden;
    show(isShown);
    if (isShown) element("intro-title").focus();
  };
  element("intro-done").onclick = () => {
    show(false);
    element("help").focus();
    try {
      localStorage.setItem(key, "seen");
    } catch { /* it will be shown again */ }
  };
  show(recall() !== "seen");
}

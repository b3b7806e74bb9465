import { element, make } from "./dom.js";
import { get, post } from "./stream.js";

const firstModes = ["remove", "half", "xray", "outline", "provenance"];  // then whatever else there is
const mainSettings = ["discontinuity_threshold_m", "mask_margin_px", "color_correct", "inpaint", "memory", "transparency", "budget_ms"];
// Sliders need an end where a setting has none that is useful.
const usefulRange = {
  discontinuity_threshold_m: [0.01, 0.5, 0.01], mask_margin_px: [0, 40, 1],
  transparency: [0, 1, 0.05], budget_ms: [0, 100, 1],
};

// What the last request was refused for.
export let complaint = "";
export function complain(text) { complaint = text; }

let changing = Promise.resolve();
let changesToCome = 0;
let last;
const setters = [];

// One after the other, in the order of the clicks. An answer that a later change makes old is not shown.
function change(changes, input) {
  ++changesToCome;
  changing = changing.then(() => makeChange(changes, input));
}

async function makeChange(changes, input) {
  try {
    last = await post("api/settings", changes);
    if (changesToCome === 1) showValues(last);
    input.removeAttribute("aria-invalid");
    complaint = "";
  } catch (error) {
    // What was typed stays, to be corrected; what was chosen goes back.
    if (["number", "text"].includes(input.type)) {
      input.setAttribute("aria-invalid", "true");
    } else {
      showValues(last);
    }
    complaint = error.message;
  } finally {
    --changesToCome;
  }
}

// The setting's inputs; remembers how to write its value into them.
function inputFor({ name, kind, choices, min, max }, isMain) {
  const remember = (input, set) => setters.push({ name, input, set });
  if (choices) {
    const select = make("select", { name });
    select.append(...choices.map((choice) => make("option", { value: choice, textContent: choice })));
    select.onchange = () => change({ [name]: select.value }, select);
    remember(select, (value) => { select.value = value; });
    return [select];
  }
  if (kind === "switch") {
    const box = make("input", { type: "checkbox", name });
    box.onchange = () => change({ [name]: box.checked }, box);
    remember(box, (value) => { box.checked = value; });
    return [box];
  }
  if (kind === "text") {
    const text = make("input", { type: "text", name });
    text.onchange = () => change({ [name]: text.value }, text);
    remember(text, (value) => { text.value = value; });
    return [text];
  }
  const isSlider = isMain && usefulRange[name];
  const input = make("input", { type: isSlider ? "range" : "number", name });
  [input.min, input.max, input.step] = isSlider ? usefulRange[name] : [min, max ?? "", "any"];
  const shown = make("output");
  input.oninput = () => { shown.textContent = input.value; };
  input.onchange = () => change({ [name]: Number(input.value) }, input);
  remember(input, (value) => { input.value = value; shown.textContent = value; });
  return isSlider ? [input, shown] : [input];
}

// The unit stands for its suffix in the name.
const plainName = ({ name, unit }) =>
  name.replace(/_(m|px|ms|s)$/, unit ? ` (${unit})` : "").replaceAll("_", " ");

function row(setting, isMain) {
  const title = `${setting.help}${setting.unit ? ` (${setting.unit})` : ""}`;
  return make("label", { title }, make("span", { textContent: plainName(setting) }), ...inputFor(setting, isMain));
}

function modeButton(mode, i) {
  const input = make("input", { type: "radio", name: "mode", value: mode });
  input.onchange = () => change({ mode }, input);
  setters.push({ name: "mode", input, set: (value) => { input.checked = value === mode; } });
  return make("label", { title: `Key ${i + 1} while the picture has the focus` }, input, make("span", { textContent: mode }));
}

const keptOf = (value) => value.split(",").map((name) => name.trim()).filter(Boolean);

function objectRows(objects) {
  const boxes = objects.map((name) => make("input", { type: "checkbox", name: `remove ${name}` }));
  const keep = () => objects.filter((_, i) => !boxes[i].checked).join(",");
  boxes.forEach((box, i) => {
    box.onchange = () => change({ keep: keep() }, box);
    setters.push({ name: "keep", input: box, set: (value) => { box.checked = !keptOf(value).includes(objects[i]); } });
  });
  return objects.map((name, i) =>
    make("label", {}, boxes[i], make("span", { textContent: name }), make("small", { id: `object-${name}` })));
}

function showValues({ settings }) {
  const values = Object.fromEntries(settings.map(({ name, value }) => [name, value]));
  for (const { name, input, set } of setters) {
    // Nobody's typing is overwritten.
    const isTyped = document.activeElement === input && ["number", "text"].includes(input.type);
    if (!isTyped && name in values) set(values[name]);
  }
}

// Built once: what has the keyboard's focus keeps it. Returns the objects' names.
export async function startSettings() {
  last = await get("api/settings");
  const byName = Object.fromEntries(last.settings.map((setting) => [setting.name, setting]));
  const others = last.settings.filter(({ name }) => !mainSettings.includes(name) && name !== "mode" && name !== "keep");
  element("main-settings").append(...mainSettings.map((name) => row(byName[name], true)));
  element("all-settings").append(...others.map((setting) => row(setting, false)));
  const modes = byName.mode.choices;
  element("modes").append(...[...firstModes.filter((mode) => modes.includes(mode)),
    ...modes.filter((mode) => !firstModes.includes(mode))].map(modeButton));
  element("objects").append(...objectRows(last.objects));
  showValues(last);
  return last.objects;
}

import { get, pictures, post } from "./stream.js";

const element = (id) => document.getElementById(id);
const stageColors = ["#4db6ac", "#81c784", "#90a4ae", "#b0bec5", "#9575cd", "#7986cb",
  "#4dd0e1", "#64b5f6", "#f06292", "#dce775", "#ba68c8", "#ffb74d", "#e57373"];
const mainSettings = ["discontinuity_threshold_m", "mask_margin_px", "color_correct", "inpaint", "memory", "transparency", "budget_ms"];
// Sliders need an end where a setting has none that is useful.
const usefulRange = {
  discontinuity_threshold_m: [0.01, 0.5, 0.01], mask_margin_px: [0, 40, 1],
  transparency: [0, 1, 0.05], budget_ms: [0, 100, 1],
};

function make(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

// ---- the picture
const picture = element("picture");
const slider = element("before-after");
let streaming = new AbortController();

// How much of the left shows the camera's picture, 0 to 1.
const cameraShare = () => Number(slider.value) / 100;

function show(image) {
  const isPair = image.height > image.width * 1.25 && streaming.view === "pair";
  const height = isPair ? image.height / 2 : image.height;
  if (picture.width !== image.width || picture.height !== height) {
    picture.width = image.width;
    picture.height = height;
  }
  const context = picture.getContext("2d");
  if (!isPair) return context.drawImage(image, 0, 0);
  const split = Math.round(cameraShare() * image.width);
  context.drawImage(image, 0, height, image.width, height, 0, 0, image.width, height);
  if (split > 0) context.drawImage(image, 0, 0, split, height, 0, 0, split, height);
}

async function stream(controller) {
  while (!controller.signal.aborted) {
    try {
      const path = `api/stream.mjpg?view=${controller.view}`;
      for await (const { number, blob } of pictures(path, controller.signal)) {
        const image = await createImageBitmap(blob);
        if (controller.signal.aborted) return;
        show(image);
        image.close();
        picture.dataset.frame = number;
        element("waiting").hidden = true;
      }
    } catch (error) {
      if (controller.signal.aborted) return;
      element("waiting").textContent = error.message;
      element("waiting").hidden = false;
    }
    await new Promise((resume) => setTimeout(resume, 1000));
  }
}

function moveSlider() {
  const isSplit = cameraShare() > 0;
  const box = picture.getBoundingClientRect();
  element("divider").hidden = !isSplit;
  element("divider").style.left = `${cameraShare() * box.width}px`;
  element("before-label").hidden = !isSplit;
  element("after-label").hidden = !isSplit;
  // Both pictures are only asked for while they are looked at.
  const view = isSplit ? "pair" : "after";
  if (streaming.view === view) return;
  streaming.abort();
  streaming = new AbortController();
  streaming.view = view;
  stream(streaming);
}
slider.addEventListener("input", moveSlider);
addEventListener("resize", moveSlider);

// ---- settings
let complaint = "";
let changing = Promise.resolve();
let changesToCome = 0;

// One after the other, in the order of the clicks. An answer that a later change makes old is not shown.
function change(changes, input) {
  ++changesToCome;
  changing = changing.then(() => makeChange(changes, input));
}

async function makeChange(changes, input) {
  try {
    const settings = await post("api/settings", changes);
    if (changesToCome === 1) showSettings(settings);
    input?.classList.remove("wrong");
    complaint = "";
  } catch (error) {
    input?.classList.add("wrong");
    complaint = error.message;
  } finally {
    --changesToCome;
  }
}

function inputFor(setting, isMain) {
  const { name, kind, value } = setting;
  if (setting.choices) {
    const select = make("select", { name });
    select.append(...setting.choices.map((choice) => make("option", { value: choice, textContent: choice })));
    select.value = value;
    select.onchange = () => change({ [name]: select.value }, select);
    return [select];
  }
  if (kind === "switch") {
    const box = make("input", { type: "checkbox", name, checked: value });
    box.onchange = () => change({ [name]: box.checked }, box);
    return [box];
  }
  if (kind === "text") {
    const text = make("input", { type: "text", name, value });
    text.onchange = () => change({ [name]: text.value }, text);
    return [text];
  }
  const isSlider = isMain && usefulRange[name];
  const input = make("input", { type: isSlider ? "range" : "number", name });
  [input.min, input.max, input.step] = isSlider ? usefulRange[name] : [setting.min, setting.max ?? "", "any"];
  input.value = value;
  const shown = make("output", { textContent: value });
  input.oninput = () => { shown.textContent = input.value; };
  input.onchange = () => change({ [name]: Number(input.value) }, input);
  return isSlider ? [input, shown] : [input];
}

function showSettings({ settings, objects }) {
  const byName = Object.fromEntries(settings.map((setting) => [setting.name, setting]));
  const row = (isMain) => (setting) => make("label", { title: `${setting.help}${setting.unit ? ` (${setting.unit})` : ""}` },
    make("span", { textContent: setting.name.replaceAll("_", " ") }), ...inputFor(setting, isMain));
  element("main-settings").replaceChildren(...mainSettings.map((name) => byName[name]).map(row(true)));
  const others = settings.filter(({ name }) => !mainSettings.includes(name) && name !== "mode" && name !== "keep");
  element("all-settings").replaceChildren(...others.map(row(false)));

  element("modes").replaceChildren(...byName.mode.choices.map((mode) => {
    const button = make("button", { type: "button", textContent: mode });
    button.setAttribute("role", "radio");
    button.setAttribute("aria-checked", mode === byName.mode.value);
    button.onclick = () => change({ mode });
    return button;
  }));

  const kept = byName.keep.value.split(",").map((name) => name.trim()).filter(Boolean);
  const boxes = objects.map((name) => make("input", { type: "checkbox", name: `remove ${name}`, checked: !kept.includes(name) }));
  const keep = () => objects.filter((_, i) => !boxes[i].checked).join(",");
  for (const box of boxes) box.onchange = () => change({ keep: keep() });
  element("objects").replaceChildren(...objects.map((name, i) =>
    make("label", {}, boxes[i], make("span", { textContent: name }), make("small", { id: `object-${name}` }))));
}

// ---- how it does
const history = [];

function plot(stages) {
  history.push(Object.values(stages));
  if (history.length > 150) history.shift();
  const canvas = element("plot");
  const context = canvas.getContext("2d");
  const most = Math.max(5, ...history.map((times) => times.reduce((a, b) => a + b, 0))) * 1.1;
  context.clearRect(0, 0, canvas.width, canvas.height);
  const width = canvas.width / 150;
  history.forEach((times, x) => {
    let bottom = canvas.height;
    times.forEach((ms, stage) => {
      const height = (ms / most) * canvas.height;
      context.fillStyle = stageColors[stage];
      context.fillRect(x * width, bottom - height, width + 0.5, height);
      bottom -= height;
    });
  });
  context.fillStyle = "#9aa4af";
  context.font = "20px system-ui";
  context.fillText(`${most.toFixed(0)} ms`, 6, 22);
  element("legend").replaceChildren(...Object.entries(stages).map(([name, ms], i) =>
    make("span", {}, make("i", { style: `background:${stageColors[i]}` }), `${name.replace("_", " ")} ${ms.toFixed(1)}`)));
}

function showCameras(status) {
  const names = [...new Set(status.cameras.map(({ name }) => name))];
  element("cameras").tBodies[0].replaceChildren(...status.cameras.map((camera) => {
    const place = names.indexOf(camera.name);
    const isColor = camera.name === "color";
    const posed = isColor ? null : status.posed[names.filter((name) => name !== "color").indexOf(camera.name)];
    const lost = camera.dropped + camera.duplicates + camera.out_of_order + camera.wrong_size + camera.damaged;
    const counts = ["images", "dropped", "duplicates", "out_of_order", "wrong_size", "damaged", "stalls", "failures", "reconnects"];
    const clock = camera.clock ? `\nits clock: ${camera.clock.offset_ms} ms off, drift ${camera.clock.drift_ppm} ppm` : "";
    return make("tr", { title: `${camera.uri}\n${counts.map((name) => `${name.replaceAll("_", " ")}: ${camera[name]}`).join("\n")}${clock}\n${camera.problem}` },
      make("td", { textContent: camera.name }),
      make("td", { textContent: camera.state, className: camera.state === "running" ? "good" : "bad" }),
      make("td", { textContent: camera.images_per_second.toFixed(1) }),
      make("td", { textContent: status.markers[place] ?? "–" }),
      make("td", { textContent: posed == null ? "" : posed ? "known" : "unknown", className: posed === false ? "bad" : "" }),
      make("td", { textContent: lost }));
  }));
}

function showStatus(status) {
  const problems = complaint ? [complaint, ...status.problems] : status.problems;
  const warnings = element("warnings");
  warnings.hidden = problems.length === 0;
  warnings.classList.toggle("bad", status.problems.includes("no new picture"));
  warnings.replaceChildren(...problems.map((text) => make("div", { textContent: text })));
  element("rate").textContent = status.frames_per_second.toFixed(1);
  element("latency").textContent = `${status.latency_ms.p50.toFixed(0)} ms`;
  element("latency").title = `p95 ${status.latency_ms.p95} ms, p99 ${status.latency_ms.p99} ms`;
  element("frame-ms").textContent = `${status.frame_ms.toFixed(1)} ms`;
  element("skipped").textContent = status.skipped;
  element("seen").textContent = `${(100 * status.seen_share).toFixed(0)} %`;
  element("evidence").textContent = status.evidence;
  const { memory } = status;
  element("memory").textContent = memory.keyframes === 0 ? "Nothing is remembered"
    : `${memory.keyframes} keyframes, ${memory.megabytes.toFixed(0)} MB` + (status.remembered_share > 0
      ? `; remembered from ${memory.median_age_s.toFixed(1)} s ago (median), the oldest ${memory.oldest_age_s.toFixed(1)} s` : "");
  element("quality").hidden = status.quality_level === 0;
  element("quality").textContent = `To stay within ${status.budget_ms} ms: ${status.quality}`;
  plot(status.stage_ms);
  showCameras(status);
  for (const object of status.objects) {
    const note = element(`object-${object.name}`);
    if (note) note.textContent = object.kept ? "left in the picture" : object.message;
  }
  const { recording } = status;
  const button = element("record");
  button.disabled = !recording.allowed;
  button.title = recording.allowed ? "" : "Start diminish with --recordings FOLDER";
  button.classList.toggle("recording", recording.active);
  button.textContent = recording.active ? "Stop recording" : "Record";
  element("recording").textContent = recording.problem || (recording.folder
    ? `${recording.folder}: ${recording.frames} frames${recording.dropped ? `, ${recording.dropped} dropped` : ""}` : "");
}

async function command(path, body) {
  try {
    await post(path, body);
    complaint = "";
  } catch (error) {
    complaint = error.message;
  }
}
element("record").onclick = ({ target }) => command("api/recording", { active: !target.classList.contains("recording") });
element("forget").onclick = () => command("api/memory", { forget: true });

const events = new EventSource("api/events");
events.onmessage = ({ data }) => showStatus(JSON.parse(data));
events.onerror = () => {
  const warnings = element("warnings");
  warnings.hidden = false;
  warnings.classList.add("bad");
  warnings.textContent = "No answer from diminish; trying again";
};
showSettings(await get("api/settings"));
moveSlider();

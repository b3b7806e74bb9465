// The figures, from the program's events.
import { element, fill, make, setText } from "./dom.js";

const stageColors = ["#4db6ac", "#81c784", "#90a4ae", "#b0bec5", "#9575cd", "#7986cb",
  "#4dd0e1", "#64b5f6", "#f06292", "#dce775", "#ba68c8", "#ffb74d", "#e57373"];
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
      context.fillStyle = stageColors[stage % stageColors.length];
      context.fillRect(x * width, bottom - height, width + 0.5, height);
      bottom -= height;
    });
  });
  context.fillStyle = "#9aa4af";
  context.font = "20px system-ui";
  context.fillText(`${most.toFixed(0)} ms`, 6, 22);
  fill(element("legend"), Object.entries(stages),
    (_, i) => make("span", {}, make("i", { style: `background:${stageColors[i % stageColors.length]}` }), make("span")),
    (item, [name, ms]) => setText(item.lastElementChild, `${name.replace("_", " ")} ${ms.toFixed(1)}`));
}

function showCameras(status) {
  const names = [...new Set(status.cameras.map(({ name }) => name))];
  const depthNames = names.filter((name) => name !== "color");
  const counts = ["images", "dropped", "duplicates", "out_of_order", "wrong_size", "damaged", "stalls", "failures", "reconnects"];
  const newRow = () => make("tr", {}, make("th", { scope: "row" }), ...Array.from({ length: 5 }, () => make("td")));
  fill(element("cameras").tBodies[0], status.cameras, newRow, (row, camera) => {
    const posed = camera.name === "color" ? null : status.posed[depthNames.indexOf(camera.name)];
    const lost = camera.dropped + camera.duplicates + camera.out_of_order + camera.wrong_size + camera.damaged;
    const clock = camera.clock ? `\nits clock: ${camera.clock.offset_ms} ms off, drift ${camera.clock.drift_ppm} ppm` : "";
    row.title = `${camera.uri}\n${counts.map((name) => `${name.replaceAll("_", " ")}: ${camera[name]}`).join("\n")}${clock}\n${camera.problem}`;
    const texts = [camera.name, camera.state, camera.images_per_second.toFixed(1),
      status.markers[names.indexOf(camera.name)] ?? "–", posed == null ? "" : posed ? "known" : "unknown", lost];
    texts.forEach((text, i) => setText(row.children[i], text));
    row.children[1].className = camera.state === "running" ? "good" : "bad";
    row.children[4].className = posed === false ? "bad" : "";
  });
}

// What a screen reader says of the picture.
function pictureText(status) {
  const gone = status.objects.filter(({ kept, in_color }) => !kept && in_color).map(({ name }) => name);
  return `The camera's picture, mode ${status.mode}, ${gone.length ? `without ${gone.join(", ")}` : "nothing is taken out"}`;
}

export function showStatus(status) {
  setText(element("rate"), status.frames_per_second.toFixed(1));
  setText(element("latency"), `${status.latency_ms.p50.toFixed(0)} ms`);
  element("latency").title = `p95 ${status.latency_ms.p95} ms, p99 ${status.latency_ms.p99} ms`;
  setText(element("frame-ms"), `${status.frame_ms.toFixed(1)} ms`);
  setText(element("skipped"), status.skipped);
  setText(element("seen"), `${(100 * status.seen_share).toFixed(0)} %`);
  setText(element("evidence"), status.evidence);
  const { memory, recording } = status;
  setText(element("memory"), memory.keyframes === 0 ? "Nothing is remembered"
    : `${memory.keyframes} keyframes, ${memory.megabytes.toFixed(0)} MB` + (status.remembered_share > 0
      ? `; remembered from ${memory.median_age_s.toFixed(1)} s ago (median), the oldest ${memory.oldest_age_s.toFixed(1)} s` : ""));
  element("quality").hidden = status.quality_level === 0;
  setText(element("quality"), `To stay within ${status.budget_ms} ms: ${status.quality}`);
  plot(status.stage_ms);
  showCameras(status);
  if (status.frames > 0) element("picture").setAttribute("aria-label", pictureText(status));
  for (const object of status.objects) {
    const note = element(`object-${object.name}`);
    if (note) setText(note, object.kept ? "left in the picture" : object.message);
  }
  const button = element("record");
  button.disabled = !recording.allowed;
  button.title = recording.allowed ? "" : "Start diminish with --recordings FOLDER";
  button.classList.toggle("recording", recording.active);
  setText(button, recording.active ? "Stop recording" : "Record");
  setText(element("recording"), recording.problem || (recording.folder
    ? `${recording.folder}: ${recording.frames} frames${recording.dropped ? `, ${recording.dropped} dropped` : ""}`
    : recording.allowed ? "" : "To record, start diminish with --recordings FOLDER."));
}

// The picture, its slider, its keys and full screen.
import { element, setText } from "./dom.js";
import { pictures } from "./stream.js";
import { canWatch, watch } from "./video.js";

const frame = element("frame");
const picture = element("picture");
const video = element("video");
const slider = element("before-after");
let looking = new AbortController();
let view = "";
let hasVideo = false;
let shown = 0;

// How much of the left shows the camera's picture, 0 to 1.
const cameraShare = () => Number(slider.value) / 100;
const pause = (ms) => new Promise((resume) => setTimeout(resume, ms));

function count() {
  picture.dataset.frame = ++shown;
  element("waiting").hidden = true;
}

function fit(width, height) {
  if (picture.width === width && picture.height === height) return;
  picture.width = width;
  picture.height = height;
  moveDivider();
}

function show(image) {
  const isPair = image.height > image.width * 1.25 && view === "pair";
  const height = isPair ? image.height / 2 : image.height;
  fit(image.width, height);
  const context = picture.getContext("2d");
  if (!isPair) return context.drawImage(image, 0, 0);
  const split = Math.round(cameraShare() * image.width);
  context.drawImage(image, 0, height, image.width, height, 0, 0, image.width, height);
  if (split > 0) context.drawImage(image, 0, 0, split, height, 0, 0, split, height);
}

async function showJpegs(signal) {
  while (!signal.aborted) {
    try {
      for await (const { blob } of pictures(`api/stream.mjpg?view=${view}`, signal)) {
        const image = await createImageBitmap(blob);
        if (signal.aborted) return;
        show(image);
        image.close();
        showBy("JPEG");
        count();
      }
    } catch (error) {
      if (signal.aborted) return;
      element("waiting").textContent = error.message;
      element("waiting").hidden = false;
    }
    await pause(1000);
  }
}

function showBy(name) {
  const isVideo = name === "video";
  if (video.hidden === isVideo) video.hidden = !isVideo;
  picture.classList.toggle("under", isVideo);
  setText(element("sent-as"), name);
}

// JPEGs come at once. The video takes over with its first picture, and JPEGs again when it ends.
async function look(signal) {
  let jpegs = new AbortController();
  signal.addEventListener("abort", () => jpegs.abort());
  showJpegs(jpegs.signal);
  while (hasVideo && view === "after" && !signal.aborted) {
    let pictureCount = 0;
    try {
      await watch(video, signal, () => {
        if (++pictureCount === 1) jpegs.abort();
        fit(video.videoWidth, video.videoHeight);
        showBy("video");
        count();
      });
    } catch (error) {
      console.info(`no video: ${error.message}`);
    }
    if (signal.aborted) return;
    if (pictureCount === 0) return;  // what cannot be reached once will not be later
    jpegs = new AbortController();
    showJpegs(jpegs.signal);
    await pause(5000);
  }
}

function lookAnew() {
  looking.abort();
  looking = new AbortController();
  look(looking.signal);
}

// Called when it is known whether the program can send a video. It is shown where the page's
// address has `?video`: without a graphics card it is later than JPEGs (docs/http-api.md).
export function allowVideo(isAvailable) {
  const isWanted = isAvailable && canWatch() && new URLSearchParams(location.search).has("video");
  if (isWanted === hasVideo) return;
  hasVideo = isWanted;
  if (view === "after") lookAnew();
}

// Where the picture is inside its element, which may be wider or higher.
function pictureBox() {
  const { width, height } = picture.getBoundingClientRect();
  const scale = Math.min(width / picture.width, height / picture.height);
  return { left: (width - scale * picture.width) / 2, width: scale * picture.width };
}

function moveDivider() {
  const box = pictureBox();
  frame.style.setProperty("--bar", `${box.left}px`);
  element("divider").style.left = `${picture.offsetLeft + box.left + cameraShare() * box.width}px`;
}

function moveSlider() {
  const isSplit = cameraShare() > 0;
  for (const id of ["divider", "before-label", "after-label"]) element(id).hidden = !isSplit;
  slider.setAttribute("aria-valuetext", isSplit ? `the left ${slider.value} % show the camera's picture` : "the result alone");
  moveDivider();
  // Both pictures are only asked for while they are looked at.
  const wanted = isSplit ? "pair" : "after";
  if (view === wanted) return;
  view = wanted;
  lookAnew();
}

// ---- full screen, where a browser has it for all elements; else as large as its window
const stage = element("stage");
const isFull = () => document.fullscreenElement === stage || stage.classList.contains("full");

function showFull() {
  element("fullscreen").setAttribute("aria-pressed", String(isFull()));
  setText(element("fullscreen"), isFull() ? "Leave full screen" : "Full screen");
  moveDivider();
}

async function toggleFull() {
  if (document.fullscreenElement) {
    await document.exitFullscreen();
  } else if (stage.requestFullscreen) {
    await stage.requestFullscreen().catch(() => stage.classList.toggle("full"));
  } else {
    stage.classList.toggle("full");
  }
  showFull();
}

const keys = {
  f: toggleFull,
  ArrowLeft: () => { slider.value = Number(slider.value) - 5; moveSlider(); },
  ArrowRight: () => { slider.value = Number(slider.value) + 5; moveSlider(); },
  Escape: () => { if (stage.classList.contains("full")) toggleFull(); },
};

function pressKey(event) {
  if (event.target !== frame || event.ctrlKey || event.altKey || event.metaKey) return;
  const mode = document.querySelectorAll("#modes input")[Number(event.key) - 1];
  const act = mode ? () => mode.click() : keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!act) return;
  event.preventDefault();
  act();
}

export function startPicture() {
  slider.addEventListener("input", moveSlider);
  addEventListener("resize", moveDivider);
  document.addEventListener("fullscreenchange", showFull);
  element("fullscreen").onclick = toggleFull;
  frame.addEventListener("dblclick", toggleFull);
  frame.addEventListener("keydown", pressKey);
  moveSlider();
}

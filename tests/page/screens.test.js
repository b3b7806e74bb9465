// What the page looks like, compared with the pictures in screens/. After a change that is meant to be seen:
//   DIMINISH_UPDATE_SCREENS=1 scripts/test-page
// then look at the new pictures, and commit them. A page that differs is left in build/page-screens/.
import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { calendar, desk, patience, phone, root, serve, startBrowser, waitForPicture } from "./browser.js";

const references = fileURLToPath(new URL("screens", import.meta.url));
const failed = path.join(root, "build/page-screens");
const isUpdate = Boolean(process.env.DIMINISH_UPDATE_SCREENS);
const lost = {
  problems: ["rgbd0: camera lost: openni2: no device, expected one that is connected", "world marker 0 not visible in color"],
  to_do: ["check its cable and power, and that no other program uses it. It is tried again and again; nothing needs a restart",
    "turn the camera or move what hides the marker until all of its black square is in view, at least 40 pixels wide"],
};
const dead = { problems: ["no new picture"], to_do: ["see below under Cameras which one does not run"] };

let browser, server, status, picture;
before(async () => {
  server = await serve(calendar);
  browser = await startBrowser();
  for (let end = Date.now() + patience.timeout; !status?.frames; ) {
    assert.ok(Date.now() < end, "a frame");
    status = await fetch(`${server.url}api/status`).then((answer) => answer.json());
  }
  picture = await readFile(path.join(calendar, "truth/background/000000.jpg"));
  if (isUpdate) await mkdir(references, { recursive: true });
});
after(async () => {
  await browser?.close();
  await server?.stop();
});

// The real page, with a picture and figures that are the same on every machine.
async function frozen(options, known, changes) {
  const context = await browser.newContext({ ...options, deviceScaleFactor: 1 });
  const fixed = {
    ...status, frames: 100, skipped: 3, frames_per_second: 29.9, latency_ms: { p50: 31, p95: 40, p99: 52 }, frame_ms: 22.4,
    seen_share: 0.62, remembered_share: 0.31, evidence: "truly seen 62 % (witnessed 20 %), remembered 31 %, invented 7 %",
    memory: { keyframes: 12, megabytes: 44, median_age_s: 2.1, oldest_age_s: 9.8 }, problems: [], to_do: [],
    stage_ms: Object.fromEntries(Object.keys(status.stage_ms).map((name, i) => [name, 1 + (i % 4)])),
    cameras: status.cameras.map((camera) => ({ ...camera, state: "running", images_per_second: 30, images: 100, dropped: 0,
      duplicates: 0, out_of_order: 0, wrong_size: 0, damaged: 0, problem: "" })),
    posed: [true], markers: [2, 2], objects: [{ name: "calendar", kept: false, in_color: true, message: "" }],
    video: { available: false, problem: "" }, ...changes,
  };
  await context.addInitScript(([isKnown, given]) => {
    if (isKnown) localStorage.setItem("diminish-intro", "seen");
    globalThis.EventSource = class {
      constructor() { setTimeout(() => this.onmessage({ data: JSON.stringify(given) }), 100); }
    };
  }, [known, fixed]);
  const head = `--picture\r\nContent-Type: image/jpeg\r\nContent-Length: ${picture.length}\r\nX-Frame: 1\r\nX-Stamp: 1.0\r\n\r\n`;
  await context.route("**/api/stream.mjpg*", (route) => route.fulfill({
    contentType: "multipart/x-mixed-replace; boundary=picture", body: Buffer.concat([Buffer.from(head), picture, Buffer.from("\r\n")]),
  }));
  const page = await context.newPage();
  await page.goto(server.url);
  await waitForPicture(page);
  await page.locator("#evidence").getByText("truly seen 62 %").waitFor(patience);
  return page;
}

// The mean difference of two pictures in levels, and the share of clearly different blocks of 16x16
// pixels. Whether a letter is a little to the left, or bolder, hardly matters to a block's mean.
function difference(page, first, second) {
  return page.evaluate(async (sources) => {
    const [a, b] = await Promise.all(sources.map(async (source) => {
      const image = await createImageBitmap(await (await fetch(source)).blob());
      return { image, width: image.width, height: image.height };
    }));
    if (Math.abs(a.width - b.width) > 1 || Math.abs(a.height - b.height) > 1) return { mean: 255, share: 1 };
    const [width, height] = [Math.ceil(a.width / 8), Math.ceil(a.height / 8)];
    const pixels = [a, b].map(({ image }) => {
      // By halves, each an average of four.
      let from = image;
      for (let scale = 2; scale <= 8; scale *= 2) {
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = scale === 8 ? [width, height] : [Math.ceil(a.width / scale), Math.ceil(a.height / scale)];
        const context = canvas.getContext("2d");
        context.imageSmoothingQuality = "high";
        context.drawImage(from, 0, 0, canvas.width, canvas.height);
        from = canvas;
      }
      return from.getContext("2d").getImageData(0, 0, width, height).data;
    });
    let sum = 0, different = 0;
    for (let i = 0; i < pixels[0].length; i += 4) {
      const levels = Math.max(...[0, 1, 2].map((k) => Math.abs(pixels[0][i + k] - pixels[1][i + k])));
      sum += levels;
      if (levels > 40) ++different;
    }
    return { mean: sum / (width * height), share: different / (width * height) };
  }, [first, second]);
}

// Half the size: small enough for a repository, large enough to be looked at.
const halved = (page, source) => page.evaluate(async (from) => {
  const image = await createImageBitmap(await (await fetch(from)).blob());
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [Math.round(image.width / 2), Math.round(image.height / 2)];
  const context = canvas.getContext("2d");
  context.imageSmoothingQuality = "high";
  context.drawImage(image, 0, 0, canvas.width, canvas.height);
  return canvas.toDataURL("image/jpeg", 0.8);
}, source);

const bytesOf = (dataUrl) => Buffer.from(dataUrl.slice(dataUrl.indexOf(",") + 1), "base64");
const dataOf = (type, bytes) => `data:image/${type};base64,${bytes.toString("base64")}`;
const tolerance = { mean: 3, share: 0.003 };
const isAlike = ({ mean, share }) => mean < tolerance.mean && share < tolerance.share;

// A page without this one's rules of what may be loaded.
async function compare(name, screenshot) {
  const page = await browser.newPage();
  const now = await halved(page, dataOf("png", screenshot));
  const file = path.join(references, `${name}.jpg`);
  if (isUpdate) await writeFile(file, bytesOf(now));
  const result = await difference(page, now, dataOf("jpeg", await readFile(file)));
  await page.close();
  return { ...result, now };
}

async function check(name, page) {
  const screenshot = await page.screenshot({ fullPage: name.startsWith("phone") });
  const { mean, share, now } = await compare(name, screenshot);
  if (!isAlike({ mean, share })) {
    await mkdir(failed, { recursive: true });
    await writeFile(path.join(failed, `${name}.jpg`), bytesOf(now));
    assert.fail(`build/page-screens/${name}.jpg differs from tests/page/screens/${name}.jpg: by ${mean.toFixed(1)} levels, clearly in ${(100 * share).toFixed(1)} % of it`);
  }
}

for (const [name, options, known, changes] of [
  ["desk", desk, true, {}], ["desk-first-visit", desk, false, {}], ["desk-faults", desk, true, lost],
  ["phone", phone, true, {}], ["phone-first-visit", phone, false, {}], ["phone-faults", phone, true, lost],
]) {
  test(`it looks as before: ${name}`, async () => {
    const page = await frozen(options, known, changes);
    await check(name, page);
    await page.context().close();
  });
}

test("it looks as before: full-screen", async () => {
  const page = await frozen(desk, true, dead);
  await page.getByRole("button", { name: "Full screen" }).click();
  await page.getByRole("button", { name: "Leave full screen" }).waitFor(patience);
  await check("full-screen", page);
  await page.context().close();
});

test("what is missing or moved is noticed", { skip: isUpdate }, async () => {
  for (const [name, spoil] of [
    ["desk-faults", "#warnings { visibility: hidden !important; }"], ["desk-first-visit", "#intro { display: none !important; }"],
    ["desk", "aside { flex-basis: 300px; }"], ["desk", "#modes { display: none; }"], ["phone", "#picture { width: 80%; }"],
  ]) {
    const isPhone = name.startsWith("phone");
    const page = await frozen(isPhone ? phone : desk, name !== "desk-first-visit", name === "desk-faults" ? lost : {});
    await page.addStyleTag({ content: spoil }).catch(() => page.evaluate((text) => {
      const sheet = new CSSStyleSheet();
      sheet.replaceSync(text);
      document.adoptedStyleSheets = [sheet];
    }, spoil));
    const result = await compare(name, await page.screenshot({ fullPage: isPhone }));
    assert.ok(!isAlike(result), `${name} with ${spoil}: ${result.mean.toFixed(1)} levels, ${(100 * result.share).toFixed(1)} %`);
    await page.context().close();
  }
});

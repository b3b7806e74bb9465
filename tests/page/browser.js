// What the tests of the page share: the program, a browser, and patience.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

export const root = fileURLToPath(new URL("../..", import.meta.url));
const program = process.env.DIMINISH_PROGRAM ?? path.join(root, "build/release/diminish");
export const recordings = path.join(root, "demo/recordings");
export const calendar = path.join(recordings, "calendar");
export const patience = { timeout: 60_000 };
export const desk = { viewport: { width: 1280, height: 900 } };
export const phone = { viewport: { width: 360, height: 740 }, isMobile: true, hasTouch: true };

// The program as a user starts it; ends with `stop`.
export async function serve(...parameters) {
  const process = spawn(program, ["serve", ...parameters, "--port", "0"]);
  let errors = "";
  process.stderr.on("data", (text) => { errors += text; });
  const ended = new Promise((resolve) => process.on("exit", resolve));
  const url = await new Promise((resolve, reject) => {
    let text = "";
    process.stdout.on("data", (data) => {
      text += data;
      const found = /Open (\S+)/.exec(text);
      if (found) resolve(found[1]);
    });
    ended.then((code) => reject(new Error(`diminish ended with ${code}: ${errors}`)));
  });
  return {
    url,
    async stop() {
      process.kill("SIGINT");
      assert.equal(await ended, 0, errors);
    },
  };
}

export const startBrowser = () => chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--font-render-hinting=none"],
});

// A page that has shown a picture, and notes what it complains of. `known`: not the first visit.
export async function open(browser, url, { known = true, ...options } = {}) {
  const context = await browser.newContext({ ...desk, ...options });
  if (known) await context.addInitScript(() => localStorage.setItem("diminish-intro", "seen"));
  const page = await context.newPage();
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(error.message));
  await page.goto(url);
  await waitForPicture(page);
  return page;
}

export const waitForPicture = (page) => page.waitForSelector("#picture[data-frame]", { ...patience, state: "attached" });
export const frameNumber = (page) => page.locator("#picture").getAttribute("data-frame").then(Number);
export const statusOf = (page) => page.evaluate(() => fetch("api/status").then((answer) => answer.json()));

// What is shown, a video or JPEGs, summed over a part of it: [x, y, width, height] in shares of its size.
export function brightness(page, part) {
  return page.evaluate(([x, y, width, height]) => {
    const video = document.getElementById("video");
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [320, 256];
    const context = canvas.getContext("2d");
    context.drawImage(video.hidden ? document.getElementById("picture") : video, 0, 0, canvas.width, canvas.height);
    const { data } = context.getImageData(x * canvas.width, y * canvas.height, width * canvas.width, height * canvas.height);
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) sum += data[i] + data[i + 1] + data[i + 2];
    return sum / (data.length / 4) / 3;
  }, part);
}

export async function eventually(isTrue, what) {
  const end = Date.now() + patience.timeout;
  while (Date.now() < end) {
    if (await isTrue()) return;
    await new Promise((resume) => setTimeout(resume, 50));
  }
  assert.fail(`never: ${what}`);
}

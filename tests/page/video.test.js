// The picture as a video by WebRTC, and how long it takes to arrive.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { brightness, calendar, eventually, frameNumber, open as openIn, serve, startBrowser, statusOf } from "./browser.js";

let browser, server, problem;
before(async () => {
  server = await serve(calendar, "--color", `clock:recording:${calendar}?loop`, "--rgbd", `recording:${calendar}?loop`);
  browser = await startBrowser();
  ({ problem } = await fetch(`${server.url}api/status`).then((answer) => answer.json()).then(({ video }) => video));
});
after(async () => {
  await browser?.close();
  await server?.stop();
});
const open = (url = `${server.url}?video`) => openIn(browser, url);
const sentAs = (page, name) => eventually(async () => (await page.locator("#sent-as").textContent()) === name, `sent as ${name}`);
// Built without GStreamer's WebRTC, or packages missing: the page shows JPEGs (page.test.js).
const withVideo = (name, body) => test(name, async (t) => problem ? t.skip(problem) : body(t));

withVideo("the video takes over from the JPEGs, and shows the same", async () => {
  const page = await open();
  await sentAs(page, "video");
  const first = await frameNumber(page);
  await eventually(async () => (await frameNumber(page)) > first + 10, "it moves");
  // Against a still of the program, as sums over a grid: the recording moves in between.
  const parts = [0, 0.25, 0.5, 0.75].flatMap((x) => [0.1, 0.4, 0.7].map((y) => [x, y, 0.25, 0.25]));
  const shown = [];
  for (const part of parts) shown.push(await brightness(page, part));
  const still = await page.evaluate(async (places) => {
    const image = await createImageBitmap(await (await fetch("api/frame.png")).blob());
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [320, 256];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0, 320, 256);
    return places.map(([x, y, width, height]) => {
      const { data } = context.getImageData(x * 320, y * 256, width * 320, height * 256);
      let sum = 0;
      for (let i = 0; i < data.length; i += 4) sum += data[i] + data[i + 1] + data[i + 2];
      return sum / (data.length / 4) / 3;
    });
  }, parts);
  assert.ok(Math.max(...still) - Math.min(...still) > 20, "the parts are not alike");
  shown.forEach((level, i) => assert.ok(Math.abs(level - still[i]) < 8, `part ${i}: ${level}, expected ${still[i]}`));

  // Both pictures of a frame only come as a JPEG.
  await page.locator("#before-after").fill("50");
  await sentAs(page, "JPEG");
  await page.locator("#before-after").fill("0");
  await sentAs(page, "video");
  assert.deepEqual(page.errors, []);
  await page.close();
  await eventually(async () => (await fetch(`${server.url}api/status`).then((answer) => answer.json())).viewers === 0, "nobody looks");
});

withVideo("where the video cannot be had, or ends, JPEGs go on", async () => {
  const context = await browser.newContext();
  await context.addInitScript(() => {
    globalThis.peers = [];
    const Peer = globalThis.RTCPeerConnection;
    globalThis.RTCPeerConnection = class extends Peer {
      constructor(...parameters) { super(...parameters); globalThis.peers.push(this); }
    };
  });
  const page = await context.newPage();
  await page.goto(`${server.url}?video`);
  await sentAs(page, "video");
  await context.route("**/api/webrtc", (route) => route.abort());
  await page.evaluate(() => globalThis.peers.at(-1).close());
  await sentAs(page, "JPEG");
  const first = await frameNumber(page);
  await eventually(async () => (await frameNumber(page)) > first + 10, "it moves");
  await page.reload();
  await eventually(async () => (await frameNumber(page)) > 10, "it moves");
  assert.equal(await page.locator("#sent-as").textContent(), "JPEG");
  await context.close();
});

withVideo("unasked, the page shows JPEGs", async () => {
  const page = await open(server.url);
  const first = await frameNumber(page);
  await eventually(async () => (await frameNumber(page)) > first + 10, "it moves");
  assert.equal(await page.locator("#sent-as").textContent(), "JPEG");
  assert.equal((await statusOf(page)).viewers, 1);
  await page.close();
});

// Glass to glass: from the sensor's timestamp, drawn into the picture, to the moment at which the
// browser hands the picture to the screen. Printed, not judged: a busy machine is slow.
async function measure(page, seconds) {
  // The browser's clock against this process's, which is the program's monotonic one.
  let [offset, shortest] = [0, Infinity];
  for (let i = 0; i < 30; ++i) {
    const before = Number(process.hrtime.bigint()) / 1e6;
    const now = await page.evaluate(() => performance.now());
    const after = Number(process.hrtime.bigint()) / 1e6;
    if (after - before < shortest) [offset, shortest] = [(before + after) / 2 - now, after - before];
  }
  return page.evaluate(async ([clockOffset, duration]) => {
    const [bits, size, turn] = [40, 16, 2 ** 32];
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [bits * size, size];
    const context = canvas.getContext("2d", { willReadFrequently: true });
    const latencies = [];
    const take = (source, at) => {
      context.drawImage(source, 0, 0, bits * size, size, 0, 0, bits * size, size);
      const { data } = context.getImageData(0, 0, bits * size, size);
      let [ticks, check] = [0, 0];
      for (let bit = 0; bit < bits; ++bit) {
        let level = 0;
        for (let y = 4; y < 12; ++y) for (let x = 4; x < 12; ++x) level += data[4 * (y * bits * size + bit * size + x) + 1];
        if (level <= 127 * 64) continue;
        if (bit < 32) ticks += 2 ** bit; else check += 2 ** (bit - 32);
      }
      let sum = 0x5a;
      for (let shift = 0; shift < 32; shift += 8) sum = (Math.imul(sum, 31) + Math.floor(ticks / 2 ** shift) % 256) >>> 0;
      if (((sum ^ (sum >>> 8)) & 255) !== check) return;
      latencies.push((((at + clockOffset) * 10 - ticks) % turn) / 10);
    };
    const [video, picture] = [document.getElementById("video"), document.getElementById("picture")];
    const onVideo = (_, { presentationTime }) => { take(video, presentationTime); video.requestVideoFrameCallback(onVideo); };
    const observer = new MutationObserver(() => {
      if (video.hidden) requestAnimationFrame(() => take(picture, performance.now()));
    });
    if (video.hidden) observer.observe(picture, { attributes: true }); else video.requestVideoFrameCallback(onVideo);
    await new Promise((resume) => setTimeout(resume, duration * 1000));
    observer.disconnect();
    return latencies.sort((a, b) => a - b);
  }, [offset, seconds]);
}

withVideo("glass to glass, beside JPEGs", async (t) => {
  const seconds = Number(process.env.DIMINISH_LATENCY_SECONDS ?? 2);
  for (const [name, url] of [["video", `${server.url}?video`], ["JPEG", server.url], ["video", `${server.url}?video`], ["JPEG", server.url]]) {
    const page = await open(url);
    await sentAs(page, name);
    let latencies = [];
    await eventually(async () => (latencies = await measure(page, seconds)).length > 0, `${name}: a readable time`);
    const { latency_ms } = await statusOf(page);
    const at = (share) => latencies[Math.min(latencies.length - 1, Math.floor(share * latencies.length))].toFixed(0);
    t.diagnostic(`${name}: ${at(0.5)} ms (95 %: ${at(0.95)}) of ${latencies.length} pictures; to the finished picture ${latency_ms.p50.toFixed(0)} ms`);
    assert.ok(latencies[0] > 0, "not before it was taken");
    await page.close();
  }
});

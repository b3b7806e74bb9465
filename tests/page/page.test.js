// The page of `diminish serve` in a real browser. Run by scripts/test-page.
import assert from "node:assert/strict";
import { cp, mkdtemp, readdir, readFile, rm, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { brightness, calendar, eventually, frameNumber, open as openIn, patience, serve, startBrowser, statusOf, waitForPicture } from "./browser.js";

let browser, server, folder;

before(async () => {
  folder = await mkdtemp(path.join(tmpdir(), "diminish-page-"));
  server = await serve(calendar, "--recordings", folder);
  browser = await startBrowser();
});

after(async () => {
  await browser?.close();
  await server?.stop();
  if (folder) await rm(folder, { recursive: true });
});

const open = (url = server.url, options = {}) => openIn(browser, url, options);

test("the picture moves", async () => {
  const page = await open();
  const first = await frameNumber(page);
  await eventually(async () => (await frameNumber(page)) > first + 5, "five more frames");
  assert.ok((await brightness(page, [0, 0, 1, 1])) > 20, "it is not black");
  await eventually(async () => Number(await page.locator("#rate").textContent()) > 1, "a frame rate");
  assert.match(await page.locator("#latency").textContent(), /\d+ ms/);
  assert.equal(await page.locator("#cameras tbody tr").count(), 2);
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("the slider shows the camera's picture on its left", async () => {
  const page = await open();
  const sample = async () => {
    const before = await frameNumber(page);
    await eventually(async () => (await frameNumber(page)) > before + 8, "some frames");
    return brightness(page, [0.3, 0.3, 0.4, 0.4]);
  };
  const result = await sample();
  await page.locator("#before-after").fill("100");
  await page.locator("#before-label").waitFor(patience);
  const camera = await sample();
  assert.ok(Math.abs(camera - result) > 3, `camera ${camera}, result ${result}`);
  await page.locator("#before-after").fill("0");
  await eventually(async () => Math.abs((await sample()) - result) < Math.abs(camera - result) / 2,
    "the result again");
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("modes, sliders and objects change the picture for all who look", async () => {
  const [page, other] = [await open(), await open()];
  await page.getByRole("radio", { name: "provenance" }).click();
  await eventually(() => page.getByRole("radio", { name: "provenance", checked: true }).isVisible(), "mode");
  await eventually(async () => (await statusOf(other)).mode === "provenance", "the mode");
  await page.getByRole("radio", { name: "remove" }).click();

  await page.getByRole("checkbox", { name: "calendar" }).uncheck();
  await eventually(async () => (await statusOf(other)).mask_share === 0, "nothing is removed");
  await page.getByText("left in the picture").waitFor(patience);
  await page.getByRole("checkbox", { name: "calendar" }).check();
  await eventually(async () => (await statusOf(other)).mask_share > 0, "it is removed again");

  await page.locator("input[name=mask_margin_px]").fill("12");
  await page.locator("input[name=mask_margin_px]").dispatchEvent("change");
  const settings = () => other.evaluate(() => fetch("api/settings").then((answer) => answer.json()));
  const margin = async () => (await settings()).settings.find(({ name }) => name === "mask_margin_px").value;
  await eventually(async () => (await margin()) === 12, "the margin");

  // Both see pictures go on.
  for (const viewer of [page, other]) {
    const first = await frameNumber(viewer);
    await eventually(async () => (await frameNumber(viewer)) > first + 3, "both see it move");
    assert.deepEqual(viewer.errors, []);
  }
  await Promise.all([page.close(), other.close()]);
});

test("the page says where the pixels come from, and forgets", async () => {
  const page = await open();
  await page.locator("#evidence").getByText(/truly seen \d+ %.*invented \d+ %/).waitFor(patience);
  const keyframes = async () => Number(/^(\d+) keyframes/.exec(await page.locator("#memory").textContent())?.[1] ?? 0);
  await eventually(async () => (await keyframes()) > 2, "keyframes");
  await page.getByRole("button", { name: "Forget" }).click();
  await eventually(async () => (await keyframes()) <= 2, "forgotten");
  await page.locator("select[name=memory]").selectOption("off");
  await page.getByText("Nothing is remembered").waitFor(patience);
  await page.locator("select[name=memory]").selectOption("on");
  await eventually(async () => (await keyframes()) > 0, "keyframes again");
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("the record button makes a recording", async () => {
  const page = await open();
  await page.getByRole("button", { name: "Record" }).click();
  await page.getByRole("button", { name: "Stop recording" }).waitFor(patience);
  await page.getByText(/: [1-9]\d* frames/).waitFor(patience);
  const [made] = await readdir(folder);
  // On a busy machine the first frames may be without the RGB-D camera's images.
  await eventually(async () => {
    const list = await readFile(path.join(folder, made, "rgbd0_depth.txt"), "utf8");
    return list.split("\n").some((line) => line.endsWith(".png"));
  }, "a depth image is recorded");
  await page.getByRole("button", { name: "Stop recording" }).click();
  await page.getByRole("button", { name: "Record", exact: true }).waitFor(patience);
  assert.deepEqual(page.errors, []);
  await page.close();
});

test("wrong values are refused in plain words", async () => {
  const page = await open();
  await page.getByText("All settings").click();
  const input = page.locator("#all-settings input[name=surroundings_px]");
  await input.fill("-3");
  await input.press("Enter");
  await page.locator("#warnings").getByText("surroundings_px: expected 1 to 10000").waitFor(patience);
  await page.close();
});

test("a camera that is gone is said in the warning bar", async () => {
  const lame = await serve(calendar, "--color", `recording:${calendar}?loop`, "--rgbd", "recording:/nowhere");
  const page = await open(lame.url);
  await page.locator("#warnings").getByText(/rgbd0: camera lost/).waitFor(patience);
  assert.deepEqual(page.errors, []);
  await page.close();
  await lame.stop();
});

test("a marker that is hidden is said in the warning bar", async () => {
  // The scene's world marker is one that nobody sees.
  const hidden = await mkdtemp(path.join(tmpdir(), "diminish-hidden-"));
  await cp(calendar, hidden, { recursive: true });
  const scene = await readFile(path.join(hidden, "scene.yaml"), "utf8");
  await writeFile(path.join(hidden, "scene.yaml"), scene.replace(/(world_marker:\s*\{\s*id:\s*)\d+/, "$149"));
  const lame = await serve(hidden);
  const page = await open(lame.url);
  await page.locator("#warnings").getByText(/world marker 49 not visible in/).first().waitFor(patience);
  await page.close();
  await lame.stop();
  await rm(hidden, { recursive: true });
});

test("the token leaves the address, and the page still works", async () => {
  const secret = await serve(calendar, "--token", "sesame");
  const page = await open(secret.url);
  const violations = [];
  page.on("console", (message) => { if (message.type() === "error") violations.push(message.text()); });
  assert.equal(new URL(page.url()).search, "");
  await page.reload();
  await waitForPicture(page);
  const first = await frameNumber(page);
  await eventually(async () => (await frameNumber(page)) > first + 2, "more frames");
  const [still] = await Promise.all([page.waitForEvent("download"), page.locator("#still").click()]);
  assert.equal(still.suggestedFilename(), "diminish.png");
  assert.deepEqual([page.errors, violations], [[], []]);
  await page.close();
  await secret.stop();
});

test("a screenshot for the docs", { skip: !process.env.DIMINISH_SCREENSHOT }, async () => {
  const page = await open();
  await page.locator("#before-after").fill("50");
  await page.locator("#before-after").blur();
  await eventually(async () => /%/.test(await page.locator("#seen").textContent()), "the first figures");
  await page.waitForTimeout(8000);
  await page.screenshot({ path: process.env.DIMINISH_SCREENSHOT, type: "jpeg", quality: 85 });
  await page.close();
});

// The page for those who see it first, have no mouse, do not see, or hold a phone.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { brightness, calendar, eventually, open as openIn, patience, phone, serve, startBrowser, statusOf, waitForPicture } from "./browser.js";

let browser, server;
before(async () => {
  server = await serve(calendar);
  browser = await startBrowser();
});
after(async () => {
  await browser?.close();
  await server?.stop();
});
const open = (options = {}, url = server.url) => openIn(browser, url, options);
const lameServer = () => serve(calendar, "--color", `recording:${calendar}?loop`, "--rgbd", "recording:/nowhere");
const focused = (page) => page.evaluate(() => document.activeElement.id || document.activeElement.value);

test("the first visit explains itself, once", async () => {
  const page = await open({ known: false });
  const intro = page.getByRole("region", { name: "What you see" });
  await intro.getByText("Here it takes out: calendar.").waitFor(patience);
  for (const what of ["Compare.", "Tell real from invented.", "Put right what is wrong."]) {
    assert.ok(await intro.getByText(what).isVisible(), what);
  }
  await page.getByRole("button", { name: "Got it" }).click();
  assert.ok(!(await intro.isVisible()));
  await page.reload();
  await waitForPicture(page);
  assert.ok(!(await intro.isVisible()), "it is remembered");
  const help = page.getByRole("button", { name: "What is this?" });
  await help.click();
  assert.ok(await intro.isVisible(), "it can be read again");
  assert.equal(await help.getAttribute("aria-expanded"), "true");
  assert.equal(await focused(page), "intro-title");
  assert.deepEqual(page.errors, []);
});

test("what is wrong comes first, with what to do, and is said once", async () => {
  const lame = await lameServer();
  const page = await open({}, lame.url);
  const wrong = page.getByRole("region", { name: "What is wrong" });
  await wrong.getByText(/rgbd0: camera lost/).waitFor(patience);
  assert.ok(await wrong.getByText(/To do: check its cable/).isVisible());
  const [bar, picture] = [await wrong.boundingBox(), await page.locator("#picture").boundingBox()];
  assert.ok(bar.y + bar.height <= picture.y, "above the picture");

  const alert = page.getByRole("alert");
  await eventually(async () => /camera lost.*check its cable/.test(await alert.textContent()), "it is said");
  await page.evaluate(() => {
    globalThis.said = 0;
    new MutationObserver(() => ++globalThis.said).observe(document.getElementById("announcement"), { childList: true });
  });
  const frames = (await statusOf(page)).frames;
  await eventually(async () => (await statusOf(page)).frames > frames + 30, "30 more frames");
  assert.ok((await page.evaluate(() => globalThis.said)) <= 1, "not again with every frame");
  await lame.stop();
  await wrong.getByText("No answer from diminish").waitFor(patience);
  assert.ok(await wrong.getByText(/To do: see in its terminal/).isVisible());
});

test("the keyboard is enough", async () => {
  const page = await open();
  const stops = [];
  for (let i = 0; i < 7; ++i) {
    await page.keyboard.press("Tab");
    stops.push(await focused(page));
    const outline = await page.evaluate(() => {
      const shown = document.activeElement.type === "radio" ? document.activeElement.nextElementSibling : document.activeElement;
      return getComputedStyle(shown).outlineStyle;
    });
    assert.notEqual(outline, "none", `the focus is seen at ${stops.at(-1)}`);
  }
  assert.deepEqual(stops.slice(0, 6), ["help", "frame", "fullscreen", "before-after", "remove", "forget"]);

  // The view modes are one stop, and keep the focus when the program has answered.
  await page.getByRole("radio", { name: "remove" }).focus();
  await page.keyboard.press("ArrowRight");
  await eventually(async () => (await statusOf(page)).mode === "half", "the next mode");
  assert.equal(await focused(page), "half");

  await page.locator("#frame").focus();
  await page.keyboard.press("5");
  await eventually(async () => (await statusOf(page)).mode === "provenance", "the fifth mode");
  assert.equal(await focused(page), "frame");
  await page.keyboard.press("1");
  await eventually(async () => (await statusOf(page)).mode === "remove", "the first mode");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  assert.equal(await page.locator("#before-after").inputValue(), "10");
  assert.match(await page.locator("#before-after").getAttribute("aria-valuetext"), /left 10 %/);
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("ArrowLeft");
  assert.equal(await page.locator("#before-after").getAttribute("aria-valuetext"), "the result alone");
  assert.deepEqual(page.errors, []);
});

test("full screen shows the picture and its controls", async () => {
  const page = await open();
  await page.locator("#frame").focus();
  await page.keyboard.press("f");
  await page.waitForFunction(() => document.fullscreenElement?.id === "stage");
  const button = page.getByRole("button", { name: "Leave full screen" });
  await button.waitFor(patience);
  const { width, height } = await page.evaluate(() => ({ width: innerWidth, height: innerHeight }));
  const box = await page.locator("#frame").boundingBox();
  assert.ok(box.height > 0.75 * height && box.width > 0.95 * width, JSON.stringify(box));
  const modes = await page.locator("#modes").boundingBox();
  assert.ok(modes.y + modes.height <= height, "the modes are in sight");
  assert.ok((await brightness(page, [0, 0, 1, 1])) > 20, "it is not black");
  await button.click();
  await page.waitForFunction(() => !document.fullscreenElement);
  assert.deepEqual(page.errors, []);
});

test("whoever cannot see it is told what everything is", async () => {
  const page = await open({ known: false });
  await page.getByText("All settings").click();
  const unnamed = (await page.locator("body").ariaSnapshot()).split("\n").filter((line) =>
    /^\s*- (button|slider|checkbox|radio|combobox|textbox|spinbutton|link|img|table|radiogroup|group)\b(?! ")/.test(line));
  // <details> is a group with its summary for a name.
  assert.deepEqual(unnamed.filter((line) => line.trim() !== "- group:"), []);
  const picture = page.getByRole("img", { name: /without calendar/ });
  await picture.waitFor({ ...patience, state: "attached" });
  assert.equal(await page.getByRole("row", { name: /^rgbd0 running/ }).count(), 1);
  // Contrast of text, as WCAG 2.1 computes it: 4.5 at least.
  const faint = await page.evaluate(() => {
    const light = (color) => {
      const [r, g, b] = color.match(/[\d.]+/g).map((v) => (v /= 255, v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const ground = (node) => {
      for (; node; node = node.parentElement) {
        const color = getComputedStyle(node).backgroundColor;
        if (/^rgb\(/.test(color)) return color;
      }
      return "rgb(0, 0, 0)";
    };
    const found = [];
    for (const node of document.querySelectorAll("body *")) {
      const isText = [...node.childNodes].some((child) => child.nodeType === 3 && child.data.trim());
      if (!isText || !node.checkVisibility() || node.closest(":disabled")) continue;
      const [a, b] = [light(getComputedStyle(node).color), light(ground(node))];
      const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
      if (contrast < 4.5) found.push(`${node.tagName} ${node.textContent.trim().slice(0, 20)}: ${contrast.toFixed(1)}`);
    }
    return found;
  });
  assert.deepEqual(faint, []);
});

test("it fits a phone", async () => {
  const lame = await lameServer();
  for (const [url, known] of [[server.url, false], [server.url, true], [lame.url, true]]) {
    const page = await open({ ...phone, known }, url);
    if (url === lame.url) await page.locator("#warnings").getByText(/camera lost/).waitFor(patience);
    await page.getByText("All settings").click();
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 360, `the page is ${width} pixels wide`);
    for (const target of [page.getByRole("radio", { name: "half" }), page.getByRole("button", { name: "What is this?" }),
      page.getByRole("button", { name: "Forget" }), page.locator(".checks label").first()]) {
      assert.ok((await target.boundingBox()).height >= 40, `large enough for fingers: ${target}`);
    }
    const picture = await page.locator("#picture").boundingBox();
    assert.ok(picture.width > 330, "the picture is as wide as the phone");
    if (known && url === server.url) assert.ok(picture.y + picture.height < 740, "and seen at once");
    assert.deepEqual(page.errors, []);
    await page.close();
  }
  await lame.stop();
});

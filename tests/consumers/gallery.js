// Opens the gallery's page from disk, as a guest does: looks at it, searches, opens surfaces, turns one.
// Anything that the browser's console complains about is a fault.
"use strict";
const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const { pathToFileURL } = require("node:url");
const { chromium } = require("playwright-core");

const folder = path.resolve(process.argv[2]);
const address = pathToFileURL(path.join(folder, "index.html")).href;
const windows = { desktop: { width: 1440, height: 900 }, phone: { width: 390, height: 844 } };
const flags = [
  "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
];
const executablePath = process.env.CHROMIUM || "/usr/bin/chromium";

// How many pixels of the model's canvas are not transparent.
const drawn = viewer => viewer.evaluate(async element => {
  const picture = await createImageBitmap(await element.toBlob({ idealAspect: false }));
  const canvas = new OffscreenCanvas(picture.width, picture.height);
  const context = canvas.getContext("2d");
  context.drawImage(picture, 0, 0);
  const { data } = context.getImageData(0, 0, picture.width, picture.height);
  return data.filter((value, i) => i % 4 === 3 && value > 0).length / (data.length / 4);
});

async function visit(browser, name, viewport, colorScheme) {
  const page = await browser.newPage({ viewport, colorScheme, hasTouch: name === "phone" });
  const complaints = [];
  const requests = [];
  page.on("console", message => ["error", "warning"].includes(message.type()) &&
    !message.text().includes("GPU stall due to ReadPixels") && complaints.push(message.text()));
  page.on("pageerror", error => complaints.push(String(error)));
  page.on("requestfailed", request => complaints.push(`${request.url()} failed`));
  page.on("request", request => requests.push(request.url()));
  await page.goto(address);
  const look = what => fs.promises.mkdir(path.join(folder, "windows"), { recursive: true })
    .then(() => page.screenshot({ path: path.join(folder, "windows", `${name}_${what}.png`) }));

  const n = await page.evaluate("surfaces.length");
  assert.equal(await page.locator(".card").count(), n);
  await page.waitForFunction(() => [...document.querySelectorAll(".card img")].slice(0, 4).every(i => i.naturalWidth > 0));
  const width = await page.evaluate("document.documentElement.scrollWidth");
  assert.ok(width <= viewport.width, `${name}: ${width} pixels wide`);
  await look("cards");

  await page.fill("#query", "heart");
  assert.equal(await page.locator(".card:visible").count(), 1);
  assert.equal(await page.locator("#count").innerText(), "1 surface");
  await page.locator(".card:visible").click();
  const viewer = page.locator("model-viewer");
  await page.waitForFunction(() => document.querySelector("model-viewer")?.loaded, null, { timeout: 60000 });
  assert.match(await page.locator("#words").innerText(), /Heart.*Euler number/s);
  const share = await drawn(viewer);
  assert.ok(share > 0.05, `${name}: the model covers ${share}`);
  await page.waitForTimeout(500);
  await look("heart");

  const orbit = () => viewer.evaluate(element => element.getCameraOrbit().theta);
  const before = await orbit();
  const box = await viewer.boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 4, box.y + box.height / 2, { steps: 5 });
  await page.mouse.up();
  await page.waitForTimeout(500);
  assert.notEqual(await orbit(), before, `${name}: the model does not turn`);

  await page.click("#close");
  await page.fill("#query", "");
  await page.click("#count");
  for (const surface of await page.evaluate("surfaces.map(({ name, has_model }) => ({ name, has_model }))")) {
    if (name === "phone" || !surface.has_model) continue;
    await page.evaluate(name => show(surfaces.find(surface => surface.name === name)), surface.name);
    await page.waitForFunction(() => document.querySelector("model-viewer")?.loaded, null, { timeout: 60000 });
  }
  const abroad = requests.filter(url => !/^(file|blob|data):/.test(url));
  assert.deepEqual(abroad, [], `${name}: the page asks others`);
  assert.deepEqual(complaints, [], `${name}: the console`);
  await page.close();
  console.log(`gallery page, ${name}: ok, ${n} surfaces`);
}

(async () => {
  // A profile of its own, which goes when the browser does.
  const browser = await chromium.launch({ executablePath, headless: true, args: flags });
  try {
    for (const [name, viewport] of Object.entries(windows)) {
      await visit(browser, name, viewport, name === "phone" ? "dark" : "light");
    }
  } finally {
    await browser.close();
  }
})().catch(error => {
  console.error(error.message);
  process.exitCode = 1;
});

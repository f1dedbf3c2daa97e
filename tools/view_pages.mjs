// Opens the pages of `karui view` in a headless Chromium and uses them as people do: moves
// sliders, follows a camera path, drops files, ends the server. State is asserted first,
// pictures after it and tolerantly.
//
//   npm install playwright-core    (NODE_PATH or beside)
//   node tools/view_pages.mjs --karui FILE [--models DIR] [--chromium FILE] [--out DIR] [TEST...]
//
// A line a test. Without --models DIR (scans/bun_zipper.ply.gz, gltf/FlightHelmet) those that
// need it say SKIPPED. Exit code 1 if a test failed, 2 on wrong use or where something is not
// installed or does not start.

import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { fail, launch } from "./browser.mjs";

const DESKTOP = { width: 1280, height: 720 };
const PHONE = { width: 390, height: 844 };
const WAIT = { timeout: 120_000 };
const ASSET = path.join(path.dirname(fileURLToPath(import.meta.url)), "../assets/sheen_cloth.glb");
const CUBE = `${["-1 -1 -1", "1 -1 -1", "1 1 -1", "-1 1 -1", "-1 -1 1", "1 -1 1", "1 1 1", "-1 1 1"].map((v) => `v ${v}\n`).join("")}f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n`;

function parseArguments(args) {
  const options = { karui: null, models: null, chromium: null, out: null, tests: [] };
  for (let i = 0; i < args.length; i++) {
    const name = args[i].replace(/^--/, "");
    if (args[i].startsWith("--") && name in options && name !== "tests") options[name] = args[++i];
    else options.tests.push(args[i]);
  }
  if (!options.karui) fail("usage: view_pages.mjs --karui FILE [--models DIR] [--chromium FILE] [--out DIR] [TEST...]");
  return options;
}

const options = parseArguments(process.argv.slice(2));
options.karui = path.resolve(options.karui);
if (!existsSync(options.karui)) fail(`${options.karui}: no such file`);
const scratch = mkdtempSync(path.join(tmpdir(), "karui-pages-"));

const karui = (...args) => execFileSync(options.karui, ["--quiet", ...args], { encoding: "utf8", cwd: scratch });
const model = (name) => (options.models && existsSync(path.join(options.models, name)) ? path.join(options.models, name) : null);

function check(right, what) {
  if (!right) throw new Error(what);
}

function equal(found, expected, what) {
  check(JSON.stringify(found) === JSON.stringify(expected), `${what}: ${JSON.stringify(found)}, expected ${JSON.stringify(expected)}`);
}

/** A running `karui view`; its address is the first line it prints. */
async function serve(...files) {
  const child = spawn(options.karui, ["view", "--no-open", "--quiet", ...files], { stdio: ["ignore", "pipe", "inherit"] });
  const ended = new Promise((resolve) => child.on("exit", resolve));
  const url = await new Promise((resolve, reject) => {
    let text = "";
    child.stdout.on("data", (data) => {
      text += data;
      if (text.includes("\n")) resolve(text.trim());
    });
    ended.then((code) => reject(new Error(`karui view ended with ${code}`)));
  });
  const stop = (signal = "SIGTERM") => (child.kill(signal), ended);
  return { url, stop };
}

async function open(url, viewport = DESKTOP) {
  const page = await browser.newPage({ viewport });
  page.complaints = [];
  page.on("pageerror", (error) => page.complaints.push(`${error}`));
  page.on("console", (message) => {
    const known = /GPU stall|GL Driver Message|software WebGL|WebGL-|Failed to load resource/.test(message.text());
    if (message.type() === "error" && !known) page.complaints.push(message.text());
  });
  await page.goto(url);
  return page;
}

/** Serves the files, opens a page, closes both whatever happens. */
async function withPage(files, hash, test, viewport) {
  const server = await serve(...files);
  let page;
  try {
    page = await open(server.url + hash, viewport);
    await test(page, server);
    equal(page.complaints, [], "errors of the page");
  } finally {
    await page?.close();
    await server.stop("SIGKILL");
  }
}

const ready = (page) => page.waitForFunction(() => window.karui?.ready === true, undefined, WAIT);
const probe = (page, read) => page.evaluate(read);
const shot = async (page, name) => options.out && page.screenshot({ path: path.join(options.out, `viewer-${name}.png`) });
const toast = (page, text) => page.waitForFunction((t) => document.querySelector(".toasts")?.textContent.includes(t), text, WAIT);

/** Share of the picture's pixels that are not of the most frequent colour, the background. */
async function drawn(page) {
  const png = (await page.locator("main canvas").first().screenshot()).toString("base64");
  return page.evaluate(async (data) => {
    const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, image.width, image.height);
    const counts = new Map();
    for (let i = 0; i < pixels.length; i += 4) {
      const color = (pixels[i] >> 4) * 256 + (pixels[i + 1] >> 4) * 16 + (pixels[i + 2] >> 4);
      counts.set(color, (counts.get(color) ?? 0) + 1);
    }
    return 1 - (4 * Math.max(...counts.values())) / pixels.length;
  }, png);
}

async function slide(page, label, to) {
  await page.getByRole("slider", { name: label }).evaluate((slider, value) => {
    slider.value = value;
    slider.dispatchEvent(new Event("input", { bubbles: true }));
  }, String(to));
}

/** What every control of the panel says; a slider what it is set to, not where its handle is rounded to. */
const controls = (page) => probe(page, () => [...document.querySelectorAll(".panel :is(input, select, [role=radio])")].map((control) => {
  const label = control.closest("label, .field")?.textContent ?? control.textContent;
  const value = control.type === "checkbox" ? control.checked : control.getAttribute("aria-checked") ?? control.getAttribute("aria-valuetext") ?? control.value;
  return [label, value];
}));

/** Opens the address that a page has by now in another one: the controls say the same there. */
async function byLink(page, part) {
  await page.waitForFunction((text) => location.hash.includes(text), part, WAIT);
  await page.waitForTimeout(400);
  const other = await open(page.url());
  await ready(other);
  equal(await controls(other), await controls(page), "controls of the page by link");
  equal(other.complaints, [], "errors of the page by link");
  return other;
}

/** A PLY of a wavy square, two triangles a cell. */
function waves(cells) {
  const [side, name] = [cells + 1, path.join(scratch, `waves${cells}.ply`)];
  const head = Buffer.from(`ply\nformat binary_little_endian 1.0\nelement vertex ${side * side}\nproperty float x\nproperty float y\nproperty float z\nelement face ${2 * cells * cells}\nproperty list uchar int vertex_indices\nend_header\n`);
  const [points, faces] = [Buffer.alloc(12 * side * side), Buffer.alloc(26 * cells * cells)];
  for (let i = 0; i < side * side; i++) {
    const [x, z] = [(i % side) / cells, Math.floor(i / side) / cells];
    [x, 0.05 * Math.sin(40 * x) * Math.sin(17 * z * z), z].forEach((value, k) => points.writeFloatLE(value, 12 * i + 4 * k));
  }
  for (let i = 0; i < cells * cells; i++) {
    const a = (i % cells) + side * Math.floor(i / cells);
    [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]].forEach((face, half) => {
      const at = 26 * i + 13 * half;
      faces.writeUInt8(3, at);
      face.forEach((corner, k) => faces.writeInt32LE(corner, at + 1 + 4 * k));
    });
  }
  writeFileSync(name, Buffer.concat([head, points, faces]));
  return name;
}

/** Pixels that are nearly of a colour, and where their middle is. */
async function pixelsOf(page, color) {
  const box = await page.locator("main canvas").first().boundingBox();
  const png = (await page.locator("main canvas").first().screenshot()).toString("base64");
  const found = await page.evaluate(async ([data, wanted]) => {
    const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data: pixels } = context.getImageData(0, 0, image.width, image.height);
    let [count, x, y] = [0, 0, 0];
    for (let i = 0; i < pixels.length; i += 4) {
      if (!wanted.every((c, k) => Math.abs(c - pixels[i + k]) < 4)) continue;
      [count, x, y] = [count + 1, x + ((i / 4) % image.width), y + Math.floor(i / 4 / image.width)];
    }
    return { count, x: x / count, y: y / count };
  }, [png, color]);
  return { count: found.count, x: box.x + found.x, y: box.y + found.y };
}

/** How the jobs of a server are, by number. */
async function jobs(url) {
  const states = [];
  for (let j = 0; ; j++) {
    const answer = await fetch(`${url}api/jobs/${j}`);
    if (!answer.ok) return states;
    states.push((await answer.json()).state);
  }
}

/** Waits until the latest job is told to have ended so. */
async function lastJob(url, state) {
  const end = Date.now() + 20_000;
  for (;;) {
    const last = (await jobs(url)).at(-1);
    if (last === state) return;
    check(Date.now() < end, `the latest job is ${last}, not ${state}`);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

/** Levels made, the slider moved to each, what is told and drawn compared with the server's. */
async function levels(page, name) {
  await ready(page);
  await page.waitForFunction(() => window.karui.levels?.length > 1 && window.karui.ready, undefined, WAIT);
  const all = await probe(page, () => window.karui.levels.map((l) => l.triangles));
  for (const level of [0, all.length - 1, 1]) {
    await slide(page, "Level of detail", level);
    await page.waitForFunction((l) => window.karui.ready && window.karui.level === l, level, WAIT);
    equal(await probe(page, () => window.karui.triangles), all[level], `triangles of level ${level}`);
    const share = await drawn(page);
    check(share > 0.02 && share < 0.9, `level ${level} covers ${share} of the picture`);
    if (level > 1) await shot(page, `${name}-coarsest`);
  }
  for (let i = 1; i < all.length; i++) check(all[i] < all[i - 1], `levels get coarser: ${all}`);
}

async function comparing(page) {
  for (const compare of ["side", "wipe"]) {
    await page.evaluate((c) => window.karui.set({ compare: c, level: 2, wire: true }), compare);
    await ready(page);
    await page.waitForTimeout(400);
    await shot(page, `model-${compare}`);
  }
  await page.evaluate(() => window.karui.set({ compare: "off", wire: false, heat: "error" }));
  await ready(page);
  await page.waitForTimeout(400);
  await shot(page, "model-heat");
}

/** The page's answers along a path beside what the library tells of the same path. */
async function followed(page, file, which) {
  await ready(page);
  const [pose, size] = await probe(page, () => {
    const canvas = document.querySelector("main canvas");
    return [window.karui.pose(), [Math.round(canvas.width / 2), canvas.height]];
  });
  const [eye, target] = [pose.slice(0, 3), pose.slice(3)];
  await page.keyboard.press("p");
  await page.waitForFunction(() => JSON.parse(window.karui.live.path()).frames.length > 0, undefined, WAIT);
  await page.keyboard.press("p");
  const { fov } = await probe(page, () => JSON.parse(window.karui.live.path()).frames[0].camera);
  const frames = [1, 0.7, 0.5, 0.4, 0.6].map((near, i) => ({
    camera: { eye: eye.map((x, k) => target[k] + near * (x - target[k]) + (k === 0 ? 0.02 * i * near : 0)), target, fov },
    lights: [{ type: "point", position: eye.map((x, k) => x + (k === 1 ? i : 0)), intensity: 1 }],
  }));
  const found = [];
  for (const frame of frames) found.push(await page.evaluate(async (f) => (await window.karui.live.go(f)).triangles, frame));
  await shot(page, `live-${which}`);
  return { frames, found, size, options: await probe(page, () => window.karui.live.options) };
}

const tests = {
  async model() {
    await withPage([ASSET], "", async (page) => {
      await levels(page, "model");
      await comparing(page);
    });
  },

  async bunny() {
    const bunny = model("scans/bun_zipper.ply.gz");
    if (!bunny) return "no models named";
    const start = performance.now();
    await withPage([bunny], "", async (page) => {
      await page.waitForFunction(() => window.karui?.triangles > 0, undefined, WAIT);
      console.log(`  first picture of 69,451 triangles: ${Math.round(performance.now() - start)} ms from the start of the server`);
      await levels(page, "bunny");
    });
  },

  async helmet() {
    const helmet = model("gltf/FlightHelmet/FlightHelmet.gltf");
    if (!helmet) return "no models named";
    await withPage([helmet], "", (page) => levels(page, "helmet"));
  },

  async phone() {
    await withPage([ASSET], "", async (page) => {
      await levels(page, "phone");
      const wide = await probe(page, () => document.documentElement.scrollWidth);
      check(wide <= PHONE.width, `the page is ${wide} pixels wide`);
    }, PHONE);
  },

  async keyboard() {
    await withPage([ASSET], "", async (page) => {
      await ready(page);
      await page.keyboard.press("w");
      equal(await probe(page, () => window.karui.state.wire), true, "wireframe by W");
      await page.keyboard.press("?");
      await page.getByRole("dialog").waitFor();
      await shot(page, "keys");
      await page.keyboard.press("Escape");
      await page.keyboard.press("Tab");
      check(await probe(page, () => document.activeElement !== document.body), "Tab reaches a control");
    });
  },

  async permalink() {
    // Nonsense in an address does not keep the page from the rest of it.
    const nonsense = "&toString=1&level=x&live=constructor:1,__proto__:2,half-edge.area:,kind:none";
    await withPage([ASSET], `#look=normals&flat=1&wire=1${nonsense}`, async (page) => {
      await ready(page);
      equal(await probe(page, () => [window.karui.state.look, window.karui.state.flat, window.karui.state.wire]), ["normals", true, true], "state from the address");
      equal(await probe(page, () => window.karui.state.level), 0, "level, of which there was none in the address");
      await shot(page, "normals");
      await page.evaluate(() => window.karui.set({ look: "clay" }));
      await page.waitForFunction(() => location.hash.includes("look=clay"), undefined, WAIT);
      await page.evaluate(() => window.karui.set({ tab: "live" }));
      await page.waitForFunction(() => window.karui.ready && window.karui.live?.options.area === 100, undefined, WAIT);
    });
  },

  async heat() {
    await withPage([waves(600)], "", async (page, { url }) => {
      await page.waitForFunction(() => window.karui?.ready && window.karui.level === 0, undefined, WAIT);
      const begin = async (heat) => {
        await page.evaluate((kind) => window.karui.set({ heat: kind }), heat);
        await page.waitForFunction(() => window.karui.waiting?.stage !== "starting" && window.karui.waiting, undefined, WAIT);
      };
      await begin("mesh");
      await shot(page, "heat-waits");
      await page.getByRole("button", { name: "Cancel" }).click();
      equal(await probe(page, () => [window.karui.state.heat, window.karui.waiting]), ["", null], "after Cancel");
      await lastJob(url, "cancelled");
      await begin("hybrid");
      await page.evaluate(() => window.karui.set({ heat: "error" }));
      await page.waitForFunction(() => window.karui.ready && !window.karui.waiting && document.querySelector(".legend")?.innerText.includes("Surface error"), undefined, WAIT);
      equal((await jobs(url)).filter((state) => state === "cancelled").length, 2, "jobs cancelled, the first and what another map took the place of");
      equal(await probe(page, () => document.querySelector(".toasts").innerText), "", "what was broken off is no error");
      const other = await open(`${url}#heat=hybrid`);
      await other.waitForFunction(() => window.karui?.waiting?.stage === "views", undefined, WAIT);
      await other.close();
      await lastJob(url, "cancelled");
    });
  },

  async elsewhere() {
    await withPage([ASSET], "", async (page, { url }) => {
      await page.waitForFunction(() => window.karui?.levels?.length > 3 && window.karui.ready, undefined, WAIT);
      const other = await open(url);
      await other.waitForFunction(() => window.karui?.levels?.length > 3 && window.karui.ready, undefined, WAIT);
      await page.getByLabel("Levels, each half").fill("2");
      await page.getByLabel("Levels, each half").blur();
      await page.keyboard.press("m");
      await other.waitForFunction(() => window.karui.levels.length === 3 && window.karui.ready, undefined, WAIT);
      equal(await probe(other, () => window.karui.levels), await probe(page, () => window.karui.levels), "levels on both pages");
      equal(other.complaints, [], "errors of the other page");
      await other.close();
    });
  },

  async livelink() {
    await withPage([ASSET], "#tab=live", async (page) => {
      await ready(page);
      await page.getByRole("radiogroup", { name: "Hierarchy" }).getByText("Clusters").click();
      await page.waitForFunction(() => window.karui.ready && "threshold" in window.karui.live.options, undefined, WAIT);
      await slide(page, "Error", 300);
      await page.getByLabel("Limit triangles").check();
      await slide(page, "At most", 200);
      await slide(page, "Around", 60);
      await slide(page, "Away", 500);
      await page.getByLabel("Wireframe").check();
      for (const key of ["o", "k"]) await page.keyboard.press(key);
      const other = await byLink(page, "colors:cluster");
      const told = () => [window.karui.live.options, window.karui.live.lamp(), window.karui.state.live];
      equal(await probe(other, told), await probe(page, told), "options, lamp and state");
      const frame = await probe(other, () => ({ camera: { eye: window.karui.state.camera.slice(0, 3), target: window.karui.state.camera.slice(3) }, lights: [] }));
      const [here, there] = await Promise.all([page, other].map((p) => p.evaluate(async (f) => (await window.karui.live.go(f)).triangles, frame)));
      equal(there, here, "triangles from the same eye");
      await page.evaluate(() => (location.hash = "#tab=live&live=half-edge.area:400,lit:0"));
      await page.waitForFunction(() => window.karui.ready && window.karui.live.options.area === 400, undefined, WAIT);
      check(!(await page.getByLabel("Light counts").isChecked()), "controls follow the address");
      await other.close();
    });
  },

  async lamp() {
    await withPage([ASSET], "#tab=live&live=outside:no", async (page) => {
      await ready(page);
      await page.evaluate(() => window.karui.setPose(window.karui.pose().map((x, i, all) => (i < 3 ? all[i + 3] + 2 * (x - all[i + 3]) : x))));
      for (const place of ["around:59,up:17,away:2.5", "around:159,up:0,away:4"]) {
        await page.evaluate((where) => window.karui.set({ live: `outside:no,${where}` }), place);
        await page.waitForTimeout(500);
        const { count } = await pixelsOf(page, [255, 210, 122]);
        check(count > 20, `the lamp at ${place} has ${count} pixels`);
      }
      const { x, y } = await pixelsOf(page, [255, 210, 122]);
      const before = await probe(page, () => window.karui.live.lamp());
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x - 80, y - 40, { steps: 4 });
      await page.mouse.up();
      const after = await probe(page, () => window.karui.live.lamp());
      check(Math.hypot(...after.map((value, k) => value - before[k])) > 0, "the lamp is dragged");
      await page.waitForTimeout(400);
      const moved = await pixelsOf(page, [255, 210, 122]);
      check(Math.hypot(moved.x - x + 80, moved.y - y + 40) < 6, `the lamp follows the hand: ${JSON.stringify([x, y, moved])}`);
      const up = await page.getByRole("slider", { name: "Up" }).evaluate((slider) => Number(slider.value));
      check(Math.abs(up - (await probe(page, () => Number(/up:([-\d.]+)/.exec(window.karui.state.live)?.[1] ?? 45)))) <= 0.5, "the slider follows the hand");
    });
  },

  async full() {
    await withPage([ASSET], "", async (page, { url }) => {
      await page.evaluate(async () => {
        const address = new URL("api/files/0/live?kind=clusters", location.href);
        address.protocol = "ws:";
        address.hash = "";
        window.sockets = Array.from({ length: 16 }, () => new WebSocket(address));
        await Promise.all(window.sockets.map((socket) => new Promise((resolve) => (socket.onmessage = resolve))));
      });
      const other = await open(`${url}#tab=live`);
      await toast(other, "16 pages already");
      await shot(other, "full");
      equal(await other.locator(".toast.error").count(), 1, "messages");
      await page.evaluate(() => window.sockets.forEach((socket) => socket.close()));
      await other.waitForTimeout(500);
      await other.reload();
      await ready(other);
      await other.close();
    });
  },

  async live() {
    await withPage([ASSET], "#tab=live", async (page) => {
      const { frames, found, size, options: kept } = await followed(page, ASSET, "half-edge");
      writeFileSync(path.join(scratch, "path.json"), JSON.stringify({ frames }));
      karui("hierarchy", "refine", ASSET, "-o", "refined", "--alpha", "inf", "--path", "path.json", "--size", size.join("x"), "--area", `${kept.area}`,
        "--flatness", `${kept.flatness}`, "--silhouette", `${kept.silhouette}`, "--light-silhouette", `${kept.light_silhouette}`,
        "--highlight", `${kept.highlight}`, "--highlight-area", `${kept.highlight_area}`);
      const [head, ...rows] = readFileSync(path.join(scratch, "refined/frames.csv"), "utf8").trim().split("\n").map((l) => l.split(","));
      equal(found, rows.map((row) => Number(row[head.indexOf("triangles")])), "triangles along the path, page and library");
    });
  },

  async clusters() {
    await withPage([ASSET], "#tab=live", async (page) => {
      await ready(page);
      await page.getByRole("radiogroup", { name: "Hierarchy" }).getByText("Clusters").click();
      await page.waitForFunction(() => window.karui.ready && "threshold" in window.karui.live.options, undefined, WAIT);
      await page.evaluate(() => window.karui.set({ live: `${window.karui.state.live},colors:cluster` }));
      const colors = async () => new Map((await probe(page, () => window.karui.live.colors())).map(({ id, color }) => [id, String(color)]));
      const first = await colors();
      const { found } = await followed(page, ASSET, "clusters");
      check(found[3] > found[0], `nearer, there is more: ${found}`);
      const last = await colors();
      equal(last.size, await probe(page, () => window.karui.live.numbers.slots), "clusters with a colour");
      check(new Set(last.values()).size > 0.9 * last.size, `${new Set(last.values()).size} colours of ${last.size} clusters`);
      for (const [id, color] of last) check((first.get(id) ?? color) === color, `cluster ${id} keeps its colour`);
      await page.keyboard.press("k");
      await page.waitForFunction(() => document.querySelector(".legend")?.innerText.includes("finest"), undefined, WAIT);
      await shot(page, "live-levels");
    });
  },

  async adaptive() {
    const cube = path.join(scratch, "cube.obj");
    writeFileSync(cube, CUBE);
    await withPage([cube], "#tab=adaptive", async (page) => {
      await ready(page);
      const coarse = await probe(page, () => window.karui.triangles);
      await page.evaluate(() => window.karui.adaptive.set("adaptive", 0.1));
      await page.waitForFunction((n) => window.karui.ready && window.karui.triangles > n, coarse, WAIT);
      await shot(page, "adaptive");
      await page.evaluate(() => window.karui.adaptive.set("catmull-clark", 3));
      await page.waitForFunction(() => window.karui.ready && window.karui.triangles === 6 * 64 * 2, undefined, WAIT);
      await page.getByLabel("Boundary").selectOption("edge");
      await page.getByLabel("Control mesh").uncheck();
      await slide(page, "Away", 700);
      const other = await byLink(page, "cage:0");
      equal(await probe(other, () => window.karui.triangles), 6 * 64 * 2, "triangles by link");
      await other.close();
    });
  },

  async tiles() {
    karui("scene", "city", "--count", "300", "-o", "city.glb");
    karui("tiles", "city.glb", "-o", "city");
    await withPage([path.join(scratch, "city/tileset.json")], "", async (page) => {
      await page.waitForFunction(() => window.karui?.ready && window.karui.tileCounts?.visible > 0, undefined, WAIT);
      const whole = await probe(page, () => window.karui.tileCounts);
      equal([whole.failed, whole.objects], [0, 300], "failed tiles, objects");
      await shot(page, "tiles");
      await page.evaluate(() => (window.karui.tiles.paint("group"), window.karui.tiles.setError(300)));
      await page.waitForFunction((n) => window.karui.ready && window.karui.tileCounts.triangles < n, whole.triangles, WAIT);
      equal(await probe(page, () => window.karui.tileCounts.failed), 0, "failed tiles");
      equal(await page.getByRole("slider", { name: "Error Ω_t" }).getAttribute("aria-valuetext"), "300 px", "the slider");
      await shot(page, "tiles-groups");
      await (await byLink(page, "error:300")).close();
    });
  },

  async drop() {
    await withPage([], "", async (page) => {
      const drop = (name, bytes) => page.evaluate(([n, b]) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([new Uint8Array(b)], n));
        dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
      }, [name, [...bytes]]);
      await toast(page, "Drop a model");
      await drop("broken.glb", Buffer.from("glTF, but not really"));
      await toast(page, "broken.glb");
      await page.locator(".toast.error").waitFor();
      await shot(page, "broken");
      check(!(await page.locator(".toasts").innerText()).includes("panick"), "the message is for people");
      await drop("cube.obj", Buffer.from(CUBE));
      await page.waitForFunction(() => window.karui.triangles === 12, undefined, WAIT);
    });
  },

  async pair() {
    await withPage([ASSET], "#tab=live", async (page, server) => {
      const other = await open(`${server.url}#tab=live`);
      await Promise.all([ready(page), ready(other)]);
      await page.evaluate(() => window.karui.setPose(window.karui.pose().map((x, i) => (i < 3 ? 0.5 * x : x))));
      await page.waitForTimeout(1000);
      const [near, far] = await Promise.all([page, other].map((p) => probe(p, () => window.karui.triangles)));
      check(near !== far, `each page has a cut of its own: ${near}, ${far}`);
      equal(other.complaints, [], "errors of the other page");
      await other.close();
    });
  },

  async killed() {
    await withPage([ASSET], "#tab=live", async (page, server) => {
      await ready(page);
      await server.stop("SIGKILL");
      await page.locator(".toast.error").waitFor(WAIT);
      const text = await page.locator(".toast.error").innerText();
      check(/karui/i.test(text), `the page says what to do: ${text}`);
      await shot(page, "killed");
    });
  },
};

const browser = await launch(options.chromium);
if (options.out) mkdirSync(options.out, { recursive: true });
const unknown = options.tests.filter((name) => !(name in tests));
if (unknown.length > 0) fail(`no such test: ${unknown}; there are ${Object.keys(tests).join(", ")}`);
let failed = 0;
for (const [name, test] of Object.entries(tests)) {
  if (options.tests.length > 0 && !options.tests.includes(name)) continue;
  try {
    const skipped = await test();
    console.log(skipped ? `${name}: SKIPPED, ${skipped}` : `${name}: ok`);
  } catch (error) {
    failed += 1;
    console.log(`${name}: FAILED\n  ${error.message.split("\n").slice(0, 3).join("\n  ")}`);
  }
}
await browser.close();
rmSync(scratch, { recursive: true, force: true });
console.log(failed ? `${failed} tests failed` : "all pages passed");
process.exit(failed ? 1 : 0);

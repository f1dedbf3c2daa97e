// Opens a tileset in two clients, CesiumJS and 3d-tiles-renderer with three.js, in a
// headless Chromium: looks at it from three distances, keeps a picture of each, and
// reports tiles that failed to load or lie outside of their bounding volumes.
//
//   npm install cesium three 3d-tiles-renderer playwright-core    (NODE_PATH or beside)
//   node tools/view_tiles.mjs [--chromium FILE] [--out DIR] TILESET.json...
//
// A line a client and distance. Exit code 1 if a tile failed, 2 on wrong use or where
// something is not installed or does not start, 3 if the machine was too slow to tell.

import { createServer } from "node:http";
import { existsSync, mkdirSync, readFileSync, statSync } from "node:fs";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { fail, folderOf, launch } from "./browser.mjs";

const DISTANCES = [{ name: "near", radii: 0.9 }, { name: "middle", radii: 2.5 }, { name: "far", radii: 12 }];
const CLIENTS = ["cesium", "three"];
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".mjs": "text/javascript", ".css": "text/css",
  ".json": "application/json", ".glb": "model/gltf-binary", ".gltf": "model/gltf+json", ".wasm": "application/wasm",
  ".png": "image/png", ".jpg": "image/jpeg" };

function parseArguments(args) {
  const options = { chromium: null, out: null, tilesets: [] };
  for (let i = 0; i < args.length; i++) {
    if (args[i] === "--chromium") options.chromium = args[++i];
    else if (args[i] === "--out") options.out = args[++i];
    else options.tilesets.push(args[i]);
  }
  if (options.tilesets.length === 0) fail("usage: view_tiles.mjs [--chromium FILE] [--out DIR] TILESET.json...");
  return options;
}

/** Serves pages, packages and the folder of a tileset on this machine only. */
function serve(folder) {
  const pages = path.join(path.dirname(fileURLToPath(import.meta.url)), "view_tiles");
  const roots = { pages, tiles: folder };
  const server = createServer((request, response) => {
    const url = decodeURIComponent(new URL(request.url, "http://localhost").pathname);
    const [, first, ...rest] = url.split("/");
    const [name, ...inside] = rest;
    const file = first === "node_modules" ? path.join(folderOf(name), ...inside) : path.join(roots[first] ?? "/-", ...rest);
    if (!existsSync(file) || !statSync(file).isFile()) return response.writeHead(404).end();
    response.writeHead(200, { "content-type": TYPES[path.extname(file)] ?? "application/octet-stream" });
    response.end(readFileSync(file));
  });
  return new Promise((resolve) => server.listen(0, "127.0.0.1", () => resolve(server)));
}

async function view(browser, server, client, tileset, out) {
  const page = await browser.newPage({ viewport: { width: 800, height: 600 } });
  const complaints = [];
  page.on("pageerror", (error) => complaints.push(`${error}`));
  page.on("console", (message) => {
    const text = message.text();
    const known = /GPU stall|GL Driver Message|favicon|software WebGL|WebGL-|limited support/.test(text + message.location().url);
    if (["error", "warning"].includes(message.type()) && !known) complaints.push(text);
  });
  const name = path.basename(tileset);
  await page.goto(`http://127.0.0.1:${server.address().port}/pages/${client}.html?tileset=${encodeURIComponent(name)}`);
  await page.waitForFunction(() => window.ready, undefined, { timeout: 60_000 });
  let good = true;
  for (const { name: distance, radii } of DISTANCES) {
    const seen = await page.evaluate((r) => window.look(r), radii);
    const problems = [...seen.failed, ...complaints.splice(0)];
    if (!seen.done && problems.length === 0) late = true;
    if (seen.done && !(seen.visible > 0)) problems.push("nothing to be seen");
    good &&= problems.length === 0;
    const center = (seen.center ?? []).map((x) => x.toFixed(2)).join(", ");
    console.log(`${client} ${distance}: ${seen.visible} tiles, ${seen.triangles} triangles, sphere (${center}) ${seen.radius?.toFixed(2)}`);
    if (!seen.done) console.log("  not all was loaded in time");
    for (const problem of problems.slice(0, 10)) console.log(`  problem: ${problem}`);
    if (out) await page.screenshot({ path: path.join(out, `${client}-${distance}.png`) });
  }
  await page.close();
  return good;
}

const options = parseArguments(process.argv.slice(2));
const browser = await launch(options.chromium);
let good = true;
let late = false;
for (const tileset of options.tilesets) {
  if (!existsSync(tileset)) fail(`${tileset}: no such file`);
  const server = await serve(path.dirname(path.resolve(tileset)));
  const out = options.out && path.join(options.out, options.tilesets.length > 1 ? path.basename(path.dirname(path.resolve(tileset))) : "");
  if (out) mkdirSync(out, { recursive: true });
  for (const client of CLIENTS) good = (await view(browser, server, client, tileset, out)) && good;
  server.close();
}
await browser.close();
if (!good) console.log("some tiles failed");
else console.log(late ? "too slow to tell" : "all tiles loaded in both clients");
process.exit(good ? (late ? 3 : 0) : 1);

// Starts a headless Chromium for the scripts beside.

import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

/** Ends with 2: wrong use, or something is not installed or does not start. */
export function fail(message) {
  console.error(message);
  process.exit(2);
}

/** The folder of an installed package, from NODE_PATH, the scripts or the working directory. */
export function folderOf(name) {
  const require = createRequire(import.meta.url);
  const roots = [...(process.env.NODE_PATH ?? "").split(path.delimiter), ...require.resolve.paths(name),
    path.join(process.cwd(), "node_modules")];
  const found = roots.filter(Boolean).map((root) => path.join(root, name)).find(existsSync);
  return found ?? fail(`${name} is not installed; run: npm install ${name}`);
}

function findChromium(given) {
  const places = [given, process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
  return places.filter(Boolean).find(existsSync) ?? fail("no Chromium here; name one with --chromium FILE");
}

/** Chromium that draws without a GPU. */
export function launch(given) {
  const { chromium } = createRequire(import.meta.url)(folderOf("playwright-core"));
  return chromium.launch({
    executablePath: findChromium(given),
    args: ["--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  }).catch((error) => fail(`Chromium does not start: ${error}`));
}

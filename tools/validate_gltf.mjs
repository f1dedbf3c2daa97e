// Runs the Khronos glTF validator over files and reports errors and warnings.
//
//   npm install gltf-validator        (once, anywhere above the files or in NODE_PATH)
//   node tools/validate_gltf.mjs [--warnings] [--ignore CODE,CODE] FILE...
//
// A line for every file with errors (or warnings, with --warnings), then a
// summary. Exit code 1 if any file has an error, 2 on wrong use.

import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

/** The validator, from beside this script, the working directory or NODE_PATH. */
function loadValidator() {
  for (const from of [import.meta.url, path.join(process.cwd(), "x.js")]) {
    try {
      return createRequire(from)("gltf-validator");
    } catch (error) {
      if (error.code !== "MODULE_NOT_FOUND") throw error;
    }
  }
  console.error("gltf-validator is not installed; run: npm install gltf-validator");
  process.exit(2);
}

function parseArguments(args) {
  const options = { warnings: false, ignore: [], files: [] };
  for (let i = 0; i < args.length; i++) {
    if (args[i] === "--warnings") options.warnings = true;
    else if (args[i] === "--ignore") options.ignore = args[++i].split(",");
    else options.files.push(args[i]);
  }
  if (options.files.length === 0) {
    console.error("usage: validate_gltf.mjs [--warnings] [--ignore CODE,CODE] FILE...");
    process.exit(2);
  }
  return options;
}

/** Files a model refers to, read from beside it. */
function companions(file) {
  return (uri) =>
    new Promise((resolve, reject) => {
      try {
        const name = path.resolve(path.dirname(file), decodeURIComponent(uri));
        resolve(new Uint8Array(readFileSync(name)));
      } catch (error) {
        reject(error.toString());
      }
    });
}

const SEVERITY = ["error", "warning", "information", "hint"];

async function validate(validator, file, options) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: 0,
    ignoredIssues: options.ignore,
    externalResourceFunction: companions(file),
  });
  const { numErrors, numWarnings, messages } = report.issues;
  const shown = messages.filter((m) => m.severity === 0 || (options.warnings && m.severity === 1));
  if (shown.length > 0) {
    console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings`);
    const seen = new Map();
    for (const m of shown) seen.set(m.code, [...(seen.get(m.code) ?? []), m]);
    for (const [code, all] of seen) {
      const { severity, pointer, message } = all[0];
      console.log(`  ${SEVERITY[severity]} ${code} x${all.length}: ${pointer ?? ""} ${message}`);
    }
  }
  return [numErrors, numWarnings];
}

const options = parseArguments(process.argv.slice(2));
const validator = loadValidator();
let bad = 0;
let warned = 0;
for (const file of options.files) {
  const [errors, warnings] = await validate(validator, file, options).catch((error) => {
    console.log(`${file}: cannot be validated: ${error}`);
    return [1, 0];
  });
  if (errors > 0) bad++;
  if (warnings > 0) warned++;
}
console.log(`${options.files.length} files, ${bad} with errors, ${warned} with warnings`);
process.exit(bad > 0 ? 1 : 0);

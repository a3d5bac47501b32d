// Prints the report of Khronos' glTF validator for each file named, as one JSON list.
// Needs the npm package gltf-validator, found from the folder in which node runs.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";

const validator = createRequire(join(process.cwd(), "package.json"))("gltf-validator");
const reports = [];
for (const path of process.argv.slice(2)) {
  reports.push((await validator.validateBytes(new Uint8Array(readFileSync(path)))).issues);
}
console.log(JSON.stringify(reports));

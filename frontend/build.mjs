// Builds the page of a forecast and that of annotations into src/motioncast/view; the same sources give the same bytes.
import { readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = new URL("./", import.meta.url);
const out = new URL("../src/motioncast/view/", here);
const licence = await readFile(new URL("node_modules/three/LICENSE", here), "utf8");

const banner = `/* This bundle contains three.js.\n\n${licence.replaceAll("\r\n", "\n").trim()}\n*/`;

for (const [entry, name] of [
  ["src/main.ts", "page.js"], ["page.css", "page.css"],
  ["src/annotate/main.ts", "annotate.js"], ["annotate.css", "annotate.css"],
]) {
  const result = await build({
    absWorkingDir: fileURLToPath(here),
    entryPoints: [entry],
    banner: entry.endsWith(".ts") ? { js: banner } : {},
    bundle: true,
    charset: "ascii",
    format: "iife",
    legalComments: "inline",
    minify: true,
    target: "es2022",
    write: false,
  });
  await writeFile(new URL(name, out), result.outputFiles[0].contents);
  console.log(`${name}: ${(result.outputFiles[0].contents.length / 1000).toFixed(0)} kB`);
}
for (const name of ["page.html", "annotate.html"]) {
  await writeFile(new URL(name, out), await readFile(new URL(name, here), "utf8"));
}

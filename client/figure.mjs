// A page like Figures 5 and 6 of the paper: one mesh, flattened by every method that the server
// knows and by Hybrid with several lambdas, each map with [D_angle, D_area] in brackets.
//
//   node figure.mjs SERVER UNWRAP MESH OUT.html [UP]
//
// Charts are drawn at one scale and turned to ARAP's, on which what is up on the mesh is up; several lie
// beside each other, each at one place in every map. A map with other charts than ARAP's lies as it was
// packed. +Y is up, as in glTF; an OBJ says nothing of it
// and may have another axis for UP: x, -x, -y, z or -z.
//
// The page is one file without scripts: pictures are part of it, nothing is fetched.
import { execFile } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { fileURLToPath } from "node:url";
import { promisify } from "node:util";

import { alignedPlaces, cellsOf, chartsOf, cornersOf, raised } from "./align.mjs";

/** Weights of Eq. (5) from almost conformal to almost rigid, for a mesh of area 1. In other units
 * they grow with the area, as the first term of Eq. (5) does: see inUnitsOf(). */
const LAMBDAS = [1e-4, 1e-3, 1e-2, 0.1];

/** The other methods, in the order and with the names of Table 1; then later ones. */
const OTHERS = {
  abf: "ABF++",
  linabf: "LABF",
  ic: "IC",
  cp: "CP",
  bff: "BFF",
  slim: "SLIM",
};

/** The maps of the page as {title, options}, in two rows: the paper's own and the others. */
export function plan(methods, optionNames) {
  const has = (name) => methods.includes(name);
  const raw = { ...(optionNames.includes("preset") && { preset: "chart" }),
    ...(optionNames.includes("guarantee") && { guarantee: "none" }) };
  const map = (title, options) => ({ title, options: { ...options, ...raw } });
  const hybrids = LAMBDAS.map((lambda) =>
    map(`λ = ${lambda}`, { method: "hybrid", lambda, "lambda-units": "paper" }));
  return [
    [...(has("asap") ? [map("ASAP (λ = 0)", { method: "asap" })] : []),
     ...(has("hybrid") ? hybrids : []),
     ...(has("arap") ? [map("ARAP (λ = ∞)", { method: "arap" })] : [])],
    Object.keys(OTHERS).filter(has).map((name) => map(OTHERS[name], { method: name })),
  ];
}

/** The area of the surface that a report tells of. */
export function areaOf(report) {
  return report.charts.reduce((sum, chart) => sum + chart.area, 0);
}

/** The options with lambda in the units of a mesh of this area. */
export function inUnitsOf(area, options) {
  if (options.lambda === undefined) return options;
  if (!(area > 0)) throw new Error("the mesh's area is not known: there is no conformal map of it");
  return { ...options, lambda: String(options.lambda * area) };
}

/** D as the paper prints it; a map so distorted that digits mean nothing is given as a power. */
export function figure(value) {
  if (!Number.isFinite(value)) return "∞";
  return value < 1e4 ? value.toFixed(2) : value.toExponential(0).replace("e+", "e");
}

const escapeText = (text) =>
  text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");

/** "[2.05, 2.19]", and the flips where there are any. */
export function caption({ angle, area, flipped }) {
  const flips = flipped > 0 ? ` · ${flipped} flipped` : "";
  return `[${figure(angle)}, ${figure(area)}]${flips}`;
}

const picture = (kind, png, alt) =>
  `<img class="${kind}" alt="${escapeText(alt)}" src="data:image/png;base64,${png}">`;

function card(map) {
  const title = escapeText(map.title);
  if (map.problem) {
    return `<figure><div class="problem">${escapeText(map.problem)}</div>` +
      `<figcaption><b>${title}</b></figcaption></figure>`;
  }
  return `<figure>${picture("preview", map.preview, `${map.title} on the mesh`)}` +
    (map.drawing ?? inlined(map.layout, "layout", `${map.title}, the page`, [0, 0, PAGE, PAGE])) +
    `<figcaption><b>${title}</b><br>${caption(map.report.distortion)}</figcaption></figure>`;
}

const STYLE = `
  body { font: 16px/1.4 system-ui, sans-serif; color: #16131f; margin: 2rem auto; max-width: 100rem;
         padding: 0 1.5rem; }
  h1 { font-size: 1.6rem; margin: 0; } p { max-width: 62rem; color: #4a4658; }
  section { display: grid; grid-template-columns: repeat(auto-fill, minmax(13.5rem, 1fr)); gap: 1.5rem;
            margin: 1.5rem 0 2rem; }
  figure { margin: 0; } img, svg { display: block; width: 100%; object-fit: cover; }
  .preview, .layout { aspect-ratio: 1; } .bar { aspect-ratio: 4096 / 320; max-width: 60rem; }
  figcaption { text-align: center; padding-top: .4rem; font-variant-numeric: tabular-nums; }
  .problem { aspect-ratio: 1 / 2; display: grid; place-content: center; padding: 1rem;
             text-align: center; background: #e9e8ed; box-sizing: border-box; }
  @media print { body { margin: 0; } section { break-inside: avoid; } }`;

const LAYOUT_UNITS = 40_960; // coordinates of the layout's paths along a page
const PAGE = 4096; // the page's side in the layout; its legend is below

/** The layout (SVG) as a part of the page, as much of it as the box {x, y, width, height} shows. */
function inlined(layout, kind, label, box, content = layout.replace(/^.*?<svg [^>]*>|<\/svg>\s*$/gs, "")) {
  return `<svg class="${kind}" role="img" aria-label="${escapeText(label)}" viewBox="${box.join(" ")}">${content}</svg>`;
}

const CELLS = [64, 1024, 16_384]; // units of the layout
const AROUND = [-1, 0, 1].flatMap((x) => [-1, 0, 1].map((y) => [x, y])).sort((a, b) => Math.hypot(...a) - Math.hypot(...b));

/** A function from a point of the layout to the chart whose corner is the nearest within a cell; else undefined. */
function nearCorner({ corners, charts }, cell) {
  const cells = new Map();
  const cellOf = (x, y) => `${Math.round(x / cell)} ${Math.round(y / cell)}`;
  corners.forEach(({ uv }, k) => {
    const [x, y] = uv.map((c) => c * LAYOUT_UNITS);
    const name = cellOf(x, y);
    if (!cells.has(name)) cells.set(name, []);
    cells.get(name).push([x, y, charts[Math.floor(k / 3)]]);
  });
  return (x, y) => {
    const close = AROUND.flatMap(([a, b]) => cells.get(cellOf(x + cell * a, y + cell * b)) ?? []);
    const nearest = close.reduce((best, point) => {
      const distance = Math.hypot(point[0] - x, point[1] - y);
      return distance < best.distance ? { distance, chart: point[2] } : best;
    }, { distance: cell });
    return nearest.chart;
  };
}

/** The chart at a point of the layout. Triangles begin at corners; where two of a chart overlap, corners may be far. */
export function chartFinder(map) {
  const finders = CELLS.map((cell) => nearCorner(map, cell));
  return (x, y) => finders.reduce((chart, find) => chart ?? find(x, y), undefined) ?? map.charts[0];
}

/** The paths of a layout, those of each chart in an SVG of its own. */
function pathsByChart(map) {
  const paths = map.layout.match(/<defs>.*?<\/defs>|<path [^>]*?(?:\/>|>.*?<\/path>)/gs) ?? [];
  const names = [...new Set(map.charts)];
  if (names.length === 1) return [paths.join("")];
  const chartAt = chartFinder(map);
  const parts = new Map(names.map((name) => [name, []]));
  for (const path of paths) {
    const [, head, data, tail] = path.match(/^(<path .*?d=")([^"]*)(".*)$/s) ?? [];
    const pieces = new Map();
    for (const piece of data?.match(/M[^M]*/g) ?? []) {
      const chart = chartAt(...piece.match(/-?\d+/g).slice(0, 2).map(Number));
      pieces.set(chart, (pieces.get(chart) ?? "") + piece);
    }
    for (const [chart, own] of pieces) parts.get(chart).push(head + own + tail);
  }
  const defs = paths.filter((path) => path.startsWith("<defs>"));
  return names.map((name) => [...defs, ...parts.get(name)].join(""));
}

/** A map whose charts have these places around these middles, V pointing up. */
function drawing(map, places, { middles, side }) {
  const parts = pathsByChart(map).map((paths, k) => {
    const { turn, scale, middle } = places[k];
    const degrees = (-turn * 180) / Math.PI; // V points down in an SVG
    const [x, y] = middles[k];
    const move = middles.length > 1 ? `translate(${x} ${-y}) ` : "";
    return `<g transform="${move}rotate(${degrees}) scale(${scale} ${-scale}) translate(${-middle[0]} ${-middle[1]}) scale(${1 / LAYOUT_UNITS})">${paths}</g>`;
  });
  const box = [-side / 2, -side / 2, side, side].map((x) => 1.04 * x);
  return inlined(map.layout, "layout", `${map.title}, flat`, box, parts.join(""));
}

/** Draws maps with the same charts as ARAP's, or as the first map's, each chart turned to its like and at one place in all. */
export function align(maps) {
  const made = maps.filter((map) => map.corners?.length > 0);
  if (made.length === 0) return;
  const first = made.find((map) => map.title.startsWith("ARAP")) ?? made[0];
  const alike = made.filter(({ charts }) => charts.length === first.charts.length && charts.every((chart, t) => chart === first.charts[t]));
  const cells = [...new Set(first.charts)].map((chart) =>
    alignedPlaces(alike.map(({ corners, charts }) => corners.filter((_, k) => charts[Math.floor(k / 3)] === chart)), alike.indexOf(first)));
  const shared = cells.length > 1 ? cellsOf(cells.map(({ side }) => 1.04 * side)) : { middles: [[0, 0]], side: cells[0].side };
  alike.forEach((map, m) => (map.drawing = drawing(map, cells.map(({ places }) => places[m]), shared)));
}

/** The page, whole. rows: maps as plan() gives them, each with report, layout and preview or with
 * problem. */
export function page(name, rows) {
  const done = rows.flat().find((map) => map.layout);
  const faces = done ? `, ${done.report.input.faces} triangles` : "";
  const bar = done ? inlined(done.layout, "bar", "the colours", [0, PAGE, PAGE, 320]) : "";
  const sections = rows.filter((row) => row.length > 0)
    .map((row) => `<section>\n${row.map(card).join("\n")}\n</section>`).join("\n");
  return `<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>${escapeText(name)}: maps</title>
<meta name="viewport" content="width=device-width"><style>${STYLE}
</style></head><body>
<h1>${escapeText(name)}${faces}</h1>
<p>Effect of λ in the hybrid energy (5), the mesh scaled to area 1, compared with other methods. Numbers in brackets: angular
and area distortion, [D<sub>angle</sub>, D<sub>area</sub>]; both are at best 2. Each map is shown as
a checkerboard on the mesh and flat, coloured by stretch. Charts have one scale, and each has one place
and direction in all maps that have it.</p>
${sections}
${bar}
</body></html>
`;
}

const run = promisify(execFile);

/** One job by the client, with its pictures as base64; a refusal becomes the map's problem. */
async function solve({ title, options }, { unwrap, server, mesh, folder, area }) {
  const at = (file) => join(folder, file);
  try {
    const given = Object.entries(inUnitsOf(area, options));
    const flags = given.flatMap(([name, value]) => [`--${name}`, value]);
    await run(unwrap, [mesh, "--server", server, "--quiet", "-o", at("result.obj"), "--output", "obj", "--report",
      at("report.json"), "--layout", at("layout.svg"), "--preview", at("preview.png"), ...flags]);
  } catch (error) {
    return { title, problem: (error.stderr || error.message).trim() };
  }
  const text = (file) => readFileSync(at(file), "utf8");
  return { title, report: JSON.parse(text("report.json")), corners: cornersOf(text("result.obj")),
           charts: chartsOf(text("result.obj")),
           layout: text("layout.svg"), preview: readFileSync(at("preview.png")).toString("base64") };
}

async function knownTo(server) {
  const answer = await fetch(`${server}/v1/methods`);
  if (!answer.ok) throw new Error(`${server} does not tell its methods: ${answer.status}`);
  const { methods, options } = await answer.json();
  const names = (list) => (Array.isArray(list) ? list.map((x) => x.name ?? x) : Object.keys(list));
  return { methods: names(methods), options: names(options) };
}

/** The mesh's file, turned upright. */
function upright(mesh, up, folder) {
  if (up === undefined || up === "y") return mesh;
  if (!/\.obj$/i.test(mesh)) throw new Error("UP is for an OBJ; a glTF has +Y up, and other formats are turned by their programs");
  const path = join(folder, basename(mesh));
  writeFileSync(path, raised(readFileSync(mesh, "utf8"), up));
  return path;
}

async function main([server, unwrap, given, out, up]) {
  const known = await knownTo(server);
  const folder = mkdtempSync(join(tmpdir(), "figure-"));
  try {
    const mesh = upright(given, up, folder);
    const rows = [];
    let area;
    for (const row of plan(known.methods, known.options)) {
      rows.push([]);
      for (const map of row) {
        const solved = await solve(map, { unwrap, server, mesh, folder, area });
        rows.at(-1).push(solved);
        if (solved.report) area ??= areaOf(solved.report);
        console.log(`   ${map.title}: ${solved.problem ?? caption(solved.report.distortion)}`);
      }
    }
    align(rows.flat());
    writeFileSync(out, page(basename(mesh), rows));
    if (!rows.flat().some((map) => map.layout)) throw new Error("no map could be made");
  } finally {
    rmSync(folder, { recursive: true });
  }
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const words = process.argv.slice(2);
  if (words.length !== 4 && words.length !== 5) {
    console.error("usage: node figure.mjs SERVER UNWRAP MESH OUT.html [UP]");
    process.exit(2);
  }
  await main(words);
}

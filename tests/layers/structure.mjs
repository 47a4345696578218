// The structure of the tree in figures, of any revision: node structure.mjs [--at REVISION] [...more]
// Several revisions are columns of one table; HEAD without any. Sources of the programs alone count
// (core, api, server, client), no tests. A room is a folder with sources.
import { spawnSync } from "node:child_process";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

import { typesOf } from "./check_layers.mjs";

const SOURCE = /^(core|api|server|client)\/.*\.(cpp|hpp)$/;
const SHORT = 30;

function git(flags, input = "") {
  const { status, stdout, stderr } = spawnSync("git", flags, {
    cwd: join(dirname(fileURLToPath(import.meta.url)), "../.."),
    maxBuffer: 1 << 28,
    input,
  });
  if (status !== 0) throw new Error(`git ${flags.join(" ")}: ${stderr}`);
  return stdout;
}

/** The sources of a revision: [{path, text}]. */
function sourcesAt(revision) {
  const paths = git(["ls-tree", "-r", "--name-only", revision]).toString().split("\n").filter((path) => SOURCE.test(path));
  const texts = git(["cat-file", "--batch"], paths.map((path) => `${revision}:${path}\n`).join(""));
  let at = 0;
  return paths.map((path) => {  // each: "<object> blob <bytes>\n<text>\n"
    const end = texts.indexOf("\n", at);
    const bytes = Number(texts.toString("utf8", at, end).split(" ")[2]);
    at = end + 1 + bytes + 1;
    return { path, text: texts.toString("utf8", end + 1, end + 1 + bytes) };
  });
}

/** Room -> the rooms that its files include, with the number of such lines. */
export function roomGraph(sources) {
  const rooms = new Map(sources.map(({ path }) => [dirname(path), new Map()]));
  for (const { path, text } of sources) {
    const included = rooms.get(dirname(path));
    for (const [, header] of text.matchAll(/^\s*#\s*include\s+"([^"]+)"/gm)) {
      const other = dirname(header);
      if (other !== dirname(path) && rooms.has(other)) included.set(other, (included.get(other) ?? 0) + 1);
    }
  }
  return rooms;
}

/** Every room -> the rooms that it reaches by includes of includes. */
function reach(graph) {
  const reached = new Map();
  for (const room of graph.keys()) {
    const seen = new Set();
    const left = [...graph.get(room).keys()];
    while (left.length > 0) {
      const next = left.pop();
      if (seen.has(next)) continue;
      seen.add(next);
      left.push(...graph.get(next).keys());
    }
    reached.set(room, seen);
  }
  return reached;
}

/**
 * Circles: sets of rooms each of which includes each other, directly or through others. Up: lines that
 * include a header of another room of the same circle; without a circle all includes go one way.
 */
export function circlesOf(graph) {
  const reached = reach(graph);
  const together = (a, b) => reached.get(a).has(b) && reached.get(b).has(a);
  const circles = new Set();
  let up = 0;
  for (const [room, included] of graph) {
    const circle = [...graph.keys()].filter((other) => other === room || together(room, other)).sort();
    if (circle.length > 1) circles.add(circle.join(", "));
    for (const [other, lines] of included) if (together(room, other)) up += lines;
  }
  return { circles: [...circles], up };
}

/** [name, figure] of the sources. */
export function structure(sources) {
  const files = sources
    .map(({ path, text }) => ({ path, lines: text.split("\n").length - (text.endsWith("\n") ? 1 : 0) }))
    .sort((a, b) => a.lines - b.lines);
  const graph = roomGraph(sources);
  const { circles, up } = circlesOf(graph);
  const sizes = [...graph.keys()].map((room) => files.filter(({ path }) => dirname(path) === room).length);
  const headers = sources.filter(({ path }) => path.endsWith(".hpp"));
  return [
    ["rooms (folders with sources)", graph.size],
    ["files in the largest room", Math.max(...sizes)],
    ["files", files.length],
    ["lines", files.reduce((sum, { lines }) => sum + lines, 0)],
    ["types in headers", headers.reduce((sum, { text }) => sum + typesOf(text).length, 0)],
    ["median file, lines", files[Math.floor(files.length / 2)].lines],
    ["longest file, lines", files.at(-1).lines],
    [`files under ${SHORT} lines`, files.filter(({ lines }) => lines < SHORT).length],
    ["circles of rooms", circles.length],
    ["rooms in circles", circles.reduce((sum, circle) => sum + circle.split(", ").length, 0)],
    ["includes that go up (within a circle)", up],
  ];
}

function main(flags) {
  const revisions = flags.filter((flag) => flag !== "--at");
  if (revisions.length === 0) revisions.push("HEAD");
  const columns = revisions.map((revision) => structure(sourcesAt(revision)));
  console.log(`| | ${revisions.map((revision) => `\`${revision}\``).join(" | ")} |`);
  console.log(`|---|${"---|".repeat(revisions.length)}`);
  columns[0].forEach(([name], row) =>
    console.log(`| ${name} | ${columns.map((column) => column[row][1]).join(" | ")} |`));
}

if (process.argv[1] === fileURLToPath(import.meta.url)) main(process.argv.slice(2));

// The rooms of the source tree: what each is for, and whose headers it may include beside its own.
// A room includes only rooms that stand before it here, so that no two include each other.
// `node rooms.mjs` prints the table of docs/architecture.md.
import { fileURLToPath } from "node:url";

const TERMS = ["core/base", "core/mesh", "core/types"];
const SOLVING = [...TERMS, "core/linear", "core/measure", "core/solve/base"];
const ASSET = [...TERMS, "core/asset/base"];
const DOCUMENT = [...ASSET, "core/asset/gltf"];
const SERVER = ["core/base", "api", "server/base"];
const STORED = [...SERVER, "server/blobs", "server/store"];

/** Folder, duty, the rooms that it may include. */
export const ROOMS = [
  ["core/base", "errors, cancelling, executors, the cache that jobs share", []],
  ["core/json", "reads JSON from outside, strictly and within bounds", ["core/base"]],
  ["core/mesh", "triangles, half-edges, topology, welding, repair", ["core/base"]],
  ["core/types", "plain types: options, progress, report, cache keys", ["core/base", "core/mesh"]],
  ["core/linear", "sparse systems, factored once, solved often", TERMS],
  ["core/measure", "singular values, energies, distortion, exact orientation, overlaps, seams", TERMS],
  ["core/solve/base", "a disk, its rest triangles, constraints, a solution", [...TERMS, "core/linear", "core/measure"]],
  ["core/solve/maps", "initial maps: convex, conformal, or triangle by triangle", SOLVING],
  ["core/solve/methods", "ABF, LinABF, BFF, CP, IC, SLIM", [...SOLVING, "core/solve/maps"]],
  ["core/solve/arap", "local and global steps, their acceleration, initial rotations", SOLVING],
  ["core/solve/repair", "removes flipped triangles and overlaps", [...SOLVING, "core/solve/maps", "core/solve/methods", "core/solve/arap"]],
  ["core/solve", "one chart by one method", [...SOLVING, "core/solve/maps", "core/solve/methods", "core/solve/arap"]],
  ["core/charts", "surfaces cut into disks; constraints and seams of the caller", [...TERMS, "core/measure", "core/solve/base"]],
  ["core/guarantee", "keeps maps free of flips and overlaps, in the rounded numbers that are written", [...SOLVING, "core/charts", "core/solve/methods", "core/solve/repair"]],
  ["core/pack", "packs islands onto pages", [...TERMS, "core/charts", "core/solve/base"]],
  ["core/segment/base", "regions and their trial maps; joins neighbours while the distortion allows it", [...SOLVING, "core/charts", "core/pack", "core/solve/arap"]],
  ["core/segment/search", "searches for few regions with short seams: joins, destroys, joins again, shortens, bisects", [...TERMS, "core/linear", "core/pack", "core/solve/base", "core/segment/base"]],
  ["core/segment", "splits a surface into regions that become charts: whole, large and symmetric surfaces", [...SOLVING, "core/charts", "core/guarantee", "core/solve", "core/segment/base", "core/segment/search"]],
  ["core/pipeline", "the steps of unwrapping", [...SOLVING, "core/charts", "core/guarantee", "core/pack", "core/segment", "core/solve"]],
  ["core", "the front door: unwrap(), the list of its steps", [...TERMS, "core/charts", "core/guarantee", "core/pipeline", "core/segment", "core/solve"]],
  ["core/figure", "layouts and previews as SVG and pixels", [...TERMS, "core/measure"]],
  ["core/texture", "reads and writes images, paints textures for a new layout; a separate library", ["core/base", "core/mesh"]],
  ["core/asset/base", "what all formats are read with: input and limits, bytes, base64, words", ["core/base", "core/mesh"]],
  ["core/asset/gltf", "a glTF document as a checked model: JSON, accessors, materials, images", [...ASSET, "core/json", "core/texture"]],
  ["core/asset/codec", "Draco and meshopt: compresses a document, and undoes it", DOCUMENT],
  ["core/asset/reader", "the steps of reading a glTF", [...DOCUMENT, "core/asset/codec"]],
  ["core/asset/writer", "writes texture coordinates, tangents and textures into a copy of a glTF", [...DOCUMENT, "core/asset/codec"]],
  ["core/asset/obj", "reads and writes OBJ and its materials", DOCUMENT],
  ["core/asset/mesh_files", "reads STL, PLY and OFF", [...ASSET, "core/asset/obj"]],
  ["core/asset/convert", "writes one format as another", [...DOCUMENT, "core/asset/writer", "core/asset/obj", "core/asset/mesh_files"]],
  ["core/asset", "the door to files: recognises, reads and writes assets; a separate library", [...DOCUMENT, "core/asset/codec", "core/asset/reader", "core/asset/writer", "core/asset/obj", "core/asset/mesh_files", "core/asset/convert"]],
  ["api/contract", "`openapi.yaml` as JSON", []],
  ["api", "the contract; the tables of options and of errors", [...TERMS, "core/json"]],
  ["client/web", "the pages at `/` and `/docs`, embedded in the program", []],
  ["client/js", "the npm package", []],
  ["client/python", "the Python package", []],
  ["server/base", "files, clocks, log, metrics, waiting", ["core/base", "api"]],
  ["server/http", "the edge: connections, TLS, limits, framing, routing", ["core/base", "api", "server/base"]],
  ["server/outbound", "calls to addresses that clients chose: checked, and made by libcurl", ["core/base", "server/base"]],
  ["server/bucket", "objects in a bucket that speaks the API of Amazon S3", ["core/base", "server/base", "server/outbound"]],
  ["server/database", "SQL on SQLite or PostgreSQL, and the tables of the store", ["core/base", "api", "server/base"]],
  ["server/blobs", "the files of jobs, on disk, shared or in a bucket, and the room that they take", ["core/base", "api", "server/base", "server/bucket"]],
  ["server/store", "jobs and meshes: their rows with their files, quotas, sweeping", ["core/asset", "core/asset/base", ...STORED, "server/database"]],
  ["server/work", "one job from input bytes to output bytes, in its own process", [...TERMS, ...STORED, "core", "core/asset", "core/figure", "core/pipeline"]],
  ["server/jobs", "the queue, fair turns, workers, events", [...STORED, "server/http", "server/work"]],
  ["server/access", "API keys, signed links, upload tickets", [...SERVER, "server/database", "core/figure", "server/http", "server/jobs"]],
  ["server/webhooks", "signed calls when a job ends", [...SERVER, "server/database", "server/http", "server/outbound"]],
  ["server/sources", "meshes read from addresses that jobs name", ["core/base", "api", "server/base", "server/http", "server/outbound"]],
  ["server/backup", "backup, restore and check of a data directory", [...STORED, "server/database", "server/access"]],
  ["server/results", "results and pictures, made on request", [...STORED, "core/asset", "server/http", "server/work", "server/jobs"]],
  ["server/config", "options, variables and the configuration file", [...SERVER, "server/database", "server/blobs", "server/bucket", "server/http", "server/work", "server/access", "server/outbound", "server/webhooks", "server/sources", "server/results"]],
  ["server/uploads", "meshes and jobs as they arrive", [...STORED, "server/http", "server/jobs", "server/outbound", "server/webhooks", "server/sources", "server/results"]],
  ["server/routes", "the handlers of all paths", [...STORED, "client/web", "server/http", "server/work", "server/jobs", "server/access", "server/results", "server/uploads"]],
  ["server", "the program `unwrapd`", [...STORED, "server/database", "server/bucket", "server/http", "server/work", "server/jobs", "server/access", "server/webhooks", "server/sources", "server/backup", "server/config", "server/routes"]],
  ["client", "the program `unwrap`: uploads, follows, downloads", ["core/base", "api", "server"]],
].map(([folder, duty, includes]) => ({ folder, duty, includes: [...new Set(includes)].filter((room) => room !== folder) }));

/** Folders of the page: each imports from itself and from those before it. */
export const PAGE = "client/web/src/";
export const PAGE_ROOMS = ["base", "mesh", "files", "analysis", "job", "options", "view", "result", "edit", "share", "app"];

/** The room of a file or header; undefined for tests, which may include everything. */
export function roomOf(path) {
  const folder = path.slice(0, Math.max(path.lastIndexOf("/"), 0));
  return ROOMS.find((room) => room.folder === folder);
}

/** Rooms of words that all of core, or all of a room around them, speaks in: no namespace of their own. */
const COMMON = ["core", ...TERMS];
const WORDS = ["core/asset/gltf"];

/** The namespace of a room of core or the server: its folders; `base` is that of the room around it. */
export function namespaceOf(folder) {
  if (WORDS.includes(folder)) return namespaceOf(folder.slice(0, folder.lastIndexOf("/")));
  const names = COMMON.includes(folder) ? [] : folder.replace(/^core\//, "").split("/");
  return ["unwrapd", ...names.filter((name) => name !== "base")].join("::");
}

/** Top folders whose files must all be in a room. */
export const HOUSES = [...new Set(ROOMS.map(({ folder }) => folder.split("/")[0]))];

/** Rooms that include one that does not stand before them. */
export function upward(rooms) {
  const order = new Map(rooms.map(({ folder }, place) => [folder, place]));
  return rooms.flatMap(({ folder, includes }) =>
    includes
      .filter((room) => !(order.get(room) < order.get(folder)))
      .map((room) => `${folder} may not include ${room}, which does not stand before it`),
  );
}

/** The table of docs/architecture.md. */
export function table() {
  const names = ({ folder, includes }) =>
    includes.map((room) => room.replace(`${folder.split("/")[0]}/`, "")).join(", ") || "–";
  const row = (room) => `| \`${room.folder}\` | ${room.duty} | ${names(room)} |`;
  return ["| room | duty | may include |", "|---|---|---|", ...ROOMS.map(row)].join("\n");
}

if (process.argv[1] === fileURLToPath(import.meta.url)) console.log(table());

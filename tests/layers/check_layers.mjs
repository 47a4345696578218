// The rules of the source tree that no compiler checks: who may include whom, which library is seen
// by which files, how long a file may grow. Run on a checkout: node check_layers.mjs [ROOT]. Each
// breach is one line "path:line: rule"; the exit status is 1 when there is one.
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { basename, dirname, join, relative, sep } from "node:path";
import { fileURLToPath } from "node:url";

import { HOUSES, PAGE, PAGE_ROOMS, ROOMS, namespaceOf, roomOf, table, upward } from "./rooms.mjs";

/** A header (or the start of its name) -> where alone it may be included. */
const ONLY_IN = [
  { header: /^httplib\.h$/, files: /^(server|client)\/([a-z]+\/)?[a-z_]*http[a-z_]*\.(cpp|hpp)$|^tests\// },
  { header: /^nlohmann\//, files: /^(core\/json|core\/asset|api|server|client|tests)\// },
  { header: /^(thread|chrono|iostream|mutex|atomic|future)$/, files: /^(?!core\/)/ },
  { header: /^spdlog\//, files: /^server\// },
  { header: /^toml\+\+\//, files: /^server\/config\/config\.cpp$/ },
  { header: /^CLI\//, files: /^(server|client)\// },
  { header: /^seccomp\.h$/, files: /^server\/work\/sandbox\.cpp$/ },
  { header: /^png\.h$/, files: /^(core\/texture\/png\.cpp$|tests\/core\/texture\/|server\/work\/png_file\.cpp$|tests\/server\/)/ },
  { header: /^(jpeglib|jerror)\.h$/, files: /^core\/texture\/jpeg\.cpp$/ },
  { header: /^webp\//, files: /^core\/texture\/webp\.cpp$/ },
  { header: /^zip\.h$/, files: /^(core\/asset\/zip\.cpp$|tests\/asset\/)/ },
  { header: /^yaml\.h$/, files: /^api\/contract\// },
  { header: /^postgresql\//, files: /^server\/database\// },
  { header: /^sqlite3\.h$/, files: /^(server|tests\/server)\// },
  { header: /^(draco\/|meshoptimizer\.h|tiny_gltf\.h)/, files: /^(core\/asset|tests\/asset|tests\/fuzz)\// },
  { header: /^Eigen\//, files: /^(core|server|api|tests)\// },
  { header: /^CGAL\//, files: /^tests\/bench\// },
];

const MAX_LINES = [
  { files: /\.(cpp|hpp|mjs|sh|ts|py)$|^client\/js\/.*\.js$/, lines: 300 },
  { files: /^CMakeLists\.txt$/, lines: 60 },
  { files: /^README\.md$/, lines: 100 },
  { files: /^CONTRIBUTING\.md$/, lines: 80 },
  { files: /^docs\/adr\/.*\.md$/, lines: 40 },
];

/** Words that have no place in the project: left-overs, and paths of a developer's machine. */
const FORBIDDEN = [/\bTODO\b/, /\bFIXME\b/, /\bXXX\b/, /\/(home|Users|mnt)\/\w/, /"resolved":/];

/** Fixed names in a temporary folder, which two runs of the tests share. */
const SHARED_NAMES = /\bTempDir\(\) *[/+]|testing::TempDir\(\)|["'`]\/(tmp|var\/tmp|dev\/shm)\/\w/;

/** A rounding that GCC 12 drops where it works on two numbers at once; core/asset is compiled so that it does not. */
const DROPPED_ROUNDING = /cast<float>\(\)\.(template )?cast<double>\(\)|double>?[({](static_cast<)?float>?[({]/;

const SOURCE = /\.(cpp|hpp|mjs|js|ts|py|md|txt|json|yaml|yml|sh|cmake)$|(^|\/)(dev|run)$/;
const SKIPPED = new Set([".git", "build", "out", "data", "node_modules"]);

function* files(root, folder = root) {
  for (const entry of readdirSync(folder, { withFileTypes: true })) {
    const path = join(folder, entry.name);
    if (entry.isDirectory() && !SKIPPED.has(entry.name)) yield* files(root, path);
    else if (entry.isFile()) yield relative(root, path).split(sep).join("/");
  }
}

function includeBreaches(path, header, quoted) {
  const breaches = [];
  const room = roomOf(path);
  const other = roomOf(header);
  if (quoted && room && other && other !== room && !room.includes.includes(other.folder))
    breaches.push(`${room.folder} may not include ${header}`);
  if (quoted && HOUSES.some((house) => header.startsWith(`${house}/`)) && !other)
    breaches.push(`${header} is in no room`);
  if (quoted && header.startsWith("server/") && /^tests\/(?!(server|fault|fuzz|isolate|bench)\/)/.test(path))
    breaches.push("tests of other parts do not include server");
  if (quoted && room?.folder === "client" && header.startsWith("server/") && header !== "server/private_server.hpp")
    breaches.push("client includes server by private_server.hpp alone");
  for (const rule of ONLY_IN)
    if (rule.header.test(header) && !rule.files.test(path))
      breaches.push(`<${header}> may not be included here`);
  return breaches;
}

/** An import of the page from a folder of it that does not stand before the file's own. */
function importBreaches(path, line) {
  const from = path.startsWith(PAGE) && line.match(/(?:from |import\()'(\.[^']*)'/)?.[1];
  if (!from) return [];
  const roomIn = (file) => (file.startsWith(PAGE) ? PAGE_ROOMS.indexOf(file.slice(PAGE.length).split("/")[0]) : -1);
  const target = join(dirname(path), from).split(sep).join("/");
  if (target.startsWith("client/js/src/")) return [];
  const own = path.slice(PAGE.length).includes("/") ? roomIn(path) : PAGE_ROOMS.length;
  const other = roomIn(target);
  return own >= 0 && other >= 0 && other <= own ? [] : [`${path} may not import ${target}`];
}

/** A line that opens a namespace other than that of the file's room, or one in it. */
function namespaceBreaches(path, line) {
  const opened = line.match(/^namespace (unwrapd[\w:]*) \{/)?.[1];
  const room = opened && /^(core|server)\//.test(path) && roomOf(path);
  if (!room) return [];
  const own = namespaceOf(room.folder);
  return `${opened}::`.startsWith(`${own}::`) ? [] : [`${opened} is not the namespace of ${room.folder}, ${own}`];
}

/** All breaches of one file. */
export function check(path, text) {
  const breaches = [];
  const lines = text.split("\n");
  const isCode = /\.(cpp|hpp)$/.test(path);
  if (isCode && HOUSES.some((house) => path.startsWith(`${house}/`)) && !roomOf(path))
    breaches.push(`${path}: is in no room`);
  lines.forEach((line, number) => {
    const include = isCode && line.match(/^\s*#\s*include\s+(["<])([^">]+)[">]/);
    const found = include ? includeBreaches(path, include[2], include[1] === '"') : [];
    const words = path.startsWith("tests/layers/") ? [] : FORBIDDEN.filter((word) => word.test(line));
    const spaces = isCode ? namespaceBreaches(path, line) : importBreaches(path, line);
    if (path.startsWith("tests/") && !path.startsWith("tests/layers/") && SHARED_NAMES.test(line))
      found.push("a fixed temporary name; take a fresh folder (mkdtemp)");
    if (isCode && !/^(core\/asset|tests)\//.test(path) && DROPPED_ROUNDING.test(line))
      found.push("a rounding to float that GCC 12 may drop; see core/asset/CMakeLists.txt");
    for (const breach of [...found, ...spaces, ...words.map((word) => `forbidden: ${word.source}`)])
      breaches.push(`${path}:${number + 1}: ${breach}`);
  });
  const length = text.endsWith("\n") ? lines.length - 1 : lines.length;
  for (const rule of MAX_LINES)
    if (rule.files.test(path) && length > rule.lines)
      breaches.push(`${path}:${length}: longer than ${rule.lines} lines`);
  return breaches;
}

/** The types that a header defines, with their namespaces: "unwrapd::asset::Document". */
export function typesOf(text) {
  let space = "";
  const types = [];
  for (const line of text.split("\n")) {
    space = line.match(/^namespace ([\w:]+) \{/)?.[1] ?? space;
    const type = line.match(/^(?:struct|class|enum class) (\w+)\b[^;]*$/)?.[1];
    if (type) types.push(`${space}::${type}`);
  }
  return types;
}

/**
 * Types that two headers define under one name: the linker keeps one copy of their functions for
 * both, without a word.
 */
export function twins(headers) {
  const firstIn = new Map();
  const breaches = [];
  for (const { path, text } of headers)
    for (const type of typesOf(text)) {
      if (firstIn.has(type)) breaches.push(`${path}: ${type} is defined in ${firstIn.get(type)}, too`);
      else firstIn.set(type, path);
    }
  return breaches;
}

/** Documents. Decisions (docs/adr) name today's files, too, even where the figures beside them are older. */
const GUIDE = /^([A-Z]+|docs\/[a-z]+|docs\/adr\/[\w-]+)\.md$/;
const PATH_IN_TREE = /^(core|api|server|client|tests|docker|docs)(\/[\w.-]+)+$|^\w+\/[\w./-]+\.(cpp|hpp|mjs|js|cmake)$/;
/** The end of a path ("solve/untangle", "frames.cpp"), where all of it belongs; not a type of media, or what is built. */
const END_OF_PATH = /^(?!(application|build|image|model|text)\/)[a-z]\w*(\/[a-z_]+)+$|^\w+\.[ch]pp$/;

/** Files and folders that a guide names or links to and that do not exist. exists: of a path. */
export function deadPaths(path, text, exists) {
  if (!GUIDE.test(path) || path === "CHANGELOG.md") return [];
  const folder = dirname(path);
  const named = [...text.matchAll(/`([^`\n]+)`/g)].map(([, name]) => name).filter((name) => PATH_IN_TREE.test(name) || END_OF_PATH.test(name));
  const linked = [...text.matchAll(/\]\(([^)#:\s]+)(?:#[^)]*)?\)/g)].map(([, link]) => join(folder, link).split(sep).join("/"));
  const isThere = (name) => ["", ".cpp", ".hpp"].some((extension) => exists(name + extension));
  return [...named, ...linked].filter((name) => !isThere(name)).map((name) => `${path}: ${name} does not exist`);
}

/** Sources whose comments name a file that is not in the tree. names: of all files, without folders. */
export function deadMentions(sources, names) {
  return sources.flatMap(({ path, text }) =>
    [...text.matchAll(/\/\/.*?\b(\w+\.[ch]pp)\b/g)]
      .filter(([, name]) => !names.has(name))
      .map(([, name]) => `${path}: ${name}, which a comment names, does not exist`),
  );
}

/** Folders at the top of the tree. */
const TOP = ["api", "client", "core", "docker", "docs", "server", "tests"];

/** Top folders of the paths that are not among TOP, but for hidden ones. */
export function strangers(paths) {
  const folders = new Set(paths.filter((path) => /^[^.].*\//.test(path)).map((path) => path.split("/")[0]));
  return [...folders]
    .filter((name) => !TOP.includes(name))
    .map((name) => `${name}: the top of the tree has the folders ${TOP.join(", ")} alone`);
}

/** All breaches of a checkout. */
export function checkTree(root) {
  const breaches = [];
  const headers = [];
  const sources = [];
  const checked = [...files(root)].filter((path) => SOURCE.test(path));
  for (const path of checked) {
    const text = readFileSync(join(root, path), "utf8");
    breaches.push(...check(path, text));
    breaches.push(...deadPaths(path, text, (name) => existsSync(join(root, name))));
    if (/\.[ch]pp$/.test(path)) sources.push({ path, text });
    if (/^(core|api|server|client)\/.*\.hpp$/.test(path)) headers.push({ path, text });
  }
  if (!readFileSync(join(root, "docs/architecture.md"), "utf8").includes(table()))
    breaches.push("docs/architecture.md: its table of rooms is not that of `node tests/layers/rooms.mjs`");
  const names = new Set(sources.map(({ path }) => basename(path)));
  return { breaches: [...breaches, ...upward(ROOMS), ...twins(headers), ...deadMentions(sources, names), ...strangers(checked)], count: checked.length };
}

const self = fileURLToPath(import.meta.url);
if (process.argv[1] === self) {
  const root = process.argv[2] ?? join(dirname(self), "..", "..");
  const { breaches, count } = checkTree(root);
  for (const breach of breaches) console.error(breach);
  console.log(`layers: ${count} files, ${breaches.length} breaches`);
  process.exit(breaches.length > 0 || count === 0 ? 1 : 0);
}

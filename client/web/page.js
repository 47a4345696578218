// The page: sends a mesh with the options of the form, follows the job by its events and shows what
// came of it. It uses nothing but the API that everybody has; the key stays in the form.
import { $, buildForm, chosenOptions } from "./form.js";

const LINE = /\r\n|\r|\n/;

const wait = (seconds) => new Promise((resolve) => setTimeout(resolve, seconds * 1000));
const fixed = (number, digits) => (number < Number.MAX_VALUE ? number.toFixed(digits) : "infinite");
const shown = (id, visible) => { $(id).hidden = !visible; };

let jobUrl;       // of the job that is under way or done
let given = [];   // addresses of blobs on the page

/** What went wrong, as the server's problem document says it. */
class Problem extends Error {
  constructor(document, retryAfter) {
    super(document.detail ?? document.title);
    Object.assign(this, { document, retryAfter });
  }
}

/** A request with the key; throws Problem for any answer that is not one of success. */
async function call(url, init = {}) {
  const key = $("key").value.trim();
  const headers = { ...init.headers, ...(key && { Authorization: `Bearer ${key}` }) };
  const answer = await fetch(url, { ...init, headers, cache: "no-store" });
  if (answer.ok) return answer;
  const fallback = { title: answer.statusText || `Status ${answer.status}`, status: answer.status };
  const document = await answer.json().catch(() => fallback);
  throw new Problem(document, Number(answer.headers.get("Retry-After")));
}

/* ---- the request ---- */

function body() {
  const files = [...$("files").files];
  const mesh = files.find(({ name }) => /\.(glb|gltf|obj|stl|ply|off|zip)$/i.test(name)) ?? files[0];
  const form = new FormData();
  form.append("options", new Blob([JSON.stringify(chosenOptions())], { type: "application/json" }));
  form.append("mesh", mesh, mesh.name);
  for (const file of files) if (file !== mesh) form.append("buffer", file, file.name);
  return { form, name: mesh.name.replace(/\.[^.]*$/, "") };
}

/* ---- the job ---- */

function tell(text, fraction) {
  $("status").textContent = text;
  if (fraction === undefined) $("fraction").removeAttribute("value");
  else $("fraction").value = fraction;
}

/** Sends the mesh; a server that is busy says when to come again. */
async function submit(form) {
  for (;;) {
    tell("Sending the mesh…");
    try {
      return await (await call("v1/jobs", { method: "POST", body: form })).json();
    } catch (error) {
      if (!(error.retryAfter > 0) || error.document.code === "too_many_jobs") throw error;
      tell(`The server is busy; sending again in ${error.retryAfter} s.`);
      await wait(error.retryAfter);
    }
  }
}

/** The events of one connection: {id, event, data}. */
async function* eventsOf(answer) {
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  for (;;) {
    const { value, done } = await reader.read();
    if (done) return;
    const blocks = (rest + value).split("\n\n");
    rest = blocks.pop();
    for (const block of blocks) {
      const fields = block.split(LINE).map((line) => line.split(/: ?(.*)/s));
      const event = Object.fromEntries(fields.filter(([name]) => name));
      if (event.event) yield event;
    }
  }
}

const SAYS = {
  queued: ({ position }) => tell(position > 0 ? `Waiting; jobs ahead: ${position}.` : "Waiting…", 0),
  started: () => tell("Started.", 0),
  stage({ name, chart, of, fraction }) {
    tell(of > 1 ? `${name}, chart ${chart + 1} of ${of}` : name, fraction);
  },
  iteration({ i, energy, angle, area, flipped, fraction }) {
    $("fraction").value = fraction;
    $("iteration").textContent = `Iteration ${i}: energy ${fixed(energy, 6)}, ` +
      `angles ${fixed(angle, 4)}, areas ${fixed(area, 4)}, ${flipped} flipped`;
  },
};
const ENDS = ["succeeded", "failed", "cancelled"];

/** Follows the job to its end, over connections that break as well; resolves to the job. */
async function follow(job) {
  let last = "0";
  for (let failures = 0; failures < 10;) {
    try {
      const headers = { Accept: "text/event-stream", "Last-Event-ID": last };
      for await (const { id, event, data } of eventsOf(await call(job.links.events, { headers }))) {
        failures = 0;
        last = id ?? last;
        if (ENDS.includes(event)) return JSON.parse(data);
        SAYS[event]?.(JSON.parse(data));
      }
    } catch (error) {
      if (error instanceof Problem && !error.retryAfter) throw error;
    }
    failures += 1;
    await wait(Math.min(failures, 5));
  }
  throw new Error(`The connection was lost. The job continues at ${job.links.self}`);
}

/* ---- the result ---- */

/** What an address answers, and one of the page's own for it. */
async function blobOf(url) {
  const blob = await (await call(url)).blob();
  given.push(URL.createObjectURL(blob));
  return { blob, url: given.at(-1) };
}

function showFigures({ charts, distortion, overlaps, seam_ratio: seams, fill, notes }) {
  const figures = { Charts: charts.length, "Angles (2 is ideal)": fixed(distortion.angle, 4),
    "Areas (2 is ideal)": fixed(distortion.area, 4), Flipped: distortion.flipped,
    Overlaps: overlaps ?? "not counted",
    "Seams / √area": fixed(seams, 2), "Page filled": `${(100 * fill).toFixed(1)} %` };
  $("figures").replaceChildren(...Object.entries(figures).map(([name, value]) => {
    const pair = document.createElement("div");
    const make = (tag, text) => Object.assign(document.createElement(tag), { textContent: text });
    pair.append(make("dt", name), make("dd", value));
    return pair;
  }));
  $("notes").replaceChildren(...notes.map(({ text }) =>
    Object.assign(document.createElement("li"), { textContent: text })));
}

const EXTENSION = { "model/gltf-binary": "glb", "model/gltf+json": "gltf", "model/obj": "obj" };

async function showResult({ links }, name) {
  const [asset, report, layout, preview] = await Promise.all(
    [links.result, links.report, links.layout_png, links.preview].map(blobOf));
  showFigures(JSON.parse(await report.blob.text()));
  const extension = EXTENSION[asset.blob.type] ?? "bin";
  Object.assign($("asset"), { href: asset.url, download: `${name}.uv.${extension}` });
  Object.assign($("report"), { href: report.url, download: `${name}.report.json` });
  $("layout").src = layout.url;
  $("preview").src = preview.url;
  shown("result", true);
}

function showProblem(error) {
  const { title, code, pointer, status } = error.document ?? {};
  if (status === 401) shown("key-row", true);
  const where = pointer ? ` At ${pointer}.` : "";
  const lines = [title ?? "An error occurred", `${error.message}${where}`, code ? `Code: ${code}` : ""];
  $("problem").replaceChildren(...lines.filter(Boolean).map((text, line) =>
    Object.assign(document.createElement(line ? "p" : "h2"), { textContent: text })));
  shown("problem", true);
}

function clear() {
  for (const url of given.splice(0)) URL.revokeObjectURL(url);
  for (const id of ["problem", "result"]) shown(id, false);
  $("iteration").textContent = "";
  jobUrl = undefined;
}

async function unwrap() {
  const { form, name } = body();
  const job = await submit(form);
  jobUrl = job.links.self;
  shown("cancel", true);
  const ended = await follow(job);
  if (ended.state !== "succeeded") throw new Problem(ended.problem);
  tell("Fetching the result…", 1);
  await showResult(ended, name);
  tell("Done.", 1);
}

async function run() {
  clear();
  shown("job", true);
  $("send").disabled = true;
  try {
    await unwrap();
  } catch (error) {
    shown("job", false);
    showProblem(error);
  } finally {
    $("send").disabled = false;
    shown("cancel", false);
  }
}

function watchFiles() {
  const say = () => {
    const names = [...$("files").files].map(({ name }) => name);
    $("chosen").textContent = names.length > 1 ? names.join(", ") : "";
  };
  $("files").addEventListener("change", say);
  for (const kind of ["dragover", "dragleave", "drop"])
    $("drop").addEventListener(kind, (event) => {
      event.preventDefault();
      $("drop").classList.toggle("over", kind === "dragover");
      if (kind !== "drop") return;
      $("files").files = event.dataTransfer.files;
      say();
    });
}

async function start() {
  buildForm(await (await call("v1/methods")).json());
  watchFiles();
  $("form").addEventListener("submit", (event) => { event.preventDefault(); run(); });
  $("cancel").addEventListener("click", () => call(jobUrl, { method: "DELETE" }).catch(showProblem));
}

start().catch(showProblem);

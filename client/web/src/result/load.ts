// A result as a model: the meshes and the report of a job, in the places where its scene has them.
import {documentOf, meshesWithTriangles, placesOf} from '../files/scene.js';
import {type Job, type Report, type Result} from '../job/run.js';
import {getBlob, getJson} from '../job/server.js';
import {IDENTITY, type Model, type UvSet, uvOfCorners} from '../mesh/model.js';

export interface Loaded {
  report: Report;
  model: Model;
}

/** Of a list of lambdas: which of them; empty for a single one. */
export const ofLambda = (lambda: number | undefined) => (lambda === undefined ? '' : `?lambda=${lambda}`);

/** Where meshes stand: as in the file that is open, else as the result's own document says. */
async function placesIn(job: Job, count: number, open: Model | undefined, signal?: AbortSignal): Promise<number[][][]> {
  if (open?.parts.length === count) return open.parts.map(({places}) => places);
  if (count === 1 && open) return [[IDENTITY]];
  const asset = await getBlob(job.links.result, undefined, signal);
  if (!/^model\/gltf/.test(asset.type)) return Array.from({length: count}, () => [IDENTITY]);
  const document = documentOf(await asset.arrayBuffer());
  const places = placesOf(document);
  return meshesWithTriangles(document).map((m) => places[m]!);
}

export async function loadResult(job: Job, lambda: number | undefined, open: Model | undefined, signal?: AbortSignal): Promise<Loaded> {
  const {report, meshes} = await getJson<Result>(`${job.links.result}.json${ofLambda(lambda)}`, signal);
  const places = await placesIn(job, meshes.length, open, signal);
  const parts = meshes.map(({name, positions, uv, faces, vertex_map: sources}, m) => {
    const corners = Uint32Array.from(faces);
    return {
      name, positions: Float32Array.from(positions), faces: corners, places: places[m] ?? [IDENTITY],
      uvSets: [{name: `TEXCOORD_${report.texcoord}`, uv: uvOfCorners(uv, corners)}], sources: Uint32Array.from(sources),
    };
  });
  return {report, model: {parts}};
}

/** A result of another result's file, whose vertices are those of the mesh that came in first. Faces keep their order. */
export function withSourcesOf(model: Model, first: Model): Model {
  const sourced = model.parts.map((part, p) => {
    const from = first.parts[p];
    if (!from?.sources || from.faces.length !== part.faces.length) return part;
    const sources = new Uint32Array(part.positions.length / 3);
    part.faces.forEach((vertex, corner) => (sources[vertex] = from.sources![from.faces[corner]!]!));
    return {...part, sources};
  });
  return {...model, parts: sourced};
}

/** The file of a result, with its materials. */
export async function loadAsset(job: Job, lambda: number | undefined): Promise<Model> {
  const blob = await getBlob(job.links.result + ofLambda(lambda), 'model/gltf-binary');
  return (await import('../files/gltf.js')).readGltf(await blob.arrayBuffer(), []);
}

/** A result that is soon replaced: read from the file itself, which is there when the job ends; JSON is made when asked for. */
export async function loadDraft(job: Job): Promise<Loaded> {
  const [report, {parts}] = await Promise.all([getJson<Report>(job.links.report), loadAsset(job, undefined)]);
  const isWritten = ({name}: UvSet) => name === `TEXCOORD_${report.texcoord}`;
  return {report, model: {parts: parts.map((part) => ({...part, uvSets: part.uvSets.filter(isWritten)}))}};
}

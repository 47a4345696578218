// Materials of a glTF, as far as the page shows them: base colours and their images.
import type {Look} from '../mesh/model.js';
import type {Document} from './scene.js';

interface TextureInfo {
  index: number;
  texCoord?: number;
  extensions?: {KHR_texture_transform?: {offset?: [number, number]; rotation?: number; scale?: [number, number]; texCoord?: number}};
}

interface Material {
  pbrMetallicRoughness?: {baseColorFactor?: number[]; baseColorTexture?: TextureInfo};
}

interface Texture {
  source?: number;
  sampler?: number;
  extensions?: {EXT_texture_webp?: {source: number}};
}

interface Image {
  uri?: string;
  bufferView?: number;
  mimeType?: string;
}

export interface Parts {
  /** The bytes of a view of a buffer. */
  view: (index: number) => Promise<ArrayBuffer>;
  /** Where a file lies that the document names; undefined if it was not opened. */
  urlOf: (uri: string) => string | undefined;
}

/** Bytes of an image; none for those that are not there, or that browsers cannot read. */
async function imageOf({uri, bufferView, mimeType}: Image, {view, urlOf}: Parts): Promise<Blob | undefined> {
  if (bufferView !== undefined) return new Blob([await view(bufferView)], mimeType ? {type: mimeType} : {});
  const url = uri && (uri.startsWith('data:') ? uri : urlOf(uri));
  return url ? (await fetch(url)).blob() : undefined;
}

/** The transform of KHR_texture_transform, for V that points up here and down there. */
function transformOf({offset = [0, 0], rotation = 0, scale = [1, 1]}: NonNullable<NonNullable<TextureInfo['extensions']>['KHR_texture_transform']> = {}): number[] {
  const [cos, sin] = [Math.cos(rotation), Math.sin(rotation)];
  const [a, b, d, e] = [cos * scale[0], sin * scale[1], -sin * scale[0], cos * scale[1]]; // with V down
  return [a, -b, b + offset[0], -d, e, 1 - e - offset[1]];
}

async function lookOf({pbrMetallicRoughness: {baseColorFactor = [1, 1, 1], baseColorTexture: info} = {}}: Material, document: Document, parts: Parts): Promise<Look> {
  const texture = info && ((document['textures'] ?? []) as Texture[])[info.index];
  const source = texture?.extensions?.EXT_texture_webp?.source ?? texture?.source;
  const image = source === undefined ? undefined : await imageOf(((document['images'] ?? []) as Image[])[source]!, parts);
  const {wrapS = 10497, wrapT = 10497} = ((document['samplers'] ?? []) as {wrapS?: number; wrapT?: number}[])[texture?.sampler ?? -1] ?? {};
  const moved = info?.extensions?.KHR_texture_transform;
  return {
    factor: baseColorFactor.slice(0, 3) as Look['factor'], set: `TEXCOORD_${moved?.texCoord ?? info?.texCoord ?? 0}`,
    transform: transformOf(moved), wrap: [wrapS, wrapT], ...(image ? {image} : {}),
  };
}

/** All materials, and after them the look of what has none. */
export function looksOf(document: Document, parts: Parts): Promise<Look[]> {
  const materials = (document['materials'] ?? []) as Material[];
  return Promise.all([...materials, {}].map((material) => lookOf(material, document, parts)));
}

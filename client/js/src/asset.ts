/** The bytes of a file. */
export type Bytes = Blob | ArrayBuffer | ArrayBufferView;

/** A .gltf and the files beside it, by the URIs by which it names them. */
export interface AssetInParts {
  mesh: Bytes;
  buffers: Record<string, Bytes>;
}

export type Asset = Bytes | AssetInParts;

function blobOf(bytes: Bytes): Blob {
  return bytes instanceof Blob ? bytes : new Blob([bytes as BlobPart]);
}

function isInParts(asset: Asset): asset is AssetInParts {
  return 'mesh' in asset && 'buffers' in asset;
}

/** The request that sends an asset with options. */
export function formOf(asset: Asset, options: object): FormData {
  const {mesh, buffers} = isInParts(asset) ? asset : {mesh: asset, buffers: {}};
  const form = new FormData();
  form.append('options', new Blob([JSON.stringify(options)], {type: 'application/json'}));
  form.append('mesh', blobOf(mesh));
  for (const [uri, bytes] of Object.entries(buffers)) form.append('buffer', blobOf(bytes), uri);
  return form;
}

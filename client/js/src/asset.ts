/** The bytes of a file. */
export type Bytes = Blob | ArrayBuffer | ArrayBufferView;

/** A .gltf and the files beside it, by the URIs by which it names them. */
export interface AssetInParts {
  mesh: Bytes;
  buffers: Record<string, Bytes>;
}

/** A URL is an address that the server reads, where its operator allows the host (`--source-hosts`). */
export type Asset = Bytes | AssetInParts | URL;

function blobOf(bytes: Bytes): Blob {
  return bytes instanceof Blob ? bytes : new Blob([bytes as BlobPart]);
}

function isInParts(asset: Bytes | AssetInParts): asset is AssetInParts {
  return 'mesh' in asset && 'buffers' in asset;
}

/** The request that sends an asset with options: a form, or JSON with its address. */
export function requestOf(asset: Asset, options: object, name: string | undefined):
    {body: FormData | string; headers: Record<string, string>} {
  if (asset instanceof URL) {
    const body = JSON.stringify({source: asset.href, options, name});
    return {body, headers: {'Content-Type': 'application/json'}};
  }
  const form = formOf(asset, options);
  if (name !== undefined) form.append('name', name);
  return {body: form, headers: {}};
}

function formOf(asset: Bytes | AssetInParts, options: object): FormData {
  const {mesh, buffers} = isInParts(asset) ? asset : {mesh: asset, buffers: {}};
  const form = new FormData();
  form.append('options', new Blob([JSON.stringify(options)], {type: 'application/json'}));
  form.append('mesh', blobOf(mesh));
  for (const [uri, bytes] of Object.entries(buffers)) form.append('buffer', blobOf(bytes), uri);
  return form;
}

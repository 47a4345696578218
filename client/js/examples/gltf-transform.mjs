// node examples/gltf-transform.mjs IN.glb OUT.glb: a step of a glTF-Transform pipeline.
import {NodeIO} from '@gltf-transform/core';
import {unwrapd} from 'unwrapd-client/gltf-transform';

const [input, output] = process.argv.slice(2);
const io = new NodeIO();
const document = await io.read(input);
await document.transform(unwrapd({server: process.env.UNWRAPD_SERVER, overwrite: true}));
await io.write(output, document);

// The decoder of Draco: a module and its WebAssembly beside the page.
import wasm from 'three/examples/jsm/libs/draco/gltf/draco_decoder.wasm?url';
import js from 'three/examples/jsm/libs/draco/gltf/draco_wasm_wrapper.js?url';
import {DRACOLoader} from 'three/examples/jsm/loaders/DRACOLoader.js';

export async function dracoLoader(): Promise<DRACOLoader> {
  return new DRACOLoader().setDecoderPath({js, wasm});
}

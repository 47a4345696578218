// What people call the options; the API's own name stands beside it. What is not here has the API's
// name, so that a new option needs no line.

const NAMES: Record<string, string> = {
  method: 'Method', lambda: 'Balance of angles and areas', lambda_units: 'Scale of the balance',
  'stop.iterations': 'Exact number of iterations', 'stop.tolerance': 'Converged below', 'stop.max_iterations': 'Most iterations',
  initial: 'Start from', pins: 'How position is fixed', guarantee: 'Guarantee', repair: 'How flips are repaired',
  boundary: 'Shape of the boundary', symmetry: 'Symmetric seams', seams: 'Cuts of the file', weld: 'Close gaps of rounding', weld_distance: 'Widest gap to close',
  seam_avoid: 'Painted: no seams here', texel_density: 'Painted: more texels here',
  max_distortion: 'Most distortion', max_charts: 'Most charts', effort: 'Effort', resolution: 'Texture size', width: 'Texture width',
  height: 'Texture height', padding: 'Gap between islands', texels_per_unit: 'Fixed texel density', max_pages: 'Most pages (UDIM)',
  straighten: 'Straighten strips', group: 'A page for each', rotation: 'Turn islands', stack_identical: 'Stack identical islands',
  repack_only: 'Only pack again', measure_only: 'Only measure', texcoord: 'Set to write', textures: 'Existing textures', output: 'File format',
  compression: 'Compression', draco_bits: 'Draco precision', vertex_map: 'List duplicated vertices',
};

const UNITS: Record<string, string> = {resolution: 'texels', width: 'texels', height: 'texels', padding: 'texels', draco_bits: 'bits'};

/** Words for values that are names of the API. */
const VALUES: Record<string, Record<string, string>> = {
  effort: {fast: 'Fast', balanced: 'Balanced', best: 'Best'},
  guarantee: {none: 'None: the raw map', flip_free: 'No flipped triangle', bijective: 'No flip, no overlap'},
  boundary: {free: 'Free', circle: 'Circle', square: 'Square'},
  seams: {auto: 'Automatic', keep: 'Keep all', none: 'Close all', uv0: 'Seams of the existing UVs'},
  rotation: {any: 'As they fit best', 90: 'By quarter turns', none: 'Not at all'},
  textures: {keep: 'Keep as they are', transfer: 'Resample for the new UVs'},
  output: {auto: 'As the input', glb: 'GLB', gltf: 'glTF', obj: 'OBJ'},
  straighten: {off: 'No', auto: 'Where it distorts little'},
  group: {scene: 'The scene: one for all', material: 'Material', mesh: 'Mesh'},
  weld: {auto: 'Automatic', exact: 'No'},
  symmetry: {off: 'No', auto: 'Where the mesh is symmetric'},
  initial: {auto: 'Automatic', mean_value: 'Mean values', tutte: 'Tutte’s map', lscm: 'A conformal map'},
  lambda_units: {dimensionless: 'The same for every size', paper: 'In units of the mesh, as in the paper'},
  pins: {diameter: 'Two far vertices', spectral: 'None: the spectral map'},
  repair: {untangle: 'Turn flipped triangles back', virtual_boundary: 'By a virtual boundary, as in the paper'},
  compression: {keep: 'As the input', none: 'None', draco: 'Draco', meshopt: 'meshopt'},
};

/** A value in words, with the API's name where that is another: help texts use it. */
export function wordsOf(name: string, value: string): string {
  const words = VALUES[name]?.[value];
  return !words || words.toLowerCase() === value ? (words ?? value) : `${words} (${value})`;
}

/** The options that stand before the others. */
export const FIRST = ['method', 'max_distortion', 'effort', 'resolution', 'padding'];

export function labelOf(name: string): string {
  const unit = UNITS[name];
  return (NAMES[name] ?? name) + (unit ? ` (${unit})` : '');
}

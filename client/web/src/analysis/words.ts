// An analysis in sentences.
import {count, list} from '../base/words.js';
import type {Analysis} from './analyse.js';

function shape({components, boundaries, genus, branching}: Analysis): string {
  const pieces = components === 1 ? 'One connected piece' : count(components, 'connected piece');
  const borders = boundaries === 0 ? 'closed: it has no boundary' : count(boundaries, 'boundary', 'boundaries');
  if (branching > 0 || genus === undefined) return `${pieces}; ${borders}.`;
  if (components === 1 && boundaries === 1 && genus === 0) return 'A disk: one connected piece with one boundary. It can be one chart.';
  const handles = genus > 0 ? `, ${count(genus, 'handle')}` : '';
  return `${pieces}; ${borders}${handles}.`;
}

function uvSentence({uvSets}: Analysis): string {
  if (uvSets.length === 0) return 'No texture coordinates yet.';
  const sets = uvSets.map(({name, islands}) => `${name} with ${count(islands, 'island')}`);
  return `${count(uvSets.length, 'set')} of texture coordinates: ${list(sets)}.`;
}

/** What one should know of a mesh, problems last. */
export function sentences(analysis: Analysis): string[] {
  const {meshes, faces, vertices, branching, degenerate} = analysis;
  const size = `${count(faces, 'triangle')} and ${count(vertices, 'vertex', 'vertices')}${meshes > 1 ? ` in ${count(meshes, 'mesh', 'meshes')}` : ''}.`;
  return [
    size, shape(analysis), uvSentence(analysis),
    branching > 0 ? `${count(branching, 'half-edge')} at edges with three or more faces. The surface is split there.` : '',
    degenerate > 0 ? `${count(degenerate, 'triangle')} without area. They get none on the page.` : '',
  ].filter(Boolean);
}

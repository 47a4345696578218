// node examples/three.mjs: a light map for a torus knot, in the second set of texture coordinates.
import {TorusKnotGeometry} from 'three';
import {unwrapGeometry} from 'unwrapd-client/three';

const knot = new TorusKnotGeometry(1, 0.3, 32, 6);
const {geometry, report} = await unwrapGeometry(knot, {preset: 'lightmap', effort: 'fast'}, {server: process.env.UNWRAPD_SERVER});
knot.dispose();
geometry.setAttribute('uv1', geometry.getAttribute('uv'));
console.log(`${geometry.getAttribute('uv1').count} vertices, ${report.charts.length} charts`);

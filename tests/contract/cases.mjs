// Every operation with the statuses that a server at its defaults gives. Each function that these
// files export is a group of cases; cases/shared.mjs has none.
export * from './cases/access.mjs';
export * from './cases/bodies.mjs';
export * from './cases/jobs.mjs';
export * from './cases/meshes.mjs';
export * from './cases/options.mjs';
export * from './cases/service.mjs';

// The names of the contract's types. contract.ts is generated from api/openapi.yaml when the package
// is built.
import type {components} from './contract.js';

type Schemas = components['schemas'];

export type Options = Schemas['Options'];
export type Job = Schemas['Job'];
export type JobEvent = Schemas['JobEvent'];
export type Problem = Schemas['Problem'];
export type Report = Schemas['Report'];
export type Result = Schemas['Result'];
export type Tickets = Schemas['Tickets'];

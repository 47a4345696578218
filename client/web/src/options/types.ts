// The answer of GET /v1/methods.
import type {components} from '../../../js/src/contract.js';

export type Methods = components['schemas']['Methods'];
export type Option = components['schemas']['Option'];

// openapi.yaml as a judge: does an answer of the server obey the contract? Everything that it finds
// out of order is a sentence; no sentence means that the answer is as documented.
import Ajv2020 from 'ajv/dist/2020.js';
import addFormats from 'ajv-formats';
import {readFileSync} from 'node:fs';
import {dirname, join} from 'node:path';
import yaml from 'js-yaml';

const kAnyCall = new Set([400, 403, 404, 405, 408, 431, 500]);  // what `default` stands for

const escape = (token) => String(token).replaceAll('~', '~0').replaceAll('/', '~1');

export class Contract {
  constructor(path) {
    this.path = path;
    this.document = yaml.load(readFileSync(path, 'utf8'));
    this.ajv = new Ajv2020({strict: false, allErrors: true});
    addFormats(this.ajv);
    this.ajv.addSchema({...this.document, $id: 'contract'});
    this.seen = new Set();  // "getJob 200"
    this.codes = new Set();  // of problems, wherever they stood
    this.validators = new Map();
  }

  /** What is at a pointer, references followed: {pointer, value}. */
  locate(pointer) {
    let at = {pointer: '#', value: this.document};
    for (const token of pointer.split('/').slice(1)) {
      const key = token.replaceAll('~1', '/').replaceAll('~0', '~');
      at = this.follow({pointer: `${at.pointer}/${token}`, value: at.value?.[key]});
    }
    return at;
  }

  follow(at) {
    return typeof at.value?.$ref === 'string' ? this.locate(at.value.$ref) : at;
  }

  /** Problems of value against the schema at pointer, as sentences. */
  check(pointer, value) {
    if (!this.validators.has(pointer)) {
      this.validators.set(pointer, this.ajv.compile({$ref: `contract${pointer}`}));
    }
    const validate = this.validators.get(pointer);
    if (validate(value)) return [];
    return validate.errors.map((e) => `${e.instancePath} ${e.message} ${JSON.stringify(e.params)}`);
  }

  /** The schemas of all options, by name. */
  options() {
    const at = '#/components/schemas/Options/properties';
    return Object.fromEntries(Object.keys(this.locate(at).value)
      .map((name) => [name, this.locate(`${at}/${name}`).value]));
  }

  checkNamed(schema, value) {
    return this.check(`#/components/schemas/${schema}`, value);
  }

  /** All operations: [{id, method, path, pointer, responses}]. */
  operations() {
    const found = [];
    for (const [path, item] of Object.entries(this.document.paths)) {
      for (const method of ['get', 'put', 'post', 'delete', 'patch']) {
        if (!item[method]) continue;
        const pointer = `#/paths/${escape(path)}/${method}`;
        found.push({id: item[method].operationId, method: method.toUpperCase(), path, pointer,
                    responses: item[method].responses});
      }
    }
    return found;
  }

  operation(id) {
    const found = this.operations().find((operation) => operation.id === id);
    if (!found) throw new Error(`openapi.yaml has no operation ${id}`);
    return found;
  }

  /** Documented pairs "operation status" that no answer has shown yet. */
  unseen() {
    return this.operations().flatMap((operation) =>
      Object.keys(operation.responses)
        .filter((status) => /^\d+$/.test(status))
        .map((status) => `${operation.id} ${status}`)
        .filter((pair) => !this.seen.has(pair)));
  }

  /** Judges an answer of an operation; returns sentences. */
  judge(id, answer) {
    const operation = this.operation(id);
    this.seen.add(`${id} ${answer.status}`);
    const explicit = operation.responses[answer.status] !== undefined;
    if (!explicit && !(operation.responses.default && kAnyCall.has(answer.status))) {
      return [`status ${answer.status} is not documented: ${answer.body?.subarray(0, 300)}`];
    }
    const at = this.locate(`${operation.pointer}/responses/${explicit ? answer.status : 'default'}`);
    return [...this.judgeHeaders(at, answer), ...this.judgeBody(at, answer)];
  }

  judgeHeaders(at, answer) {
    const problems = [];
    for (const name of Object.keys(at.value.headers ?? {})) {
      const header = this.locate(`${at.pointer}/headers/${escape(name)}`);
      const text = answer.headers[name.toLowerCase()];
      if (text === undefined) {
        if (header.value.required) problems.push(`the header ${name} is missing`);
        continue;
      }
      problems.push(...this.judgeHeader(header, text).map((p) => `header ${name}: ${p}`));
    }
    return problems;
  }

  judgeHeader(header, text) {
    if (header.value.content) {
      return this.check(`${header.pointer}/content/application~1json/schema`, JSON.parse(text));
    }
    const isNumber = ['integer', 'number'].includes(header.value.schema.type);
    return this.check(`${header.pointer}/schema`, isNumber ? Number(text) : text);
  }

  judgeBody(at, answer) {
    const documented = at.value.content;
    if (!documented) {
      return answer.body.length === 0 ? [] : ['there is a body where none is documented'];
    }
    const type = (answer.headers['content-type'] ?? '').split(';')[0].trim();
    if (!documented[type]) return [`the media type "${type}" is not documented`];
    const pointer = `${at.pointer}/content/${escape(type)}/schema`;
    if (type === 'text/event-stream') return this.judgeEvents(answer.body.toString());
    if (!type.endsWith('json') || this.locate(pointer).value.format === 'binary') return [];
    return this.judgeJson(at, pointer, answer);
  }

  judgeJson(at, pointer, answer) {
    let json;
    try {
      json = JSON.parse(answer.body.toString());
    } catch (error) {
      return [`the body is not JSON: ${error.message}`];
    }
    this.noteCodes(json);
    const problems = this.check(pointer, json);
    if (!answer.headers['content-type'].startsWith('application/problem+json')) return problems;
    if (json.status !== answer.status) problems.push(`the problem says status ${json.status}`);
    const codes = [...at.value.description.matchAll(/`([a-z_]+)`/g)].map((match) => match[1])
      .filter((code) => this.errorCodes().includes(code));
    if (codes.length > 0 && !codes.includes(json.code)) {
      problems.push(`the code ${json.code} is not documented for ${answer.status}: ${json.detail}`);
    }
    return problems;
  }

  /** Remembers the problems in a body: itself, or those of the jobs in it. */
  noteCodes(value) {
    if (value === null || typeof value !== 'object') return;
    if (String(value.type).startsWith('urn:unwrapd:problem:')) this.codes.add(value.code);
    Object.values(value).forEach((child) => this.noteCodes(child));
  }

  errorCodes() {
    return this.document.components.schemas.ErrorCode.enum;
  }

  judgeEvents(text) {
    return parseEvents(text).flatMap((event) =>
      this.checkNamed('JobEvent', event).map((p) => `event ${event.event}: ${p}`));
  }

  /** Every externalValue of the document: [{pointer, file, schema}]. */
  examples() {
    const found = [];
    const walk = (value, pointer) => {
      if (value === null || typeof value !== 'object') return;
      for (const example of Object.values(value.examples ?? {})) {
        if (!example.externalValue) continue;
        found.push({file: join(dirname(this.path), example.externalValue),
                    schema: `${pointer}/schema`});
      }
      for (const [key, child] of Object.entries(value)) walk(child, `${pointer}/${escape(key)}`);
    };
    walk(this.document, '#');
    return found;
  }

  /** The document with the value of every example in place of its file. */
  withExamples() {
    const text = JSON.stringify(this.document, (_, value) => {
      if (!value?.externalValue) return value;
      const {externalValue: name, ...rest} = value;
      const content = readFileSync(join(dirname(this.path), name), 'utf8');
      return {...rest, value: name.endsWith('.json') ? JSON.parse(content) : content};
    });
    return JSON.parse(text);
  }
}

/** The events of a stream as [{id, event, data}]; comments are passed over. */
export function parseEvents(text) {
  const events = [];
  for (const frame of text.split('\n\n')) {
    const fields = frame.split('\n').filter((line) => line && !line.startsWith(':'))
      .map((line) => [line.slice(0, line.indexOf(':')), line.slice(line.indexOf(':') + 1).trim()]);
    if (fields.length === 0) continue;
    const data = fields.filter(([name]) => name === 'data').map(([, value]) => value).join('\n');
    const {id, event} = Object.fromEntries(fields);
    events.push({...(id !== undefined && {id: Number(id)}), event, data: JSON.parse(data)});
  }
  return events;
}

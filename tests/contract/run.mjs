// A run of the contract test: calls operations, lets the contract judge every answer, counts.
import {request} from './http.mjs';

/** What a job that succeeded has to show. */
export const kOutcomes =
    ['getResult', 'getResultAsJson', 'getReport', 'getLayout', 'getLayoutPng', 'getPreview'];

const kNoMesh = '0'.repeat(64);

/** A path of the contract with its parameters filled in. */
export const pathTo = (path, job, sha256 = kNoMesh) =>
  path.replace('{id}', job).replace('{sha256}', sha256);

const kShown = 40;    // failures that are printed in full
const kEchoed = 200;  // characters of a value

export class Run {
  constructor(contract) {
    this.contract = contract;
    this.passed = 0;
    this.failed = 0;
  }

  /** One check: no problem is a pass. */
  expect(name, problems) {
    if (problems.length === 0) {
      this.passed += 1;
      return;
    }
    this.failed += 1;
    if (this.failed > kShown) return;
    console.log(`FAILED ${name}\n  ${problems.slice(0, 5).join('\n  ')}`);
  }

  expectEqual(name, actual, expected) {
    const short = (value) => String(value).slice(0, kEchoed);
    this.expect(name, actual === expected
      ? [] : [`is ${short(actual)}, expected ${short(expected)}`]);
  }

  /** Judges an answer that was fetched in some other way. */
  judge(name, id, answer, status) {
    const problems = this.contract.judge(id, answer);
    if (status !== undefined && answer.status !== status) {
      const said = answer.body?.subarray(0, 300);
      problems.push(`status ${answer.status}, expected ${status}: ${said}`);
    }
    this.expect(`${name} (${id})`, problems);
    return answer;
  }

  /**
   * Calls an operation and judges the answer. job fills the path's {id}, sha256 its {sha256}; query is an object or an
   * array of pairs; status is the one expected.
   */
  async call(base, id, {job, sha256, query = {}, headers, body, status, name = ''} = {}) {
    const {method, path} = this.contract.operation(id);
    const search = new URLSearchParams(query).toString();
    const answer = await request(base, {
      method, headers, body, path: pathTo(path, job, sha256) + (search ? `?${search}` : ''),
    });
    return this.judge(name || `${id} → ${status ?? 'any'}`, id, answer, status);
  }

  /** The same, and the JSON of its body. */
  async json(base, id, options) {
    return JSON.parse((await this.call(base, id, options)).body.toString());
  }
}

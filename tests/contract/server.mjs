// The real binary, on a free port and with a data directory of its own.
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import readline from 'node:readline';

/**
 * Starts unwrapd and resolves, once it has printed its address, to
 * {base, data, pid, terminate, stop}: terminate() only sends SIGTERM, stop() also waits and cleans up.
 */
export async function startServer(binary, flags = []) {
  const data = mkdtempSync(join(tmpdir(), 'unwrapd-contract-'));
  const child = spawn(binary, ['--listen', '127.0.0.1:0', '--data', data, ...flags],
                      {stdio: ['ignore', 'pipe', 'pipe']});
  const log = [];
  child.stderr.on('data', (piece) => log.push(piece));
  const exited = new Promise((resolve) => child.on('exit', resolve));
  const base = await address(child, exited, log);
  const stop = async () => {
    child.kill('SIGTERM');
    const forced = setTimeout(() => child.kill('SIGKILL'), 30_000);
    const code = await exited;
    clearTimeout(forced);
    rmSync(data, {recursive: true, force: true});
    return code;
  };
  return {base, data, pid: child.pid, stop, exited, terminate: () => child.kill('SIGTERM'),
          log: () => Buffer.concat(log).toString()};
}

/** Starts unwrapd, uses it, and stops it whatever came of that. */
export async function withServer(binary, flags, use) {
  const server = await startServer(binary, flags);
  try {
    await use(server);
  } finally {
    await server.stop();
  }
}

async function address(child, exited, log) {
  const lines = readline.createInterface({input: child.stdout});
  const first = new Promise((resolve) => lines.once('line', resolve));
  const failed = exited.then((code) => {
    throw new Error(`unwrapd ended with ${code}: ${Buffer.concat(log)}`);
  });
  const line = await Promise.race([first, failed]);
  failed.catch(() => {});  // it may end later, as it should
  const match = /^unwrapd listening on (http:\/\/\S+)$/.exec(line);
  if (!match) throw new Error(`unwrapd said "${line}" where its address should be`);
  return match[1];
}

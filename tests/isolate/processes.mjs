// The processes of a server, as /proc tells of them.
import {readFileSync, readdirSync} from 'node:fs';
import {setTimeout as sleep} from 'node:timers/promises';

const kPatience = 60_000;
const kWorked = 10;  // hundredths of a second of processor time: several times what a start takes

/** The processes that a process has started and that have not been waited for. */
export function children(pid) {
  return readdirSync(`/proc/${pid}/task`).flatMap((thread) => {
    try {
      return readFileSync(`/proc/${pid}/task/${thread}/children`, 'utf8').split(' ').filter(Boolean);
    } catch (error) {
      if (error.code === 'ENOENT' || error.code === 'ESRCH') return [];  // the thread has ended
      throw error;
    }
  });
}

/** What follows the name in /proc/PID/stat: the state first, which is "Z" also where there is no process. */
function stat(pid) {
  try {
    return readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/^.*\) /s, '').split(' ');
  } catch (error) {
    if (error.code === 'ENOENT' || error.code === 'ESRCH') return ['Z'];
    throw error;
  }
}

/** Whether a process has ended, be it waited for or not. */
export const hasEnded = (pid) => 'ZX'.includes(stat(pid)[0]);

export const niceness = (pid) => Number(stat(pid)[16]);

/** Bytes of memory that a process has to itself. */
export function heldMemory(pid) {
  const [, kilobytes] = /^RssAnon:\s+(\d+) kB$/m.exec(readFileSync(`/proc/${pid}/status`, 'utf8'));
  return 1024 * Number(kilobytes);
}

/** Resolves to what look() finds, once it finds something. */
async function seen(what, look) {
  for (const late = Date.now() + kPatience; Date.now() < late; await sleep(5)) {
    const found = look();
    if (found) return found;
  }
  throw new Error(`There never was ${what}.`);
}

/** Resolves to the worker process of a server that has a job: it has computed, those that wait have not. */
export async function busyWorker(pid) {
  const hasWorked = (child) => Number(stat(child)[11]) + Number(stat(child)[12]) >= kWorked;
  return seen('a process at work', () =>
    children(pid).find((child) => !hasEnded(child) && hasWorked(child)));
}

/** Whether a process has locked itself in. */
function isLockedIn(pid) {
  try {
    return /^Seccomp:\s+2$/m.test(readFileSync(`/proc/${pid}/status`, 'utf8'));
  } catch (error) {
    if (error.code === 'ENOENT' || error.code === 'ESRCH') return false;
    throw error;
  }
}

/** Resolves to the worker processes of an idle server, once so many wait for their jobs and no other is left. */
export async function spares(pid, count) {
  const isReady = (child) => !hasEnded(child) && isLockedIn(child);
  return seen(`${count} processes that wait`, () => {
    const all = children(pid);
    return all.length === count && all.every(isReady) && all;
  });
}

// The address of a job on this page: #job=j_…&name=chair.glb. It survives a reload; the key is not in it.

export interface Place {
  job: string;
  name: string;
}

export function placeOf(hash: string): Place | undefined {
  const words = new URLSearchParams(hash.replace(/^#/, ''));
  const job = words.get('job');
  return job && /^j_[0-9a-f]{32}$/.test(job) ? {job, name: words.get('name') ?? job} : undefined;
}

/** Whether an address wants to name a job, and does not. */
export const isBroken = (hash: string) => hash.startsWith('#job') && !placeOf(hash);

export const hashOf = ({job, name}: Place) => `#${new URLSearchParams({job, name})}`;

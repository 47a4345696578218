/** What each generated client has to bring: the events it saw, and the asset. */
export interface Outcome {
  events: string[];
  asset: Blob;
}

/** The names of the events in a stream, as text. */
export function namesOf(stream: string): string[] {
  return [...stream.matchAll(/^event: (\w+)$/gm)].map(([, name]) => name);
}

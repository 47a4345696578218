/** A file that cannot be shown; the text says why, and what to do. */
export class UnreadableError extends Error {}

import type {Problem} from './types.js';

/** Codes of this package, beside those of the contract's ErrorCode. */
export const UNREACHABLE = 'unreachable';
export const UNEXPECTED_ANSWER = 'unexpected_answer';

/** Whatever went wrong between here and the server, and on it (RFC 9457). */
export class UnwrapdError extends Error {
  override readonly name = 'UnwrapdError';
  /** Stable: one of the contract's ErrorCode, `unreachable` or `unexpected_answer`. */
  readonly code: string;
  /** The HTTP status; 0 without an answer. */
  readonly status: number;
  /** The cause, and what to do about it. */
  readonly detail: string;
  /** The place of the error in the options or the document. */
  readonly pointer: string | undefined;
  /** The id of the job. */
  readonly job: string | undefined;
  /** Seconds after which the server wants the request again. */
  readonly retryAfter: number | undefined;

  constructor(problem: Pick<Problem, 'detail' | 'status' | 'pointer' | 'job'> & {code: string}, retryAfter?: number,
              cause?: unknown) {
    const place = problem.pointer ? `, at ${problem.pointer}` : '';
    super(`${problem.detail} (${problem.code}${place})`, {cause});
    this.code = problem.code;
    this.status = problem.status;
    this.detail = problem.detail;
    this.pointer = problem.pointer;
    this.job = problem.job;
    this.retryAfter = retryAfter;
  }
}

/** The error that an answer tells. */
export async function errorOf(answer: Response): Promise<UnwrapdError> {
  const seconds = Number(answer.headers.get('Retry-After'));
  const text = await answer.text().catch((error: unknown) => {
    throw unreachable(error);
  });
  try {
    const document = JSON.parse(text);
    if (typeof document?.code === 'string') return new UnwrapdError(document, seconds || undefined);
  } catch {
    // no JSON: said below
  }
  return unexpected(answer.status, seconds || undefined);
}

/** An answer that is none of the server's. */
export function unexpected(status: number, retryAfter?: number): UnwrapdError {
  const detail = `Status ${status} is not an answer of unwrapd; check the address.`;
  return new UnwrapdError({code: UNEXPECTED_ANSWER, status, detail}, retryAfter);
}

/** A connection that could not be made, or broke. */
export function unreachable(cause: unknown): UnwrapdError {
  const detail = `The server cannot be reached: ${cause instanceof Error ? cause.message : cause}`;
  return new UnwrapdError({code: UNREACHABLE, status: 0, detail}, undefined, cause);
}

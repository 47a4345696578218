// The call of a job as a command line, and addresses that open without a key.

/** A word for a shell of POSIX. */
const quoted = (text: string) => (/^[\w.:/=@-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

export interface Call {
  server: string;
  options: object;
  /** Name and type of the file that is sent. */
  file: string;
  mediaType: string;
  /** The file's name of what comes back. */
  result: string;
  needsKey: boolean;
  /** Whether the mesh is small enough for one call; else the job is waited for. */
  isSmall: boolean;
}

/** The same job as a command: of one call, or for a larger mesh of a job and its result. */
export function curlOf({server, options, file, mediaType, result, needsKey, isSmall}: Call): string {
  const key = needsKey ? ' -H "Authorization: Bearer $UNWRAPD_KEY"' : '';
  const form = `-F ${quoted(`options=${JSON.stringify(options)};type=application/json`)} -F ${quoted(`mesh=@${file};type=${mediaType}`)}`;
  if (isSmall) return `curl -sS --fail-with-body${key} ${quoted(`${server}/v1/unwrap`)} ${form} -o ${quoted(result)}`;
  const submit = `curl -sS --fail-with-body${key} -H 'Prefer: wait=60' ${quoted(`${server}/v1/jobs`)} ${form}`;
  return `${submit}\n# when its state is succeeded:\ncurl -sS --fail-with-body${key} ${quoted(`${server}/v1/jobs/`)}ID/result -o ${quoted(result)}`;
}

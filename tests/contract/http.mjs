// HTTP as plainly as node has it: one request a connection, the answer as status, headers, bytes.
import http from 'node:http';
import net from 'node:net';

const kPatience = 120_000;  // ms; no answer takes as long unless the server hangs

/** Sends one request; body is a Buffer or undefined. Resolves to {status, headers, body}. */
export function request(base, {method = 'GET', path, headers = {}, body}) {
  return new Promise((resolve, reject) => {
    const options = {method, headers: {...headers}, agent: false, timeout: kPatience};
    const isChunked = 'Transfer-Encoding' in headers;
    if (body !== undefined && !isChunked) options.headers['Content-Length'] ??= body.length;
    const call = http.request(new URL(path, base), options, (answer) => {
      const chunks = [];
      answer.on('data', (piece) => chunks.push(piece));
      answer.on('error', reject);
      answer.on('end', () => resolve(
          {status: answer.statusCode, headers: answer.headers, body: Buffer.concat(chunks)}));
    });
    call.on('timeout', () => call.destroy(new Error(`no answer: ${method} ${path}`)));
    call.on('error', reject);
    call.end(body);
  });
}

/** Opens a stream and leaves it open; resolves to {status, headers, close} with its head. */
export function openStream(base, path) {
  return new Promise((resolve, reject) => {
    const call = http.request(new URL(path, base), {agent: false}, (answer) => {
      answer.on('error', () => {});  // closing the stream ends it in the middle
      answer.resume();
      resolve({status: answer.statusCode, headers: answer.headers, close: () => call.destroy()});
    });
    call.on('error', reject);
    call.end();
  });
}

/** Sends bytes as they are, for requests that no client library would send. */
export function raw(base, text) {
  const {hostname, port} = new URL(base);
  return new Promise((resolve, reject) => {
    const chunks = [];
    const socket = net.connect(Number(port), hostname, () => socket.write(text));
    socket.setTimeout(kPatience, () => socket.destroy(new Error('no answer')));
    socket.on('data', (piece) => chunks.push(piece));
    socket.on('error', (error) => (chunks.length ? resolve(parse(chunks)) : reject(error)));
    socket.on('end', () => resolve(parse(chunks)));
  });
}

function parse(chunks) {
  const bytes = Buffer.concat(chunks);
  const split = bytes.indexOf('\r\n\r\n');
  const [first, ...lines] = bytes.subarray(0, split).toString('latin1').split('\r\n');
  const headers = Object.fromEntries(lines.map((line) => {
    const colon = line.indexOf(':');
    return [line.slice(0, colon).toLowerCase(), line.slice(colon + 1).trim()];
  }));
  return {status: Number(first.split(' ')[1]), headers, body: bytes.subarray(split + 4)};
}

/** A multipart/form-data body of parts {name, filename?, type?, body}. */
export function multipart(parts) {
  const boundary = 'contract-7d1f0c5a';
  const pieces = [];
  for (const {name, filename, type, body} of parts) {
    const file = filename === undefined ? '' : `; filename="${filename}"`;
    const kind = type === undefined ? '' : `Content-Type: ${type}\r\n`;
    pieces.push(Buffer.from(`--${boundary}\r\n` +
        `Content-Disposition: form-data; name="${name}"${file}\r\n${kind}\r\n`));
    pieces.push(Buffer.from(body), Buffer.from('\r\n'));
  }
  pieces.push(Buffer.from(`--${boundary}--\r\n`));
  return {
    headers: {'Content-Type': `multipart/form-data; boundary=${boundary}`},
    body: Buffer.concat(pieces),
  };
}

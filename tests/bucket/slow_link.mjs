// A way to the gateway of an object store that is cut in the middle of a request: the test says of which,
// and after how many bytes of it.
import { connect, createServer } from "node:net";

/** Until close() it passes all on. cutIn(pattern, bytes, act) waits for one request and resolves when act has. */
export async function slowLink(endpoint) {
  const { hostname, port } = new URL(endpoint);
  const open = new Set();
  let wanted;

  /** How many bytes of a piece are passed on; the request that is wanted ends there. */
  const share = (seen, piece) => {
    if (!wanted) return piece.length;
    if (seen.left === undefined) {
      const found = wanted.pattern.exec(piece.toString("latin1"));
      if (!found) return piece.length;
      seen.left = wanted.bytes + found.index;
    }
    const taken = Math.min(seen.left, piece.length);
    seen.left -= taken;
    return taken;
  };
  const server = createServer((client) => {
    const upstream = connect(Number(port), hostname);
    const seen = {};
    for (const socket of [client, upstream]) {
      open.add(socket);
      const end = () => [client, upstream].forEach((each) => open.delete(each.destroy()));
      socket.on("error", end).on("close", end);
    }
    client.on("data", (piece) => {
      if (seen.left === 0) return; // it is cut
      const taken = share(seen, piece);
      upstream.write(piece.subarray(0, taken));
      if (seen.left !== 0) return;
      const { act } = wanted;
      wanted = undefined;
      act().finally(() => [client, upstream].forEach((each) => each.destroy()));
    });
    upstream.pipe(client);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  return {
    endpoint: `http://127.0.0.1:${server.address().port}`,
    cutIn: (pattern, bytes, act) =>
      new Promise((resolve, reject) => {
        wanted = { pattern, bytes, act: () => act().then(resolve, reject) };
      }),
    close() {
      open.forEach((socket) => socket.destroy());
      server.close();
    },
  };
}

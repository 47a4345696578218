// A PostgreSQL server of a test's own, in a temporary folder and on a Unix socket there; and a proxy
// before it that loses what it is told to lose. As root it runs as the user postgres: PostgreSQL
// refuses root.
import { execFileSync } from "node:child_process";
import { appendFileSync, chownSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { connect, createServer } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";

const DEBIAN = "/usr/lib/postgresql";
export const NOT_INSTALLED = "PostgreSQL is not installed (Debian package postgresql)";

/** Makes the table `ends`, which has a row for each end of a job that is committed. */
export const COUNT_ENDS = `
  CREATE TABLE ends (id TEXT);
  CREATE FUNCTION note_end() RETURNS trigger LANGUAGE plpgsql AS
    $$ BEGIN INSERT INTO ends VALUES (NEW.id); RETURN NULL; END $$;
  CREATE TRIGGER ends AFTER UPDATE OF state ON jobs FOR EACH ROW
    WHEN (NEW.state IN ('succeeded', 'failed', 'cancelled'))
    EXECUTE FUNCTION note_end();`;

/** Where its programs are: of the newest version; undefined where there is none. */
function programs() {
  const versions = existsSync(DEBIAN) ? readdirSync(DEBIAN).sort((a, b) => b - a) : [];
  return versions.map((version) => join(DEBIAN, version, "bin")).find((bin) => existsSync(join(bin, "initdb")));
}

export function isInstalled() {
  return programs() !== undefined;
}

const idOf = (flag) => Number(execFileSync("id", [flag, "postgres"], { encoding: "utf8" }));

export class Postgres {
  /**
   * Starts one. sync: false where only processes end, not machines. settings: more of it, by name.
   * from: the primary whose standby it is.
   */
  constructor({ sync = true, settings = {}, from } = {}) {
    this.bin = programs();
    this.settings = settings;
    this.folder = mkdtempSync(join(tmpdir(), "unwrapd-postgres-"));
    this.data = join(this.folder, "data");
    this.user = process.getuid() === 0 ? { uid: idOf("-u"), gid: idOf("-g") } : {};
    this.sync = sync ? "on" : "off";
    if (this.user.uid) chownSync(this.folder, this.user.uid, this.user.gid);
    if (from) this.#copy(from);
    else this.run("initdb", ["-D", this.data, "-U", "postgres", "-A", "trust", "-E", "UTF8", "--locale=C.UTF-8", "--no-sync"]);
    if (settings.listen_addresses) appendFileSync(join(this.data, "pg_hba.conf"), "host all all samenet trust\n");
    this.start();
  }

  run(program, args) {
    const options = { ...this.user, cwd: this.folder, encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] };
    return execFileSync(join(this.bin, program), args, options);
  }

  /** A copy that follows the primary under the name `standby`. */
  #copy(from) {
    const source = `host=${from.folder} user=postgres application_name=standby`;
    this.run("pg_basebackup", ["-D", this.data, "-d", source, "-R", "-X", "stream", "-c", "fast", "--no-sync"]);
  }

  start() {
    const all = { listen_addresses: "", fsync: this.sync, max_connections: 40, ...this.settings };
    const options = [`-k ${this.folder}`, ...Object.entries(all).map(([name, value]) => `-c ${name}=${value}`)].join(" ");
    this.run("pg_ctl", ["-D", this.data, "-l", join(this.folder, "log"), "-o", options, "-w", "-t", "60", "start"]);
  }

  /** As a crash ends it: nothing is said to clients, and the next start recovers. */
  kill() {
    this.run("pg_ctl", ["-D", this.data, "-m", "immediate", "-w", "stop"]);
  }

  /** As its machine ends by a loss of power: all its processes at one moment. */
  loseMachine() {
    const [main] = readFileSync(join(this.data, "postmaster.pid"), "utf8").split("\n");
    const children = execFileSync("pgrep", ["-P", main], { encoding: "utf8" }).trim().split("\n");
    for (const pid of [main, ...children]) process.kill(Number(pid), "SIGKILL");
  }

  /** Makes the primary of what was a standby. */
  promote() {
    this.run("pg_ctl", ["-D", this.data, "-w", "promote"]);
  }

  /** Its URL, or that of another socket in its folder. */
  url(port = 5432) {
    return `postgres://postgres@/postgres?host=${encodeURIComponent(this.folder)}&port=${port}`;
  }

  /** What a query answers: lines of values with | between. */
  query(sql) {
    return this.run("psql", ["-h", this.folder, "-U", "postgres", "-qAtX", "-c", sql, "postgres"]).trim();
  }

  remove() {
    try {
      this.kill();
    } catch {} // it is stopped
    rmSync(this.folder, { recursive: true, force: true });
  }
}

/**
 * A proxy on another port of the server's folder. fate(count) says what becomes of the COMMIT of this
 * number: "pass", "lose" (it never arrives) or "lose answer"; both end the session.
 */
export function commitProxy(postgres, port, fate) {
  let count = 0;
  const server = createServer((client) => {
    const upstream = connect(join(postgres.folder, ".s.PGSQL.5432"));
    let isCut = false;
    const end = () => [client, upstream].forEach((socket) => socket.destroy());
    for (const socket of [client, upstream]) socket.on("error", end).on("close", end);
    client.on("data", (piece) => {
      const what = piece.includes("COMMIT\0") ? fate(++count) : "pass";
      if (what === "lose") return end();
      isCut = what === "lose answer";
      upstream.write(piece);
    });
    upstream.on("data", (piece) => (isCut ? end() : client.write(piece)));
  });
  server.listen(join(postgres.folder, `.s.PGSQL.${port}`));
  return server;
}

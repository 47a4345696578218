"""The Python package against the real server and against one that refuses and breaks off. UNWRAPD is
the server, CLIENT_PACKAGE the folder of the package, or of its wheel's contents."""

import http.server
import json
import math
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path
from types import SimpleNamespace

HERE = Path(__file__).resolve().parent
sys.path.insert(0, os.environ.get("CLIENT_PACKAGE", str(HERE / "../../../client/python")))

from unwrapd import Progress, UnwrapdError, unwrap  # noqa: E402

DATA = Path(os.environ.get("UNWRAPD_TEST_DATA", HERE / "../../../../shared/data"))
USUAL = ["--admin-listen", "off", "--workers", "1", "--log-level", "off"]
FILES = [
    "disk/tiny_square.obj", "disk/hand_lowres.obj", "paper/Balls.obj", "paper/Isis_dABF.obj",
    "closed/spot_control_mesh.obj", "gltf/pmndrs/bunny.glb", "gltf/gltfrs/tests/box_sparse.glb", "gltf/tinygltf/models/box01.glb",
    "gltf/gltfpipeline/2.0/box-morph/box-morph.gltf", "gltf/blenderio/tests/roundtrip/02_node_hierarchy/02_node_hierarchy.gltf",
]


def grid(size: int) -> tuple[list[tuple[float, float, float]], list[tuple[int, int, int]]]:
    """A bumpy square of size by size cells."""
    steps = [k / size for k in range(size + 1)]
    vertices = [(x, y, 0.3 * math.sin(5 * x) * math.cos(4 * y)) for y in steps for x in steps]
    faces = []
    for row in range(size):
        for a in range(row * (size + 1), row * (size + 1) + size):
            b, c, d = a + 1, a + size + 2, a + size + 1
            faces += [(a, b, c), (a, c, d)]
    return vertices, faces


def obj(size: int) -> bytes:
    vertices, faces = grid(size)
    lines = [f"v {x} {y} {z}" for x, y, z in vertices] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    return ("\n".join(lines) + "\n").encode()


class Server:
    """The real server on a port of its own, which can be killed and started again."""

    def __init__(self, *flags: str) -> None:
        self._flags, self._data = flags, tempfile.mkdtemp(prefix="unwrapd-client-")
        with socket.create_server(("127.0.0.1", 0)) as probe:
            self._listen = f"127.0.0.1:{probe.getsockname()[1]}"
        self.base = f"http://{self._listen}"
        self.start()

    def start(self) -> None:
        words = [os.environ["UNWRAPD"], "--listen", self._listen, "--data", self._data, *self._flags, *USUAL]
        self._process = subprocess.Popen(words, stdout=subprocess.PIPE)
        assert self._process.stdout
        self._process.stdout.readline()

    def kill(self) -> None:
        self._process.send_signal(signal.SIGKILL)
        self._process.wait()
        assert self._process.stdout
        self._process.stdout.close()

    def end(self) -> None:
        self.kill()
        shutil.rmtree(self._data, ignore_errors=True)

    def jobs(self) -> list[dict]:
        words = ["curl", "-sSf", f"{self.base}/v1/jobs?limit=200"]
        return json.loads(subprocess.check_output(words))["jobs"]


class RealServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.server = Server()

    @classmethod
    def tearDownClass(cls) -> None:
        cls.server.end()

    def by_curl(self, path: Path) -> bytes:
        """What curl gets for a file, computed anew."""
        parts = ["-F", f"mesh=@{path}", "-F", 'options={"preset":"paper"};type=application/json']
        if path.suffix == ".gltf":
            for buffer in json.loads(path.read_text())["buffers"]:
                if not buffer["uri"].startswith("data:"):
                    parts += ["-F", f"buffer=@{path.parent / buffer['uri']};filename={buffer['uri']}"]
        words = ["curl", "-sSf", "-H", "Cache-Control: no-cache", *parts, f"{self.server.base}/v1/unwrap"]
        return subprocess.check_output(words)

    @unittest.skipUnless(DATA.exists(), f"there is no {DATA}")
    def test_ten_files_come_back_as_curl_gets_them(self) -> None:
        for path in (DATA / name for name in FILES):
            done = unwrap(path, {"preset": "paper"}, server=self.server.base)
            self.assertEqual(done.asset, self.by_curl(path), path)
            self.assertEqual((done.job["state"], done.report["options"]["preset"]), ("succeeded", "paper"))
            self.assertIsNone(done.mesh)

    def test_a_job_outlives_the_server_that_is_killed_under_it(self) -> None:
        seen: list[Progress] = []

        def kill(progress: Progress) -> None:
            if progress.event == "iteration" and not any(one.event == "iteration" for one in seen):
                self.server.kill()
                self.server.start()
            seen.append(progress)

        options = {"preset": "chart", "stop": {"iterations": 401}}
        done = unwrap(obj(60), options, server=self.server.base, on_progress=kill, name="Stühle")
        self.assertIn(b"\nvt ", done.asset)
        self.assertEqual((done.job["attempt"], done.job["name"]), (2, "Stühle"))
        self.assertEqual([one.data["attempt"] for one in seen if one.event == "started"], [1, 2])
        fractions = [one.fraction for one in seen]
        self.assertEqual(fractions, sorted(fractions))
        self.assertEqual(fractions[-1], 1)
        mine = [job for job in self.server.jobs() if job["options"]["stop"]["iterations"] == 401]
        self.assertEqual(len(mine), 1)

    def test_a_refusal_has_code_pointer_detail_and_status(self) -> None:
        with self.assertRaises(UnwrapdError) as refused:
            unwrap(obj(2), {"method": "magic"}, server=self.server.base)
        error = refused.exception
        self.assertEqual((error.code, error.pointer, error.status), ("invalid_option", "/method", 422))
        self.assertGreater(len(error.detail), 10)
        with self.assertRaises(UnwrapdError) as failed:
            unwrap(b"v 0 0 0\nf 1 2 3\n", server=self.server.base)
        self.assertEqual((failed.exception.code, failed.exception.status), ("malformed_obj", 400))
        self.assertRegex(failed.exception.job or "", "^j_")
        with self.assertRaises(UnwrapdError) as nobody:
            unwrap(obj(2), server="http://127.0.0.1:1", retries=1)
        self.assertEqual((nobody.exception.code, nobody.exception.status), ("unreachable", 0))
        with self.assertRaises(FileNotFoundError):
            unwrap("no/such/file.obj", server=self.server.base)
        with tempfile.TemporaryDirectory() as folder:
            for text in ("{", "[]", '{"buffers": 1}'):
                (file := Path(folder) / "broken.gltf").write_text(text)
                with self.assertRaisesRegex(UnwrapdError, "malformed_|unknown_format"):
                    unwrap(file, server=self.server.base)

    def test_what_on_progress_raises_cancels_the_job(self) -> None:
        def stop(progress: Progress) -> None:
            if progress.event == "iteration":
                raise ConnectionError("enough")

        with self.assertRaisesRegex(ConnectionError, "enough"):
            endless = {"preset": "chart", "stop": {"iterations": 10000}}
            unwrap(obj(100), endless, server=self.server.base, on_progress=stop)
        give_up = time.monotonic() + 20
        while (state := self.server.jobs()[0]["state"]) == "running" and time.monotonic() < give_up:
            time.sleep(0.05)
        self.assertEqual(state, "cancelled")

    def test_a_mesh_comes_back_as_a_mesh(self) -> None:
        vertices, faces = grid(5)
        mesh = unwrap(SimpleNamespace(vertices=vertices, faces=faces), server=self.server.base).mesh
        assert mesh
        for t, face in enumerate(faces):
            self.assertEqual(tuple(int(mesh.sources[v]) for v in mesh.faces[t]), face)
            (a, b, c) = ((float(mesh.uv[v][0]), float(mesh.uv[v][1])) for v in mesh.faces[t])
            self.assertGreater((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]), 0)
        for place, source in zip(mesh.vertices, mesh.sources, strict=True):
            for mine, given in zip(place, vertices[int(source)], strict=True):
                self.assertAlmostEqual(float(mine), given, places=6)

    def test_the_example_does_what_it_says(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "in.obj").write_bytes(obj(4))
            example = HERE / "../../../client/python/examples/unwrap_file.py"
            environment = {**os.environ, "UNWRAPD_SERVER": self.server.base, "PYTHONPATH": sys.path[0]}
            words = [sys.executable, str(example), "in.obj", "out.obj"]
            run = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=True)
            self.assertRegex(run.stdout, r"^\d+ charts, D_angle 2\.\d+\n$")
            self.assertIn("100 % succeeded", run.stderr)
            self.assertIn(b"\nvt ", (Path(folder) / "out.obj").read_bytes())


JOB = {
    "id": "j_0123456789abcdef", "state": "running",
    "links": {name: f"/v1/jobs/j_0123456789abcdef/{name}" for name in ("self", "events", "result", "report")},
}
DONE = {**JOB, "state": "succeeded"}


def frame(identity: int, name: str, data: object) -> bytes:
    lines = json.dumps(data, indent=1).replace("\n", "\ndata: ")  # as the standard allows
    return f"id: {identity}\nevent: {name}\ndata: {lines}\n\n".encode()


def busy(code: str, status: int) -> tuple[int, dict, bytes]:
    problem = {"title": code, "status": status, "detail": "Because.", "code": code}
    return status, {"Retry-After": "1"}, json.dumps(problem).encode()


class FakeServer(unittest.TestCase):
    """A server whose answers a test writes: path -> the list of its answers, the last one for good. An
    answer is (status, headers, body); one that is None, or promises more bytes, breaks off."""

    def unwrap_by(self, answers: dict[str, list], **settings: object) -> tuple[object, list]:
        usual = {
            "/v1/jobs": [(202, {}, json.dumps(JOB).encode())],
            JOB["links"]["events"]: [(200, {}, frame(1, "succeeded", DONE))],
            JOB["links"]["report"]: [(200, {}, b"{}")],
            JOB["links"]["result"]: [(200, {}, b"asset")],
        }
        script = {path: list(each) for path, each in {**usual, **answers}.items()}
        seen: list[tuple[str, dict, float]] = []

        class Handler(http.server.BaseHTTPRequestHandler):
            def answer(self) -> None:
                self.rfile.read(int(self.headers.get("Content-Length", 0)))
                seen.append((self.path, dict(self.headers), time.monotonic()))
                left = script[self.path]
                said = left.pop(0) if len(left) > 1 else left[0]
                self.close_connection = True
                if said is None:
                    return
                status, headers, body = said
                self.send_response(status)
                for name, value in {"Content-Length": str(len(body)), **headers}.items():
                    self.send_header(name, value)
                self.end_headers()
                self.wfile.write(body)

            do_GET = do_POST = answer

            def log_message(self, *_: object) -> None: ...
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        try:
            done = unwrap(b"v 0 0 0", server=f"http://127.0.0.1:{server.server_port}/", **settings)
        finally:
            server.shutdown()
            server.server_close()
        return done, seen

    def heads(self, seen: list, path: str, name: str) -> list:
        return [headers.get(name) for where, headers, _ in seen if where == path]

    def test_a_full_queue_is_asked_again_after_retry_after_by_the_same_name(self) -> None:
        _, seen = self.unwrap_by({"/v1/jobs": [busy("queue_full", 429), (202, {}, json.dumps(JOB).encode())]})
        times = [at for where, _, at in seen if where == "/v1/jobs"]
        self.assertEqual(len(times), 2)
        self.assertGreaterEqual(times[1] - times[0], 1)
        first, second = self.heads(seen, "/v1/jobs", "Idempotency-Key")
        self.assertEqual(first, second)
        self.assertGreater(len(first), 10)

    def test_an_answer_that_is_lost_is_asked_for_again(self) -> None:
        _, seen = self.unwrap_by({"/v1/jobs": [None, None, (202, {}, json.dumps(JOB).encode())]}, idempotency_key="mine")
        self.assertEqual(self.heads(seen, "/v1/jobs", "Idempotency-Key"), ["mine"] * 3)

    def test_events_continue_after_the_last_one_that_arrived(self) -> None:
        broken = b": a comment\n\n" + frame(6, "queued", {"position": 0}) + frame(7, "stage", {"fraction": 0.5})
        told, events = [], JOB["links"]["events"]
        _, seen = self.unwrap_by(
            {events: [(200, {"Content-Length": "999"}, broken), (200, {}, frame(8, "succeeded", DONE))]},
            on_progress=lambda progress: told.append((progress.event, progress.fraction)),
        )
        self.assertEqual(self.heads(seen, events, "Last-Event-ID"), [None, "7"])
        self.assertEqual(told, [("queued", 0), ("stage", 0.5), ("succeeded", 1)])

    def test_without_a_stream_the_state_is_asked_for(self) -> None:
        states = [(200, {}, json.dumps(state).encode()) for state in (JOB, DONE)]
        answers = {JOB["links"]["events"]: [busy("too_many_streams", 503)], JOB["links"]["self"]: states}
        _, seen = self.unwrap_by(answers, retries=1)
        self.assertEqual(len(self.heads(seen, JOB["links"]["self"], "Accept")), 2)

    def test_a_download_that_breaks_off_begins_anew(self) -> None:
        result = JOB["links"]["result"]
        done, seen = self.unwrap_by({result: [(200, {"Content-Length": "5"}, b"ass"), (200, {}, b"asset")]}, key="secret")
        self.assertEqual(done.asset, b"asset")
        self.assertEqual(self.heads(seen, result, "Authorization"), ["Bearer secret"] * 2)

    def test_patience_ends(self) -> None:
        with self.assertRaises(UnwrapdError) as full:
            self.unwrap_by({"/v1/jobs": [busy("queue_full", 429)]}, retries=1)
        self.assertEqual((full.exception.code, full.exception.retry_after), ("queue_full", 1))
        for status in (404, 200):
            with self.assertRaises(UnwrapdError) as other:
                self.unwrap_by({"/v1/jobs": [(status, {}, b"<html>")]})
            self.assertEqual((other.exception.code, other.exception.status), ("unexpected_answer", status))

    def test_what_the_caller_got_wrong_is_no_failure_of_the_network(self) -> None:
        for wrong, given, server in ((IsADirectoryError, "/", "http://127.0.0.1:1"), (ValueError, b"v", "localhost:8080")):
            self.assertRaises(wrong, unwrap, given, server=server)


if __name__ == "__main__":
    unittest.main()

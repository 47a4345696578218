"""Redirects of downloads: they are followed, and the key is sent to the server's own origin alone."""

import http.server
import os
import sys
import threading
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, os.environ.get("CLIENT_PACKAGE", str(HERE / "../../../client/python")))

from unwrapd import UnwrapdError  # noqa: E402
from unwrapd.connection import Connection  # noqa: E402


class Redirects(unittest.TestCase):
    def start(self, locations: dict[str, str]) -> tuple[str, list]:
        """A server that redirects these paths, and answers others by their names."""
        seen: list[tuple[str, str | None, str | None]] = []

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                seen.append((self.path, self.headers.get("Authorization"), self.headers.get("Accept")))
                location = locations.get(self.path)
                self.send_response(307 if location else 200)
                if location:
                    self.send_header("Location", location)
                body = b"" if location else self.path.encode()
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            do_POST = do_GET

            def log_message(self, *_: object) -> None: ...

        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        return f"http://127.0.0.1:{server.server_port}", seen

    def get(self, server: str, path: str, method: str = "GET") -> bytes:
        with Connection(server, "secret").call(method, path, {"Accept": "model/obj"}) as answer:
            return answer.read()

    def test_another_origin_gets_no_key(self) -> None:
        bucket, at_bucket = self.start({})
        server, at_server = self.start({"/r": "/moved", "/moved": f"{bucket}/o?s=a%2Fb#c"})
        self.assertEqual(self.get(server, "/r"), b"/o?s=a%2Fb")
        self.assertEqual(at_bucket, [("/o?s=a%2Fb", None, "model/obj")])
        self.assertEqual([key for _, key, _ in at_server], ["Bearer secret"] * 2)

    def test_redirects_end(self) -> None:
        server, seen = self.start({"/r": "/r", "/f": "ftp://127.0.0.1/f"})
        for method, path, calls, code in (("GET", "/r", 6, "unexpected_answer"), ("POST", "/r", 1, "unexpected_answer"), ("GET", "/f", 1, "unreachable")):
            seen.clear()
            with self.assertRaises(UnwrapdError) as refused:
                self.get(server, path, method)
            self.assertEqual((len(seen), refused.exception.code), (calls, code), path)


if __name__ == "__main__":
    unittest.main()

"""unwrap() of an address, which the server reads."""

import functools
import http.server
import threading
import unittest
from pathlib import Path
from tempfile import TemporaryDirectory

from client_test import Server, UnwrapdError, obj, unwrap


class Sources(unittest.TestCase):
    def setUp(self) -> None:
        folder = self.enterContext(TemporaryDirectory())
        Path(folder, "grid.obj").write_bytes(obj(4))

        class Handler(http.server.SimpleHTTPRequestHandler):
            def log_message(self, *_: object) -> None:
                pass

        files = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=folder))
        serving = threading.Thread(target=files.serve_forever)
        serving.start()
        self.addCleanup(files.server_close)
        self.addCleanup(serving.join)
        self.addCleanup(files.shutdown)
        self.address = f"http://localhost:{files.server_port}/"

    def test_an_address_gives_what_its_bytes_give(self) -> None:
        server = Server("--source-hosts", "localhost", "--source-private", "--source-http")
        self.addCleanup(server.kill)
        by_bytes = unwrap(obj(4), {"preset": "chart"}, server=server.base)
        done = unwrap(self.address + "grid.obj", {"preset": "chart"}, server=server.base, name="Far away")
        self.assertEqual(done.asset, by_bytes.asset)
        self.assertEqual(done.job["name"], "Far away")
        with self.assertRaises(UnwrapdError) as caught:
            unwrap(self.address + "none.obj", server=server.base)
        self.assertEqual((caught.exception.code, caught.exception.pointer), ("source_failed", "/source"))

    def test_a_server_that_reads_no_addresses_says_so(self) -> None:
        server = Server()
        self.addCleanup(server.kill)
        with self.assertRaises(UnwrapdError) as caught:
            unwrap(self.address + "grid.obj", server=server.base)
        self.assertEqual(caught.exception.code, "source_refused")


if __name__ == "__main__":
    unittest.main()

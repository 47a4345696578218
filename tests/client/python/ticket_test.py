"""Upload tickets by the Python package, against the real server."""

import unittest
from types import SimpleNamespace

from client_test import Server, UnwrapdError, grid, obj, unwrap
from unwrapd import upload_tickets


class Tickets(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.server = Server()

    @classmethod
    def tearDownClass(cls) -> None:
        cls.server.end()

    def test_a_ticket_takes_a_mesh_in_place_of_a_key_once(self) -> None:
        first, second = upload_tickets(server=self.server.base, seconds=60, max_bytes=1_000_000, count=2)
        done = unwrap(obj(3), server=self.server.base, ticket=first)
        self.assertIn(b"\nvt ", done.asset)
        self.assertIn("signature=", done.job["links"]["result"])
        with self.assertRaises(UnwrapdError) as spent:
            unwrap(obj(2), server=self.server.base, ticket=first)
        self.assertEqual(spent.exception.code, "idempotency_conflict")
        vertices, faces = grid(2)
        mesh = unwrap(SimpleNamespace(vertices=vertices, faces=faces), server=self.server.base, ticket=second).mesh
        assert mesh
        self.assertEqual(len(mesh.faces), len(faces))

    def test_its_terms_are_bounded(self) -> None:
        with self.assertRaises(UnwrapdError) as refused:
            upload_tickets(server=self.server.base, seconds=100_000)
        self.assertEqual((refused.exception.code, refused.exception.pointer), ("invalid_option", "/seconds"))


if __name__ == "__main__":
    unittest.main()

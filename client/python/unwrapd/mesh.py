"""Plain triangles as a GLB for the server, and its answer as plain triangles."""

from __future__ import annotations

import itertools
import json
import struct
import sys
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

try:
    import numpy
except ImportError:  # lists take its place
    numpy = None  # type: ignore[assignment]


@runtime_checkable
class MeshLike(Protocol):
    """What has vertices (n by 3) and triangles (m by 3), as a trimesh.Trimesh: arrays or lists."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...


@dataclass(frozen=True)
class MappedMesh:
    """Triangles whose vertices are duplicated along seams: arrays of numpy where it is, else lists.

    uv: u, v of each vertex; V points up. sources: the vertex of the input that each is or duplicates.
    """

    vertices: Any
    faces: Any
    uv: Any
    sources: Any


def _packed(kind: str, rows: Sequence[Sequence[float]]) -> array[Any]:
    values = array(kind, itertools.chain.from_iterable(rows))
    if sys.byteorder == "big":
        values.byteswap()
    return values


def _extent(vertices: Sequence[Sequence[float]]) -> dict[str, list[float]]:
    floats = [struct.unpack("<3f", struct.pack("<3f", *vertex)) for vertex in vertices]
    columns = list(zip(*floats, strict=True)) or [(0.0,)] * 3
    return {"min": [min(column) for column in columns], "max": [max(column) for column in columns]}


def glb_of(mesh: MeshLike) -> bytes:
    """A GLB with this mesh."""
    positions, indices = _packed("f", mesh.vertices).tobytes(), _packed("I", mesh.faces).tobytes()
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(positions) + len(indices)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices)},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(positions) // 12, **_extent(mesh.vertices)},
            {"bufferView": 1, "componentType": 5125, "type": "SCALAR", "count": len(indices) // 4},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data = positions + indices
    head = struct.pack("<5I", 0x46546C67, 2, 28 + len(text) + len(data), len(text), 0x4E4F534A)
    return head + text + struct.pack("<2I", len(data), 0x004E4942) + data


def _rows(values: list[Any], width: int, kind: str) -> Any:
    if numpy is not None:
        table = numpy.array(values, dtype=kind)
        return table.reshape(-1, width) if width > 1 else table
    return list(zip(*[iter(values)] * width, strict=True)) if width > 1 else values


def mapped(result: dict[str, Any]) -> MappedMesh:
    """The one mesh of a result."""
    mesh = result["meshes"][0]
    return MappedMesh(
        _rows(mesh["positions"], 3, "f8"),
        _rows(mesh["faces"], 3, "i8"),
        _rows(mesh["uv"], 2, "f8"),
        _rows(mesh["vertex_map"], 1, "i8"),
    )

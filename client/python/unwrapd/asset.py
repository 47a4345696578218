"""The request that sends an asset: a form, whose files are read as they are sent, or JSON with its address."""

from __future__ import annotations

import json
import os
import secrets
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote

PIECE = 1 << 20


@dataclass(frozen=True)
class Asset:
    """A mesh and the files beside it, by the URIs by which a .gltf names them."""

    mesh: Path | bytes
    buffers: Mapping[str, Path] = field(default_factory=dict)


def asset_at(path: Path) -> Asset:
    """The asset in a file, with the buffers and images of a .gltf that lie in its folder or below."""
    if path.suffix.lower() != ".gltf":
        return Asset(path)
    folder = path.parent.resolve()
    try:
        document = json.loads(path.read_bytes())
        named = [part.get("uri", "") for part in [*document.get("buffers", []), *document.get("images", [])]]
    except (ValueError, AttributeError, TypeError):
        return Asset(path)  # the server says what is wrong with it
    beside = {uri: (folder / unquote(uri)).resolve() for uri in named if uri and not uri.startswith("data:")}
    return Asset(path, {uri: file for uri, file in beside.items() if file.is_relative_to(folder) and file.is_file()})


def _size(part: Path | bytes) -> int:
    if isinstance(part, bytes):
        return len(part)
    with part.open("rb") as file:  # what cannot be read is the caller's error, not the network's
        return os.fstat(file.fileno()).st_size


class Form:
    """A multipart/form-data body. It can be read again for another attempt."""

    def __init__(self, asset: Asset, options: Mapping[str, Any], name: str | None = None) -> None:
        self._boundary = f"unwrapd-{secrets.token_hex(16)}"
        parts: list[Path | bytes] = []
        parts += [self._head('name="options"', "application/json"), json.dumps(options).encode()]
        if name is not None:
            parts += [self._head('name="name"', "text/plain; charset=utf-8"), name.encode()]
        parts += [self._head('name="mesh"', "application/octet-stream"), asset.mesh]
        for uri, file in asset.buffers.items():
            name = uri.replace('"', "%22").replace("\r", "%0D").replace("\n", "%0A")
            parts += [self._head(f'name="buffer"; filename="{name}"', "application/octet-stream"), file]
        self._parts = [*parts, f"\r\n--{self._boundary}--\r\n".encode()]

    def _head(self, disposition: str, kind: str) -> bytes:
        lines = f"\r\n--{self._boundary}\r\nContent-Disposition: form-data; {disposition}\r\nContent-Type: {kind}\r\n\r\n"
        return lines.encode()

    def headers(self) -> dict[str, str]:
        length = sum(_size(part) for part in self._parts)
        return {
            "Content-Type": f"multipart/form-data; boundary={self._boundary}",
            "Content-Length": str(length),
        }

    def __iter__(self) -> Iterator[bytes]:
        for part in self._parts:
            if isinstance(part, bytes):
                yield part
                continue
            with part.open("rb") as file:
                while piece := file.read(PIECE):
                    yield piece


class SourceText:
    """A JSON body that names the asset by its address, from which the server reads it."""

    def __init__(self, address: str, options: Mapping[str, Any], name: str | None = None) -> None:
        named = {} if name is None else {"name": name}
        self._bytes = json.dumps({"source": address, "options": options, **named}).encode()

    def headers(self) -> dict[str, str]:
        return {"Content-Type": "application/json", "Content-Length": str(len(self._bytes))}

    def __iter__(self) -> Iterator[bytes]:
        yield self._bytes

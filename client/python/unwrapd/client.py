"""The front door: one call from a mesh to the mesh with its texture coordinates."""

from __future__ import annotations

import os
import uuid
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from .asset import Asset, Form, SourceText, asset_at
from .connection import Connection, default_server, patiently, read
from .job import OK, Job, OnProgress, download, json_of, run_job
from .mesh import MappedMesh, MeshLike, glb_of, mapped


@dataclass(frozen=True)
class Unwrapped:
    """asset: the bytes of the result; mesh: its triangles, where a mesh was given."""

    asset: bytes
    report: dict[str, Any]
    job: Job
    mesh: MappedMesh | None = None


def _asset_of(given: str | os.PathLike[str] | bytes | MeshLike) -> Asset:
    if isinstance(given, bytes | bytearray | memoryview):
        return Asset(bytes(given))
    if isinstance(given, str | os.PathLike):
        return asset_at(Path(given))
    return Asset(glb_of(given))


def _is_address(given: object) -> bool:
    return isinstance(given, str) and given.lower().startswith(("https://", "http://"))


def unwrap(
    asset: str | os.PathLike[str] | bytes | MeshLike,
    options: Mapping[str, Any] | None = None,
    *,
    server: str | None = None,
    key: str | None = None,
    on_progress: OnProgress | None = None,
    retries: int = 10,
    idempotency_key: str | None = None,
    name: str | None = None,
    ticket: str | None = None,
) -> Unwrapped:
    """Unwraps an asset: the path or the bytes of a glTF, OBJ, STL, PLY or OFF, its address (https://),
    from which the server reads it where its operator allows the host, or a mesh with vertices and
    faces, such as a trimesh.Trimesh.

    options: those of docs/options.md. server: its address; default: UNWRAPD_SERVER, else
    http://127.0.0.1:8080. key: an API key. retries: failures in a row, of the connection or for want
    of room, before the call fails. idempotency_key: names the request, so that it can be sent again.
    name: of the job for people, up to 200 characters. ticket: in place of a key, a URL of
    upload_tickets(), which takes one job. Raises UnwrapdError, and OSError for a file that cannot be read.
    """
    connection = Connection(server or default_server(), key, retries)
    if _is_address(asset):
        form: Form | SourceText = SourceText(str(asset), options or {}, name)
    else:
        form = Form(_asset_of(asset), options or {}, name)
    job = run_job(connection, form, idempotency_key or str(uuid.uuid4()), on_progress, ticket or "/v1/jobs")
    links = job["links"]
    report = json_of(OK, download(connection, links["report"]))
    mesh = None
    if not isinstance(asset, str | os.PathLike | bytes | bytearray | memoryview):
        mesh = mapped(json_of(OK, download(connection, links["result"], {"Accept": "application/json"})))
    return Unwrapped(download(connection, links["result"]), report, job, mesh)


def upload_tickets(
    *,
    server: str | None = None,
    key: str | None = None,
    seconds: int = 900,
    max_bytes: int | None = None,
    count: int = 1,
    retries: int = 10,
) -> list[str]:
    """Tickets for those without a key: each takes one job, of at most max_bytes, for the key's holder.

    A page sends its form to the URL; unwrap() takes it as ticket. Raises UnwrapdError.
    """
    connection = Connection(server or default_server(), key, retries)
    terms: dict[str, int] = {"seconds": seconds, "count": count}
    if max_bytes is not None:
        terms["max_bytes"] = max_bytes

    def attempt() -> list[str]:
        with connection.call("POST", "/v1/tickets?" + urlencode(terms), {"Content-Length": "0"}) as answer:
            return list(json_of(answer.status, read(answer))["urls"])

    return patiently(connection, attempt)

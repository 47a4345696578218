"""Texture coordinates for triangle meshes from a server of unwrapd."""

from .client import Unwrapped, unwrap, upload_tickets
from .error import UnwrapdError
from .job import Progress
from .mesh import MappedMesh, MeshLike

__all__ = ["MappedMesh", "MeshLike", "Progress", "Unwrapped", "UnwrapdError", "unwrap", "upload_tickets"]

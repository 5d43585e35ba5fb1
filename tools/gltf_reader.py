"""Reads the parts of a glTF 2.0 file that the comparison tools need.

Independent of the renderer's own loader, and without its checks: the files are
our own scenes. Everything is returned in world space, in double precision.
"""

import base64
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

import numpy as np

COMPONENTS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


@dataclass
class Node:
    """A node of the scene and where it is."""

    data: dict
    world_from_object: np.ndarray


@dataclass
class Triangles:
    """A mesh primitive in object space; `normals` is None for flat shading."""

    positions: np.ndarray
    normals: np.ndarray | None
    indices: np.ndarray


class Gltf:
    """A glTF file with its buffers."""

    def __init__(self, path):
        self.path = Path(path)
        raw = self.path.read_bytes()
        binary = None
        if raw[:4] == b"glTF":
            json_length = struct.unpack_from("<I", raw, 12)[0]
            binary = raw[20 + json_length + 8:]
            raw = raw[20:20 + json_length]
        self.root = json.loads(raw)
        self.buffers = [self._buffer(b, binary) for b in self.root.get("buffers", [])]

    def _buffer(self, buffer, binary):
        uri = buffer.get("uri")
        if uri is None:
            return binary
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.path.parent / unquote(uri)).read_bytes()

    def accessor(self, index):
        """The values of an accessor, one row per element; normalised integers become floats."""
        accessor = self.root["accessors"][index]
        if "sparse" in accessor:
            raise ValueError(f"{self.path}: accessor {index} is sparse, which this tool does not read")
        dtype = np.dtype(COMPONENTS[accessor["componentType"]]).newbyteorder("<")
        width, count = WIDTHS[accessor["type"]], accessor["count"]
        view = self.root["bufferViews"][accessor["bufferView"]]
        offset = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        stride = view.get("byteStride", dtype.itemsize * width)
        values = np.ndarray((count, width), dtype, self.buffers[view["buffer"]], offset, (stride, dtype.itemsize))
        if accessor.get("normalized"):
            return np.maximum(values / float(np.iinfo(dtype).max), -1.0)
        return values.copy()

    def scene(self):
        """The default scene's JSON object."""
        return self.root["scenes"][self.root.get("scene", 0)]

    def nodes(self):
        """All nodes of the default scene with their world transforms, in the order of their index."""
        found = []

        def visit(index, world_from_parent):
            data = self.root["nodes"][index]
            world_from_object = world_from_parent @ local_transform(data)
            found.append((index, Node(data, world_from_object)))
            for child in data.get("children", []):
                visit(child, world_from_object)

        for index in self.scene()["nodes"]:
            visit(index, np.eye(4))
        return [node for _, node in sorted(found, key=lambda pair: pair[0])]

    def triangles(self, primitive):
        """The triangles of a mesh primitive; None if it has none."""
        if primitive.get("mode", 4) != 4:
            return None
        attributes = primitive["attributes"]
        positions = self.accessor(attributes["POSITION"]).astype(np.float64)
        normals = self.accessor(attributes["NORMAL"]).astype(np.float64) if "NORMAL" in attributes else None
        if "indices" in primitive:
            indices = self.accessor(primitive["indices"]).reshape(-1, 3).astype(np.int64)
        else:
            indices = np.arange(len(positions)).reshape(-1, 3)
        return Triangles(positions, normals, indices)


def local_transform(node):
    """parent_from_node as a 4x4 matrix that multiplies columns."""
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    x, y, z, w = np.array(node.get("rotation", [0, 0, 0, 1]), dtype=np.float64) / np.linalg.norm(
        node.get("rotation", [0, 0, 0, 1])
    )
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] = matrix[:3, :3] @ np.diag(node.get("scale", [1, 1, 1]))
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix

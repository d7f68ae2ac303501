"""glTF files as triangles, and what a camera sees of them: brute force with numpy, independent of the
program.

In: a .gltf or .glb file. Out: its triangles in world space as (n, 3, 3) float64; depth images.
Knows sparse and quantized accessors, skins, morph targets, strips, fans and EXT_mesh_gpu_instancing;
no compression.
"""

from __future__ import annotations

import base64
import json
import pathlib
import urllib.parse
from typing import Any, Dict, List, Tuple

import numpy
from numpy.typing import NDArray

Array = NDArray[numpy.float64]

KINDS = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}
SIZES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class Gltf:
    def __init__(self, path: pathlib.Path) -> None:
        data = path.read_bytes()
        self.chunk = b""
        if data[:4] == b"glTF":
            length = int.from_bytes(data[12:16], "little")
            self.json: Dict[str, Any] = json.loads(data[20 : 20 + length])
            self.chunk = data[20 + length + 8 :]
        else:
            self.json = json.loads(data.decode("utf-8-sig"))
        self.folder = path.parent

    def buffer(self, index: int) -> bytes:
        uri = self.json["buffers"][index].get("uri")
        if uri is None:
            return self.chunk
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.folder / urllib.parse.unquote(uri)).read_bytes()

    def elements(
        self, where: Dict[str, Any], count: int, kind: str, size: int
    ) -> "NDArray[Any]":
        view = self.json["bufferViews"][where["bufferView"]]
        data = self.buffer(view["buffer"])
        element = numpy.dtype(kind).itemsize * size
        stride = view.get("byteStride", element)
        start = view.get("byteOffset", 0) + where.get("byteOffset", 0)
        if stride == element:
            whole = numpy.frombuffer(data, "<" + kind, count * size, start)
            return whole.reshape(count, size)
        rows = [
            numpy.frombuffer(data, "<" + kind, size, start + i * stride) for i in range(count)
        ]
        return numpy.array(rows).reshape(count, size)

    def accessor(self, index: int) -> Array:
        item = self.json["accessors"][index]
        kind, size, count = KINDS[item["componentType"]], SIZES[item["type"]], item["count"]
        values: "NDArray[Any]" = numpy.zeros((count, size), kind)
        if "bufferView" in item:
            values = self.elements(item, count, kind, size)
        if "sparse" in item:
            values = values.copy()
            sparse = item["sparse"]
            places = self.elements(
                sparse["indices"], sparse["count"], KINDS[sparse["indices"]["componentType"]], 1
            )
            values[places[:, 0]] = self.elements(sparse["values"], sparse["count"], kind, size)
        result = values.astype(numpy.float64)
        if item.get("normalized"):
            result = numpy.maximum(result / numpy.iinfo(kind).max, -1.0)
        return result

    def local(self, node: Dict[str, Any]) -> Array:
        if "matrix" in node:
            return numpy.array(node["matrix"], float).reshape(4, 4).T
        return transform(
            node.get("translation", (0, 0, 0)),
            node.get("rotation", (0, 0, 0, 1)),
            node.get("scale", (1, 1, 1)),
        )

    def worlds(self) -> List[Array]:
        nodes = self.json["nodes"]
        parents: Dict[int, int] = {}
        for index, node in enumerate(nodes):
            for child in node.get("children", ()):
                parents[child] = index

        def world(index: int) -> Array:
            local = self.local(nodes[index])
            return world(parents[index]) @ local if index in parents else local

        return [world(index) for index in range(len(nodes))]

    def shown(self) -> List[int]:
        nodes = self.json["nodes"]
        below: List[int] = []
        pending = list(self.json["scenes"][self.json.get("scene", 0)]["nodes"])
        while pending:
            index = pending.pop()
            below.append(index)
            pending += nodes[index].get("children", ())
        return below

    def triangles(self) -> Array:
        worlds = self.worlds()
        parts: List[Array] = []
        for index in self.shown():
            node = self.json["nodes"][index]
            if "mesh" not in node:
                continue
            mesh = self.json["meshes"][node["mesh"]]
            weights = node.get("weights", mesh.get("weights", ()))
            places = [worlds[index] @ m for m in self.instances(node)]
            for primitive in mesh["primitives"]:
                points = self.points(primitive, weights)
                if "skin" in node:
                    points = self.skinned(primitive, points, node["skin"], worlds)
                corners = self.corners(primitive, len(points))
                for place in [numpy.eye(4)] if "skin" in node else places:
                    moved = points @ place[:3, :3].T + place[:3, 3]
                    parts.append(moved[corners])
        return numpy.concatenate(parts)

    def instances(self, node: Dict[str, Any]) -> List[Array]:
        extension = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
        if extension is None:
            return [numpy.eye(4)]
        given = {name: self.accessor(a) for name, a in extension["attributes"].items()}
        count = len(next(iter(given.values())))
        still = {"TRANSLATION": (0, 0, 0), "ROTATION": (0, 0, 0, 1), "SCALE": (1, 1, 1)}
        return [
            transform(*(given[n][i] if n in given else still[n] for n in still))
            for i in range(count)
        ]

    def points(self, primitive: Dict[str, Any], weights: Any) -> Array:
        points = self.accessor(primitive["attributes"]["POSITION"])
        for weight, target in zip(weights, primitive.get("targets", ())):
            if "POSITION" in target:
                points = points + weight * self.accessor(target["POSITION"])
        return points

    def skinned(
        self, primitive: Dict[str, Any], points: Array, skin: int, worlds: List[Array]
    ) -> Array:
        item = self.json["skins"][skin]
        joints = numpy.array([worlds[j] for j in item["joints"]])
        if "inverseBindMatrices" in item:
            binds = self.accessor(item["inverseBindMatrices"]).reshape(-1, 4, 4)
            joints = joints @ binds.transpose(0, 2, 1)
        total = numpy.zeros((len(points), 4))
        homogeneous = numpy.column_stack([points, numpy.ones(len(points))])
        names = primitive["attributes"]
        for number in range(8):
            if f"JOINTS_{number}" not in names:
                break
            which = self.accessor(names[f"JOINTS_{number}"]).astype(int)
            weights = self.accessor(names[f"WEIGHTS_{number}"])
            for k in range(4):
                moved = numpy.einsum("nij,nj->ni", joints[which[:, k]], homogeneous)
                total += weights[:, k : k + 1] * moved
        return total[:, :3] / total[:, 3:]

    def corners(self, primitive: Dict[str, Any], count: int) -> "NDArray[numpy.int64]":
        index = numpy.arange(count)
        if "indices" in primitive:
            index = self.accessor(primitive["indices"])[:, 0].astype(int)
        mode = primitive.get("mode", 4)
        if mode == 4:
            return index[: len(index) // 3 * 3].reshape(-1, 3)
        if mode == 5:
            return numpy.column_stack([index[:-2], index[1:-1], index[2:]])
        first = numpy.full(len(index) - 2, index[0])
        return numpy.column_stack([first, index[1:-1], index[2:]])


def transform(translation: Any, rotation: Any, scale: Any) -> Array:
    x, y, z, w = numpy.array(rotation, float) / numpy.linalg.norm(rotation)
    matrix = numpy.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] *= numpy.array(scale, float)
    matrix[:3, 3] = translation
    return matrix


def pixel_rays(
    eye: Array, target: Array, up: Array, fov_deg: float, width: int, height: int
) -> Array:
    """Directions (height, width, 3) whose part along the view is 1."""
    forward = (target - eye) / numpy.linalg.norm(target - eye)
    right = numpy.cross(forward, up)
    right /= numpy.linalg.norm(right)
    above = numpy.cross(right, forward)
    slope = 2.0 * numpy.tan(numpy.radians(fov_deg) / 2) / height
    x = (numpy.arange(width) + 0.5 - width / 2) * slope
    y = -(numpy.arange(height) + 0.5 - height / 2) * slope
    rays: Array = forward + x[None, :, None] * right + y[:, None, None] * above
    return rays


def depth_image(
    triangles: Array, eye: Array, rays: Array, margin: float = 0.0
) -> Tuple[Array, "NDArray[numpy.bool_]"]:
    """Depth along the view, infinite where nothing is hit, and which pixels could be otherwise by a
    hair's breadth: a ray passes an edge within `margin` of a triangle's size."""
    a, b, c = triangles[:, 0] - eye, triangles[:, 1] - eye, triangles[:, 2] - eye
    normal_a, normal_b, normal_c = numpy.cross(b, c), numpy.cross(c, a), numpy.cross(a, b)
    volume = numpy.einsum("ni,ni->n", a, normal_a)
    flat = rays.reshape(-1, 3)
    depth = numpy.empty(len(flat))
    unsure = numpy.empty(len(flat), bool)
    for i, ray in enumerate(flat):
        u, v, w = normal_a @ ray, normal_b @ ray, normal_c @ ray
        total = u + v + w
        with numpy.errstate(divide="ignore", invalid="ignore"):
            distance = volume / total
            least = numpy.minimum(numpy.minimum(u / total, v / total), w / total)
        # In front of the eye, and on the inside of all three edges.
        front = distance > 0

        def nearest(bound: float) -> float:
            hit = distance[front & (least >= bound)]
            return float(hit.min()) if len(hit) else numpy.inf

        depth[i] = nearest(0.0)
        with numpy.errstate(invalid="ignore"):
            unsure[i] = not numpy.isclose(nearest(-margin), nearest(margin), rtol=1e-9)
    return depth.reshape(rays.shape[:2]), unsure.reshape(rays.shape[:2])

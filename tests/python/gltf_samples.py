"""Random glTF files for tests: meshes of boxes and cones in every form that geometry may have.

In: a seed and a folder. Out: a .glb or .gltf file in it, and which features it has.
"""

from __future__ import annotations

import base64
import json
import pathlib
import struct
from typing import Any, Dict, List, Optional, Set, Tuple

import numpy
from numpy.typing import NDArray

Array = NDArray[numpy.float64]

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Writer:
    def __init__(self, seed: int) -> None:
        self.random = numpy.random.default_rng(seed)
        self.data = b""
        self.features: Set[str] = set()
        self.json: Dict[str, Any] = {
            "asset": {"version": "2.0"},
            "accessors": [],
            "bufferViews": [],
            "meshes": [],
            "nodes": [],
            "extensionsUsed": [],
            "extensionsRequired": [],
        }

    def chance(self, probability: float, feature: str) -> bool:
        if self.random.random() >= probability:
            return False
        self.features.add(feature)
        return True

    def require(self, extension: str) -> None:
        for name in ("extensionsUsed", "extensionsRequired"):
            if extension not in self.json[name]:
                self.json[name].append(extension)

    def view(self, data: bytes, stride: Optional[int] = None) -> int:
        self.data += bytes(-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        if stride is not None:
            view["byteStride"] = stride
        self.data += data
        self.json["bufferViews"].append(view)
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values: "NDArray[Any]", kind: str, **more: Any) -> int:
        """Interleaved with other bytes or not."""
        rows = numpy.ascontiguousarray(values.reshape(len(values), -1), "<" + kind)
        item = {
            "componentType": COMPONENTS[kind],
            "count": len(rows),
            "type": TYPES[rows.shape[1]],
            **more,
        }
        element = rows.dtype.itemsize * rows.shape[1]
        stride = -(-element // 4) * 4
        if rows.shape[1] in (3, 4) and (stride != element or self.chance(0.3, "interleaved")):
            gap = bytes([0xAB]) * (stride + 4 - element)
            data = b"".join(row.tobytes() + gap for row in rows)
            item["bufferView"] = self.view(data, stride + 4)
        else:
            item["bufferView"] = self.view(rows.tobytes())
        self.json["accessors"].append(item)
        return len(self.json["accessors"]) - 1

    def sparse(self, values: Array) -> int:
        """Float positions of which only what differs from zero, or from a dense list, is listed."""
        self.features.add("sparse")
        base = values.copy()
        places = numpy.unique(self.random.integers(0, len(values), len(values) // 2))
        more = {}
        if self.random.random() < 0.5:
            base[places] = 99.0
        else:
            places = numpy.arange(len(values))
            self.features.add("sparse_from_zeros")
        count = len(places)
        index = self.view(places.astype("<u2").tobytes())
        replaced = self.view(values[places].astype("<f4").tobytes())
        more["sparse"] = {
            "count": count,
            "indices": {"bufferView": index, "componentType": 5123},
            "values": {"bufferView": replaced},
        }
        number = self.accessor(base, "f4", **more)
        if "sparse_from_zeros" in self.features and count == len(values):
            del self.json["accessors"][number]["bufferView"]
        return number

    def positions(self, points: Array) -> Tuple[int, Array]:
        """The accessor, and the matrix that turns what it holds back into `points`."""
        low, size = points.min(axis=0), float(numpy.ptp(points, axis=0).max())
        back = numpy.eye(4)
        if self.chance(0.35, "quantized"):
            self.require("KHR_mesh_quantization")
            kind = str(self.random.choice(["u2", "i2", "u1"]))
            top = numpy.iinfo(kind).max
            whole = numpy.round((points - low) / size * top)
            if self.random.random() < 0.5:
                back[:3, :3] *= size
                number = self.accessor(whole, kind, normalized=True)
            else:
                back[:3, :3] *= size / top
                number = self.accessor(whole, kind)
            back[:3, 3] = low
            return number, back
        if self.chance(0.25, "sparse"):
            return self.sparse(points), back
        return self.accessor(points, "f4"), back

    def primitive(self, points: Array, corners: "NDArray[Any]") -> Tuple[Dict[str, Any], Array]:
        number, back = self.positions(points)
        primitive: Dict[str, Any] = {"attributes": {"POSITION": number}}
        kind = str(self.random.choice(["u1", "u2", "u4"]))
        form = self.random.random()
        if form < 0.2:
            # A strip through all triangles, with flat ones between them.
            self.features.add("strip")
            strip: List[int] = []
            for a, b, c in corners:
                strip += [a, a, b, c, c] if not strip else [a, a, b, c, c]
            primitive["mode"] = 5
            primitive["indices"] = self.accessor(numpy.array(strip), kind)
        elif form < 0.35:
            self.features.add("no_indices")
            flat = points[corners.reshape(-1)]
            primitive["attributes"]["POSITION"] = self.accessor(flat, "f4")
            back = numpy.eye(4)
        else:
            primitive["indices"] = self.accessor(corners.reshape(-1), kind)
        return primitive, back


def shape(random: numpy.random.Generator) -> Tuple[Array, "NDArray[Any]"]:
    """A box or a cone of about unit size, standing on z = 0."""
    if random.random() < 0.5:
        points = numpy.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
        quads = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
        corners = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
        return points, numpy.array(corners)
    sides = int(random.integers(3, 9))
    turn = numpy.arange(sides) * 2 * numpy.pi / sides
    ring = numpy.column_stack([numpy.cos(turn), numpy.sin(turn), numpy.zeros(sides)]) * 0.5
    points = numpy.concatenate([ring, [[0, 0, 1.2]], [[0, 0, 0]]])
    corners = [(i, (i + 1) % sides, top) for top in (sides, sides + 1) for i in range(sides)]
    return points, numpy.array(corners)


def quaternion(random: numpy.random.Generator) -> List[float]:
    value = random.normal(size=4)
    return list(value / numpy.linalg.norm(value))


def add_object(writer: Writer) -> None:
    """A mesh at a random place, moved in one of the ways that there are."""
    random = writer.random
    points, corners = shape(random)
    place = list(random.uniform(-3, 3, 2)) + [float(random.uniform(0, 1))]
    scale = list(random.uniform(0.4, 1.6, 3))
    form = str(random.choice(["plain", "matrix", "nested", "instances", "skin", "morph"]))
    writer.features.add(form)
    nodes = writer.json["nodes"]
    mesh: Dict[str, Any]
    node: Dict[str, Any]
    if form in ("skin", "morph"):
        number = writer.sparse(points) if writer.chance(0.3, "sparse") else None
        number = writer.accessor(points, "f4") if number is None else number
        primitive: Dict[str, Any] = {"attributes": {"POSITION": number}}
        primitive["indices"] = writer.accessor(corners.reshape(-1), "u2")
        mesh = {"primitives": [primitive]}
        node = {"mesh": len(writer.json["meshes"])}
        if form == "morph":
            moves = [random.normal(size=points.shape) * 0.3 for _ in range(3)]
            primitive["targets"] = [
                {"POSITION": writer.sparse(m) if random.random() < 0.4 else writer.accessor(m, "f4")}
                for m in moves
            ]
            mesh["weights"] = list(random.uniform(-1, 1, 3))
            if writer.chance(0.5, "node_weights"):
                node["weights"] = list(random.uniform(-1, 1, 3))
            node.update(translation=place, scale=scale)
        else:
            add_skin(writer, primitive, node, points, place, scale)
    else:
        primitive, back = writer.primitive(points, corners)
        mesh = {"primitives": [primitive]}
        child = {"mesh": len(writer.json["meshes"]), "matrix": list(back.T.reshape(-1))}
        nodes.append(child)
        node = {"children": [len(nodes) - 1], "translation": place, "scale": scale}
        node["rotation"] = quaternion(random)
        if form == "matrix":
            shear = numpy.eye(4)
            shear[:3, :3] += random.normal(size=(3, 3)) * 0.3
            shear[:3, 3] = place
            node = {"children": node["children"], "matrix": list(shear.T.reshape(-1))}
        elif form == "nested":
            nodes.append(node)
            node = {"children": [len(nodes) - 1], "rotation": quaternion(random)}
            node["translation"] = list(random.uniform(-1, 1, 3))
        elif form == "instances":
            add_instances(writer, child)
    writer.json["meshes"].append(mesh)
    nodes.append(node)
    writer.json["scenes"][0]["nodes"].append(len(nodes) - 1)


def add_instances(writer: Writer, node: Dict[str, Any]) -> None:
    writer.require("EXT_mesh_gpu_instancing")
    random, count = writer.random, int(writer.random.integers(1, 6))
    attributes = {"TRANSLATION": writer.accessor(random.uniform(-2, 2, (count, 3)), "f4")}
    if writer.chance(0.6, "instance_rotations"):
        turns = numpy.array([quaternion(random) for _ in range(count)])
        if writer.chance(0.5, "packed_rotations"):
            whole = numpy.round(turns * 32767)
            attributes["ROTATION"] = writer.accessor(whole, "i2", normalized=True)
        else:
            attributes["ROTATION"] = writer.accessor(turns, "f4")
    if writer.chance(0.6, "instance_scales"):
        attributes["SCALE"] = writer.accessor(random.uniform(0.3, 1.2, (count, 3)), "f4")
    node["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}


def add_skin(
    writer: Writer,
    primitive: Dict[str, Any],
    node: Dict[str, Any],
    points: Array,
    place: List[float],
    scale: List[float],
) -> None:
    random, nodes = writer.random, writer.json["nodes"]
    joints = []
    for index in range(3):
        near = [p + float(d) for p, d in zip(place, random.normal(size=3) * 0.3)]
        nodes.append({"translation": near, "rotation": quaternion(random), "scale": scale})
        writer.json["scenes"][0]["nodes"].append(len(nodes) - 1)
        joints.append(len(nodes) - 1)
    skin: Dict[str, Any] = {"joints": joints}
    if writer.chance(0.7, "inverse_binds"):
        binds = numpy.tile(numpy.eye(4), (3, 1, 1)) + random.normal(size=(3, 4, 4)) * 0.1
        binds[:, 3] = (0, 0, 0, 1)
        skin["inverseBindMatrices"] = writer.accessor(binds.transpose(0, 2, 1), "f4")
    sets = 2 if writer.chance(0.3, "two_sets_of_joints") else 1
    weights = random.uniform(0.1, 1, (len(points), 4 * sets))
    weights /= weights.sum(axis=1, keepdims=True)
    packed = writer.chance(0.4, "packed_weights")
    for number in range(sets):
        which = random.integers(0, 3, (len(points), 4))
        part = weights[:, 4 * number : 4 * number + 4]
        names = primitive["attributes"]
        names[f"JOINTS_{number}"] = writer.accessor(which, str(random.choice(["u1", "u2"])))
        names[f"WEIGHTS_{number}"] = (
            writer.accessor(numpy.round(part * 65535), "u2", normalized=True)
            if packed
            else writer.accessor(part, "f4")
        )
    # Where a skinned mesh's own node is does not matter.
    node.update(skin=len(writer.json.setdefault("skins", [])), translation=[50, 0, 0])
    writer.json["skins"].append(skin)


def write_sample(seed: int, folder: pathlib.Path) -> Tuple[pathlib.Path, Set[str]]:
    writer = Writer(seed)
    writer.json["scenes"] = [{"nodes": []}]
    writer.json["scene"] = 0
    floor = numpy.array([[-9, -9, -1], [9, -9, -1], [9, 9, -1], [-9, 9, -1]], float)
    number = writer.accessor(floor, "f4")
    fan = {"attributes": {"POSITION": number}, "mode": 6}
    writer.json["meshes"].append({"primitives": [fan]})
    writer.json["nodes"].append({"mesh": 0})
    writer.json["scenes"][0]["nodes"].append(0)
    for _ in range(int(writer.random.integers(3, 8))):
        add_object(writer)
    form = seed % 3
    writer.json["buffers"] = [{"byteLength": len(writer.data)}]
    if form == 0:
        text = json.dumps(writer.json).encode()
        text += b" " * (-len(text) % 4)
        data = writer.data + bytes(-len(writer.data) % 4)
        path = folder / "sample.glb"
        path.write_bytes(
            struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data))
            + struct.pack("<I4s", len(text), b"JSON")
            + text
            + struct.pack("<I4s", len(data), b"BIN\0")
            + data
        )
    else:
        path = folder / "sample.gltf"
        if form == 1:
            (folder / "data ä.bin").write_bytes(writer.data)
            writer.json["buffers"][0]["uri"] = "data%20%C3%A4.bin"
            writer.features.add("percent_uri")
        else:
            code = base64.b64encode(writer.data).decode()
            writer.json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + code
            writer.features.add("data_uri")
        mark = "\ufeff" if writer.chance(0.5, "byte_order_mark") else ""
        path.write_text(mark + json.dumps(writer.json), encoding="utf-8")
    return path, writer.features

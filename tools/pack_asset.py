#!/usr/bin/env python3
"""Makes assets/sheen_cloth.glb from the SheenCloth.glb of the draco source package.

    python3 tools/pack_asset.py SheenCloth.glb assets/sheen_cloth.glb

Positions, indices and images are copied byte for byte; normals and tangents
become signed normalised bytes and texture coordinates unsigned normalised
shorts (KHR_mesh_quantization), which takes the file below 3 MB.
"""

import json
import struct
import sys

FLOAT, BYTE, USHORT = 5126, 5120, 5123


def read_glb(path):
    data = open(path, "rb").read()
    json_bytes = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + json_bytes])
    return document, data[28 + json_bytes :]


def view_bytes(document, binary, index):
    view = document["bufferViews"][index]
    first = view.get("byteOffset", 0)
    return binary[first : first + view["byteLength"]]


def quantise(raw, components, low, high, pack, width):
    """Float vectors -> `pack` integers in low..high, padded to `width` of them."""
    values = struct.unpack(f"<{len(raw) // 4}f", raw)
    padding = [0] * (width - components)
    out = []
    for first in range(0, len(values), components):
        element = values[first : first + components]
        out += [round(min(max(v, low / high), 1.0) * high) for v in element] + padding
    return struct.pack(f"<{len(out)}{pack}", *out)


def pack_attribute(name, raw):
    """New bytes, component type and stride of one vertex attribute."""
    if name in ("NORMAL", "TANGENT"):
        return quantise(raw, 3 if name == "NORMAL" else 4, -127, 127, "b", 4), BYTE, 4
    if name == "TEXCOORD_0":
        return quantise(raw, 2, 0, 65535, "H", 2), USHORT, 4
    return raw, FLOAT, 12


def main(source, target):
    document, binary = read_glb(source)
    attributes = document["meshes"][0]["primitives"][0]["attributes"]
    accessor_views = {document["accessors"][i]["bufferView"]: n for n, i in attributes.items()}
    packed = bytearray()
    for index, view in enumerate(document["bufferViews"]):
        raw = view_bytes(document, binary, index)
        if index in accessor_views:
            name = accessor_views[index]
            raw, component, view["byteStride"] = pack_attribute(name, raw)
            accessor = document["accessors"][attributes[name]]
            accessor["componentType"] = component
            if component != FLOAT:
                accessor["normalized"] = True
            view["target"] = 34962
        elif index == document["accessors"][0]["bufferView"]:
            view["target"] = 34963
        packed += b"\0" * (-len(packed) % 4)
        view["byteOffset"], view["byteLength"] = len(packed), len(raw)
        packed += raw
    packed += b"\0" * (-len(packed) % 4)
    document["buffers"] = [{"byteLength": len(packed)}]
    for key in ("extensionsUsed", "extensionsRequired"):
        document[key] = sorted({*document.get(key, []), "KHR_mesh_quantization"})
    document["asset"]["copyright"] = "CC0 1.0, donated by Microsoft"
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    size = 28 + len(text) + len(packed)
    with open(target, "wb") as out:
        out.write(struct.pack("<4sII", b"glTF", 2, size))
        out.write(struct.pack("<I4s", len(text), b"JSON") + text)
        out.write(struct.pack("<I4s", len(packed), b"BIN\0") + packed)
    print(f"{target}: {size} bytes")


if __name__ == "__main__":
    main(*sys.argv[1:])

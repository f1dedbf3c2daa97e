#!/usr/bin/env python3
"""Packs the fixtures of build.sh into the small file that the tests carry.

pack.py FIXTURES_DIR OUT.json

Every vertex of level 1 is kept; of the other levels, sums over eighths of the vertices with
weights that look random, and a few vertices as they are.
"""
import base64, json, os, struct, sys

BLOCKS, SAMPLES = 8, 4
MASK = 0xFFFFFFFF


def weight(i):
    """From -1 to 1, by number."""
    x = (i * 2654435761 + 12345) & MASK
    x ^= x >> 15
    x = (x * 2246822519) & MASK
    x ^= x >> 13
    return x / 2147483648.0 - 1.0


def fnv(data):
    h = 0xCBF29CE484222325
    for b in data:
        h = ((h ^ b) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
    return f"{h:016x}"


def sums(values, n, blocks=BLOCKS):
    """Per block and component."""
    count = len(values) // n
    out = [0.0] * (blocks * n)
    for i in range(count):
        b, w = i * blocks // count, weight(i)
        for c in range(n):
            out[b * n + c] += w * values[i * n + c]
    return out


def text(fmt, values):
    return base64.b64encode(struct.pack(f"<{len(values)}{fmt}", *values)).decode()


class Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, fmt, count):
        size = struct.calcsize(f"<{count}{fmt}")
        found = struct.unpack_from(f"<{count}{fmt}", self.data, self.at)
        self.at += size
        return found


def shape(path):
    r = Reader(open(path, "rb").read())
    assert r.data[:4] == b"KOSD"
    r.at = 4
    levels, rules = r.take("I", 2)
    out = []
    for level in range(1, levels + 1):
        v, f, c = r.take("I", 3)
        r.take("I", f)
        start = r.at
        r.take("I", c)
        faces = r.data[start:r.at]
        holes = r.data[r.at:r.at + f]
        r.at += f
        positions, limits, _ = (r.take("d", 3 * v) for _ in range(3))
        uvs = [r.take("d", 2 * c) for _ in range(rules)]
        entry = {"vertices": v, "faces": f, "holes": sum(holes)}
        if len(faces) <= 1 << 18:
            entry["corners"] = fnv(faces)
        if level == 1:
            entry["positions"] = text("f", positions)
        else:
            step = max(v // SAMPLES, 1)
            entry["sums"] = text("d", sums(positions, 3))
            some = range(0, min(v, step * SAMPLES), step)
            entry["samples"] = text("f", [x for i in some for x in positions[3 * i:3 * i + 3]])
        if level == 2:
            entry["limits"] = text("d", sums(limits, 3, 4))
            entry["uvs"] = [text("d", sums(u, 2, 2)) for u in uvs]
        out.append(entry)
    return out


def main():
    folder, to = sys.argv[1:]
    names = sorted(n[:-4] for n in os.listdir(folder) if n.endswith(".bin"))
    shapes = {name: shape(os.path.join(folder, name + ".bin")) for name in names}
    with open(to, "w") as out:
        rows = (f"{json.dumps(n)}:{json.dumps(s, separators=(',', ':'))}" for n, s in shapes.items())
        out.write("{\n" + ",\n".join(rows) + "\n}\n")


main()

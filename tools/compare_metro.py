#!/usr/bin/env python3
"""Compares Karui's surface distance with MeshLab's Hausdorff distance filter.

    python3 -m venv /tmp/metro && /tmp/metro/bin/pip install pymeshlab
    /tmp/metro/bin/python tools/compare_metro.py FOLDER [--samples N]

FOLDER holds bun_zipper.ply.gz, dragon_vrip_res2.ply.gz, dragon_vrip_res3.ply.gz
(Stanford) and armadillo.obj. Levels of bunny and armadillo are made with MeshLab.
Exits with 1 if a mean or RMS is more than 2 % off.
"""

import argparse
import gzip
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

import pymeshlab

TOLERANCE = 0.02
REPOSITORY = pathlib.Path(__file__).resolve().parent.parent


def unpacked(source, folder):
    """The model without .gz, which MeshLab does not read."""
    if source.suffix != ".gz":
        return source
    target = folder / source.stem
    with gzip.open(source) as packed, open(target, "wb") as plain:
        shutil.copyfileobj(packed, plain)
    return target


def decimated(source, triangles, folder):
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(str(source))
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=triangles)
    target = folder / f"{source.stem}_{triangles}.ply"
    meshes.save_current_mesh(str(target), save_vertex_color=False)
    return target


def theirs(a, b, samples):
    meshes = pymeshlab.MeshSet(verbose=False)
    for path in (a, b):
        meshes.load_new_mesh(str(path))
        # Karui counts no vertex that no triangle uses, and positions once.
        meshes.meshing_remove_duplicate_vertices()
        meshes.meshing_remove_unreferenced_vertices()

    def directed(sampled, target):
        d = meshes.get_hausdorff_distance(
            sampledmesh=sampled,
            targetmesh=target,
            samplevert=True,
            sampleedge=True,
            sampleface=True,
            samplenum=samples,
            maxdist=pymeshlab.PercentageValue(100),
        )
        return d["max"], d["mean"], d["RMS"], d["n_samples"]

    return directed(0, 1), directed(1, 0)


def ours(a, b, samples):
    command = ["cargo", "run", "--release", "--quiet", "--example", "how_far", "--"]
    arguments = [str(a), str(b), str(samples)]
    run = subprocess.run(
        command + arguments, cwd=REPOSITORY, capture_output=True, text=True, check=True
    )
    rows = dict(line.split(" ", 1) for line in run.stdout.splitlines())
    return [[float(x) for x in rows[way].split()] for way in ("a_to_b", "b_to_a")]


def compare(name, a, b, samples):
    """Prints one line a direction; returns the largest deviation of mean and RMS."""
    worst = 0.0
    for way, k, m in zip(("a to b", "b to a"), ours(a, b, samples), theirs(a, b, samples)):
        ratios = [x / y if y else math.inf for x, y in zip(k[:3], m[:3])]
        figures = "  ".join(f"{x:.4e} {y:.4e} {r:6.4f}" for x, y, r in zip(k, m, ratios))
        print(f"{name:24} {way}  {figures}  {k[3]:9.0f} {m[3]:9d}")
        worst = max(worst, *(abs(r - 1) for r in ratios[1:]))
    return worst


def pairs(models, folder):
    def model(name):
        return unpacked(models / name, folder)

    bunny = model("bun_zipper.ply.gz")
    yield "bunny, 10 %", bunny, decimated(bunny, 6945, folder)
    yield "bunny, 1 %", bunny, decimated(bunny, 695, folder)
    yield "dragon res2, res3", model("dragon_vrip_res2.ply.gz"), model("dragon_vrip_res3.ply.gz")
    armadillo = model("armadillo.obj")
    yield "armadillo, 10 %", armadillo, decimated(armadillo, 3000, folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", type=pathlib.Path)
    parser.add_argument("--samples", type=int, default=500_000)
    arguments = parser.parse_args()
    heading = "  ".join(f"{x + ', Karui':>10} {'MeshLab':>10} {'ratio':>6}" for x in ("max", "mean", "RMS"))
    print(f"{'pair':24} {'way':6}  {heading}  {'samples':>9} {'MeshLab':>9}")
    with tempfile.TemporaryDirectory() as scratch:
        found = [
            compare(name, a, b, arguments.samples)
            for name, a, b in pairs(arguments.models, pathlib.Path(scratch))
        ]
    print(f"mean and RMS differ by at most {100 * max(found):.2f} %")
    return max(found) > TOLERANCE


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Simplifies models with other tools and measures all results as ours are.

    python3 -m venv /tmp/peers
    /tmp/peers/bin/pip install numpy pymeshlab fast-simplification pyfqmr open3d vtk
    # Open3D also wants Debian's libusb-1.0-0.
    cargo build --release
    /tmp/peers/bin/python tools/peers.py MODEL... [--targets 0.5,0.1,0.01] [-o docs/measured.md]

Every tool gets the same mesh, without attributes and with vertices at one place joined, in a
process of its own; timed is the call that simplifies, not reading or conversion. Tools that are
not installed are left out. Errors, flips, non-manifold edges and borders are measured by
`karui bench judge`. meshoptimizer is in `karui bench simplify --peers`. CGAL's Lindstrom-Turk is
in no Python package that we know of: the package `cgal` leaves its simplification out.
"""

import argparse
import datetime
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
NAME = "tools/peers.py"


# Meshes as binary PLY: float positions, int triangles.

def read_ply(path):
    import numpy as np

    with open(path, "rb") as file:
        counts = {}
        for line in iter(lambda: file.readline().split(), [b"end_header"]):
            if line[0] == b"element":
                counts[line[1]] = int(line[2])
        vertices = np.fromfile(file, "<f4", 3 * counts[b"vertex"]).reshape(-1, 3)
        face = np.dtype([("count", "u1"), ("corners", "<u4", 3)])
        faces = np.fromfile(file, face, counts[b"face"])
    assert (faces["count"] == 3).all()
    return vertices, np.ascontiguousarray(faces["corners"])


def write_ply(path, vertices, triangles):
    import numpy as np

    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    faces = np.empty(len(triangles), np.dtype([("count", "u1"), ("corners", "<u4", 3)]))
    faces["count"], faces["corners"] = 3, triangles
    with open(path, "wb") as file:
        file.write(header.encode())
        np.ascontiguousarray(vertices, "<f4").tofile(file)
        faces.tofile(file)


# One function a tool: makes ready, times the one call, returns the result.

class Watch:
    """Seconds of a `with` block, on the wall and of the processor."""

    def __enter__(self):
        self.wall, self.cpu = time.perf_counter(), time.process_time()
        return self

    def __exit__(self, *_):
        self.wall, self.cpu = time.perf_counter() - self.wall, time.process_time() - self.cpu


def meshlab(vertices, triangles, wanted, **options):
    import pymeshlab

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(vertices.astype("f8"), triangles.astype("i4")))
    with Watch() as watch:
        meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=wanted, **options)
    mesh = meshes.current_mesh()
    return watch, mesh.vertex_matrix(), mesh.face_matrix()


def meshlab_preserving(vertices, triangles, wanted):
    return meshlab(
        vertices, triangles, wanted,
        preserveboundary=True, preservenormal=True, preservetopology=True,
    )


def fast_simplification(vertices, triangles, wanted):
    import fast_simplification as library

    triangles = triangles.astype("i4")
    with Watch() as watch:
        points, faces = library.simplify(vertices, triangles, target_count=wanted)
    return watch, points, faces


def pyfqmr(vertices, triangles, wanted):
    import pyfqmr as library

    mesh = library.Simplify()
    mesh.setMesh(vertices.astype("f8"), triangles.astype("i4"))
    with Watch() as watch:
        mesh.simplify_mesh(target_count=wanted, preserve_border=True, verbose=False)
    points, faces, _ = mesh.getMesh()
    return watch, points, faces


def open3d(vertices, triangles, wanted):
    import numpy as np
    import open3d as library

    mesh = library.geometry.TriangleMesh(
        library.utility.Vector3dVector(vertices.astype("f8")),
        library.utility.Vector3iVector(triangles.astype("i4")),
    )
    with Watch() as watch:
        mesh = mesh.simplify_quadric_decimation(wanted)
    return watch, np.asarray(mesh.vertices), np.asarray(mesh.triangles)


def vtk(vertices, triangles, wanted):
    import numpy as np
    import vtk as library
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

    points = library.vtkPoints()
    points.SetData(numpy_to_vtk(vertices, deep=True))
    offsets = numpy_to_vtkIdTypeArray(np.arange(0, triangles.size + 1, 3, "i8"), deep=True)
    corners = numpy_to_vtkIdTypeArray(triangles.astype("i8").ravel(), deep=True)
    cells = library.vtkCellArray()
    cells.SetData(offsets, corners)
    mesh = library.vtkPolyData()
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    decimation = library.vtkQuadricDecimation()
    decimation.SetInputData(mesh)
    decimation.SetTargetReduction(1.0 - wanted / len(triangles))
    with Watch() as watch:
        decimation.Update()
    result = decimation.GetOutput()
    faces = vtk_to_numpy(result.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    return watch, vtk_to_numpy(result.GetPoints().GetData()), faces


TOOLS = {
    "MeshLab": (meshlab, "pymeshlab"),
    "MeshLab, preserving": (meshlab_preserving, "pymeshlab"),
    "VTK quadric": (vtk, "vtk"),
    "Open3D": (open3d, "open3d"),
    "pyfqmr": (pyfqmr, "pyfqmr"),
    "fast-simplification": (fast_simplification, "fast_simplification"),
}


def run_one(tool, source, target, wanted, runs):
    """In a process of its own: simplifies, writes the result, prints the times."""
    vertices, triangles = read_ply(source)
    walls, cpus = [], []
    while len(walls) < runs and sum(walls) < 10.0:
        watch, points, faces = TOOLS[tool][0](vertices.copy(), triangles.copy(), wanted)
        walls.append(watch.wall)
        cpus.append(watch.cpu)
    write_ply(target, points, faces)
    print(json.dumps({"wall": sorted(walls), "cpu": sorted(cpus)}))


# The comparison.

def installed(module):
    look = f"import importlib.util, sys; sys.exit(importlib.util.find_spec('{module}') is None)"
    return subprocess.run([sys.executable, "-c", look]).returncode == 0


def karui(args, *words):
    command = [args.karui, "bench", *words, "--json", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: {done.stderr.strip()}")
    return json.loads(done.stdout)


def peers_on(args, tools, model, folder):
    """Rows of all tools but ours on one model."""
    source = folder / "original.ply"
    triangles = karui(args, "judge", str(model), "--prepare", str(source))["triangles"]
    rows = []
    for target in args.targets:
        wanted = round(target * triangles)
        for tool in tools:
            result = folder / f"{len(rows)}.ply"
            words = ["--one", tool, str(source), str(result), str(wanted), str(args.runs)]
            one = [sys.executable, __file__, *words]
            done = subprocess.run(one, capture_output=True, text=True)
            if done.returncode:
                print(f"{tool} on {model}: {done.stderr.strip()[-300:]}", file=sys.stderr)
                continue
            times = json.loads(done.stdout.splitlines()[-1])
            rows.append({"target": target, "tool": tool, "ours": False, "result": result,
                         "threads": None, **{k: v[len(v) // 2] for k, v in times.items()}})
    results = [str(row["result"]) for row in rows]
    judged = karui(args, "judge", str(source), *results, "--samples", str(args.samples))
    for row, errors in zip(rows, judged["results"]):
        row.update(errors=errors)
    return triangles, rows


def ours_on(args, model):
    """Rows of ours, without clustering: nothing here is as loose."""
    words = ["--parts", "geometry", "--more-than", "0", "--no-memory", "--runs", str(args.runs)]
    words += ["--targets", ",".join(map(str, args.targets)), "--samples", str(args.samples)]
    rows = karui(args, "simplify", str(model), *words)["geometry"]
    return [{"target": row["target"], "tool": f"karui {row['name']}", "ours": True,
             "threads": row["threads"], "wall": row["costs"]["wall"]["median"],
             "cpu": row["costs"]["cpu"]["median"], "errors": row["errors"]}
            for row in rows if row["name"] != "sloppy"]


def number(x):
    if x is None or not math.isfinite(x):
        return "lost"
    return f"{x:.{0 if x >= 100 else 1 if x >= 10 else 2 if x >= 1 else 3}f}"


def line(name, triangles, row, others):
    """A row of the table; bold is what ours does not win."""
    errors = row["errors"]
    wanted = row["target"] * triangles

    def cell(text, bad):
        return f"**{text}**" if row["ours"] and bad else text

    def error(key):
        # Whoever stopped early is no measure of who did not.
        rivals = [o["errors"][key] for o in others if o["errors"]["triangles"] <= 1.01 * wanted + 1]
        value = errors[key]
        lost = value is None or any(r is not None and r < value for r in rivals)
        return cell(number(value and 1e4 * value), lost)

    faster = any(o["wall"] < row["wall"] for o in others)
    tool = row["tool"] + (f", {row['threads']} threads" if (row["threads"] or 1) > 1 else "")
    border = errors["border"]
    return [
        f"`{name}`", f"{triangles:,}", f"{row['target'] * 100:g} %", tool,
        cell(f"{errors['triangles']:,}", errors["triangles"] > 1.01 * wanted + 1),
        cell(number(row["wall"] * 1e3), faster), number(row["cpu"] * 1e3),
        error("mean"), error("rms"), error("max"),
        cell(f"{errors['new_flips']:,}", errors["new_flips"] > 0),
        cell(f"{errors['new_non_manifold']:,}", errors["new_non_manifold"] > 0),
        "-" if border is None else number(1e4 * border),
    ]


HEADER = ["model", "triangles", "target", "tool", "left", "ms", "CPU ms", "mean", "RMS", "max",
          "flips", "non-m.", "border"]


def table(lines):
    widths = [max(len(row[i]) for row in [HEADER, *lines]) for i in range(len(HEADER))]

    def padded(row):
        cells = [c.ljust(w) if i == 0 else c.rjust(w) for i, (c, w) in enumerate(zip(row, widths))]
        return f"| {' | '.join(cells)} |"

    rule = [("-" * w if i == 0 else "-" * (w - 1) + ":") for i, w in enumerate(widths)]
    return "\n".join(map(padded, [HEADER, rule, *lines]))


def markdown(versions, lines):
    today = datetime.datetime.now(datetime.timezone.utc).date()
    return f"""\
## Other tools

Written by `{NAME} MODEL... -o FILE`, with {versions}.
Every tool gets the same mesh, without attributes and with vertices at one place joined, and has
its default options; "preserving" is MeshLab told to keep borders, normals and topology, and
pyfqmr keeps borders. Columns are those of
`karui bench simplify`; ms is the median. **Bold**: where ours does not win against all of them
(errors: of those that reached the target), or leaves flips or non-manifold edges.

Machine: {os.cpu_count()} threads. Date: {today}.

{table(lines)}
"""


def put_on_page(path, body):
    """Replaces this tool's section of the page, or adds it."""
    begin, end = f"<!-- begin: {NAME} -->\n", f"<!-- end: {NAME} -->\n"
    page = path.read_text() if path.exists() else ""
    section = f"{begin}{body.rstrip()}\n{end}"
    if begin in page and end in page:
        before, rest = page.split(begin, 1)
        page = before + section + rest.split(end, 1)[1]
    else:
        page = f"{page.rstrip()}\n\n{section}".lstrip()
    path.write_text(page)


def versions_of(tools):
    from importlib.metadata import packages_distributions, version

    packages = packages_distributions()
    modules = dict.fromkeys(TOOLS[tool][1] for tool in tools)
    names = [packages.get(module, [module])[0] for module in modules]
    return ", ".join(f"{name} {version(name)}" for name in names)


def main():
    if sys.argv[1:2] == ["--one"]:
        tool, source, target, wanted, runs = sys.argv[2:]
        return run_one(tool, source, target, int(wanted), int(runs))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="+", type=pathlib.Path)
    parser.add_argument("--targets", default="0.5,0.1,0.01")
    parser.add_argument("--tools", help=f"some of: {'; '.join(TOOLS)} (separated by ;)")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--samples", type=int, default=200_000)
    parser.add_argument("--karui", default=str(REPOSITORY / "target/release/karui"))
    parser.add_argument("-o", "--output", type=pathlib.Path, help="page to put the table on")
    args = parser.parse_args()
    args.targets = [float(target) for target in args.targets.split(",")]
    tools = args.tools.split(";") if args.tools else list(TOOLS)
    if unknown := set(tools) - set(TOOLS):
        parser.error(f"no such tools: {unknown}")
    missing = [tool for tool in tools if not installed(TOOLS[tool][1])]
    if missing:
        print(f"not installed: {', '.join(missing)}", file=sys.stderr)
    tools = [tool for tool in tools if tool not in missing]
    lines = []
    for model in args.models:
        print(model, file=sys.stderr)
        with tempfile.TemporaryDirectory() as folder:
            triangles, peers = peers_on(args, tools, model, pathlib.Path(folder))
        ours = ours_on(args, model)
        for target in args.targets:
            others = [row for row in peers if row["target"] == target]
            rows = [row for row in ours if row["target"] == target] + others
            lines += [line(model.name, triangles, row, others) for row in rows]
    text = markdown(versions_of(tools), lines)
    if args.output:
        put_on_page(args.output, text)
    else:
        print(text)


if __name__ == "__main__":
    main()

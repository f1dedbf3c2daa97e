"""A coarse trimesh object made smooth: at once, frame by frame as it moves, and where it is seen.

python trimesh_subdivide.py [MODEL]
"""

import sys

import numpy as np

import karui

try:
    import trimesh
except ImportError:
    sys.exit("this example needs trimesh: pip install trimesh")


def main() -> None:
    if len(sys.argv) > 1:
        cage = trimesh.load_mesh(sys.argv[1])
    else:
        cage = trimesh.creation.torus(1.0, 0.4, major_sections=12, minor_sections=6)
    print(f"{len(cage.faces):7,} triangles, area {cage.area:.4f}: the cage")

    smooth = karui.subdivide(cage, 3, "loop", limit=True, normals=True).to_mesh()
    back = trimesh.Trimesh(
        smooth.positions, smooth.triangles, vertex_normals=smooth.normals, process=False
    )
    print(f"{len(back.faces):7,} triangles, area {back.area:.4f}: three steps of Loop")

    refinement = karui.Refinement(cage, 3, "loop")
    for frame in range(3):
        bend = np.sin(cage.vertices[:, :1] + frame) * [0, 0, 0.2]
        positions = refinement.evaluate(cage.vertices + bend)
        low, high = positions[:, 2].min(), positions[:, 2].max()
        print(f"frame {frame}: {len(refinement.triangles):,} triangles from {low:.3f} to {high:.3f}")

    adaptive = karui.Adaptive(cage)
    camera = karui.Camera.looking_at(cage)
    for pixels in (4, 1, 0.25):
        seen = adaptive.refine(camera, size=(1280, 720), pixels=pixels)
        print(f"{len(seen.depths):7,} faces, off by at most {pixels} pixels: Catmull-Clark, as seen")


main()

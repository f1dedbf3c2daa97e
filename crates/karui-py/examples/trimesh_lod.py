"""Levels of detail of a trimesh object: python trimesh_lod.py [MODEL]"""

import sys

import karui

try:
    import trimesh
except ImportError:
    sys.exit("this example needs trimesh: pip install trimesh")


def main() -> None:
    if len(sys.argv) > 1:
        mesh = trimesh.load_mesh(sys.argv[1])
    else:
        mesh = trimesh.creation.torus(1.0, 0.4, major_sections=256, minor_sections=128)
    print(f"{len(mesh.faces):9,} triangles, area {mesh.area:.4f}")
    for level in karui.lod(mesh):
        coarse = trimesh.Trimesh(level.mesh.positions, level.mesh.triangles, process=False)
        print(
            f"{len(coarse.faces):9,} triangles, area {coarse.area:.4f}, "
            f"at most {level.max:.2e} off, shown beyond {level.switch_distance:.3f}"
        )


main()

"""Karui makes 3D models light: as much detail as is worth drawing, with measured errors.

Meshes go in and out as numpy arrays: positions (n, 3) float32 in model units, triangles (m, 3)
uint32. Functions that take a mesh take a `Mesh`, a pair `(positions, triangles)`, `Polygons`, or a
mesh of trimesh or pyvista, of which only the shape is taken. Long work runs without the GIL, can be
stopped with Ctrl-C, and tells `progress(stage, fraction)` what it does.

`karui.cluster` runs models that are larger than memory on many machines.
"""

from ._karui import (
    Adaptive,
    AdaptiveMesh,
    Camera,
    Change,
    ControlMesh,
    Cut,
    Distance,
    Hierarchy,
    Level,
    Limits,
    Mesh,
    OneWay,
    Plan,
    Polygons,
    Refinement,
    Scene,
    Simplified,
    Summary,
    __version__,
    lod,
    measure,
    read,
    render,
    saliency,
    saliency_weights,
    simplify,
    subdivide,
    vertex_distances,
    write,
)
from .errors import Cancelled, FileError, InputError, KaruiError

__all__ = [
    "Adaptive",
    "AdaptiveMesh",
    "Camera",
    "Cancelled",
    "Change",
    "ControlMesh",
    "Cut",
    "Distance",
    "FileError",
    "Hierarchy",
    "InputError",
    "KaruiError",
    "Level",
    "Limits",
    "Mesh",
    "OneWay",
    "Plan",
    "Polygons",
    "Refinement",
    "Scene",
    "Simplified",
    "Summary",
    "lod",
    "measure",
    "read",
    "render",
    "saliency",
    "saliency_weights",
    "simplify",
    "subdivide",
    "vertex_distances",
    "write",
]

from os import PathLike
from pathlib import Path
from typing import Any, Callable, Literal, Protocol, Sequence, Union, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = [
    "__version__",
    "Adaptive",
    "AdaptiveMesh",
    "Camera",
    "Change",
    "ControlMesh",
    "Cut",
    "Distance",
    "Hierarchy",
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

__version__: str

_Floats = NDArray[np.float32]
_Indices = NDArray[np.uint32]
_Point = Sequence[float]
_Path = Union[str, PathLike[str]]
_Progress = Callable[[str, float], Any]
_Quality = Literal["fast", "balanced", "exact"]
_Border = Literal["preserve", "lock", "free"]
_Kind = Literal[
    "curvature", "mesh", "image", "hybrid", "thesis2014", "lee2005", "itti1998"
]
_Stopped = Literal[
    "target", "error", "exhausted", "locked", "topology", "seams", "flips"
]
_SubdivScheme = Literal["catmull-clark", "sqrt2", "sqrt3", "loop", "bilinear"]
_Boundary = Literal["none", "edge", "corner"]
_CreaseMethod = Literal["uniform", "chaikin"]
_TriangleRule = Literal["catmull-clark", "smooth"]
_UvRule = Literal[
    "none", "corners-only", "corners-plus1", "corners-plus2", "boundaries", "all"
]

class _TrimeshLike(Protocol):
    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...

class _PyvistaLike(Protocol):
    @property
    def points(self) -> Any: ...
    @property
    def regular_faces(self) -> Any: ...

_MeshLike = Union[
    Mesh, Polygons, tuple[ArrayLike, ArrayLike], _TrimeshLike, _PyvistaLike
]
_Faces = Union[ArrayLike, Sequence[ArrayLike]]
_ControlLike = Union[
    ControlMesh,
    Mesh,
    Polygons,
    tuple[ArrayLike, _Faces],
    tuple[ArrayLike, ArrayLike, ArrayLike],
    _TrimeshLike,
    _PyvistaLike,
]

@final
class Mesh:
    @staticmethod
    def from_arrays(
        positions: ArrayLike,
        triangles: ArrayLike,
        *,
        normals: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        colors: ArrayLike | None = None,
        attributes: dict[str, ArrayLike] | None = None,
        face_attributes: dict[str, ArrayLike] | None = None,
    ) -> Mesh: ...
    @staticmethod
    def read(path: _Path) -> Mesh: ...
    def write(self, path: _Path) -> None: ...
    @property
    def positions(self) -> _Floats: ...
    @property
    def triangles(self) -> NDArray[np.uint32]: ...
    @property
    def normals(self) -> _Floats | None: ...
    @property
    def uvs(self) -> _Floats | None: ...
    @property
    def colors(self) -> _Floats | None: ...
    @property
    def attributes(self) -> dict[str, NDArray[Any]]: ...
    @property
    def face_attributes(self) -> dict[str, NDArray[Any]]: ...
    @property
    def bounds(self) -> list[list[float]]: ...

@final
class Scene:
    @property
    def meshes(self) -> list[Mesh]: ...
    @property
    def names(self) -> list[str | None]: ...
    @property
    def warnings(self) -> list[str]: ...
    def with_meshes(self, meshes: Sequence[_MeshLike]) -> Scene: ...
    def merged(self) -> Mesh: ...

def read(path: _Path) -> Scene: ...
def write(path: _Path, content: Scene | _MeshLike) -> list[str]: ...

@final
class Simplified:
    @property
    def mesh(self) -> Mesh: ...
    @property
    def error(self) -> float: ...
    @property
    def stopped(self) -> _Stopped: ...
    @property
    def collapses(self) -> int: ...

def simplify(
    mesh: _MeshLike,
    *,
    ratio: float | None = None,
    triangles: int | None = None,
    error: float | None = None,
    relative_error: float | None = None,
    quality: _Quality = "balanced",
    weights: ArrayLike | None = None,
    locks: ArrayLike | None = None,
    border: _Border = "preserve",
    placement: Literal["optimal", "half_edge"] = "optimal",
    regularity: float = 0.0,
    attribute_weight: float = 1.0,
    keep_topology: bool = False,
    progress: _Progress | None = None,
) -> Simplified: ...

@final
class Level:
    @property
    def mesh(self) -> Mesh: ...
    @property
    def error(self) -> float: ...
    @property
    def max(self) -> float: ...
    @property
    def mean(self) -> float: ...
    @property
    def rms(self) -> float: ...
    @property
    def switch_distance(self) -> float: ...
    @property
    def stopped(self) -> _Stopped: ...

def lod(
    mesh: _MeshLike,
    *,
    ratios: Sequence[float] | None = None,
    triangles: Sequence[int] | None = None,
    errors: Sequence[float] | None = None,
    levels: int = 5,
    min_triangles: int = 32,
    quality: _Quality = "balanced",
    weights: ArrayLike | None = None,
    border: _Border = "preserve",
    attribute_weight: float = 1.0,
    screen_height: float = 1080.0,
    fov_y: float = 1.0471975511965976,
    tolerance: float = 1.0,
    progress: _Progress | None = None,
) -> list[Level]: ...

@final
class OneWay:
    @property
    def max(self) -> float: ...
    @property
    def mean(self) -> float: ...
    @property
    def rms(self) -> float: ...
    @property
    def samples(self) -> int: ...
    @property
    def farthest(self) -> list[list[float]]: ...

@final
class Distance:
    @property
    def max(self) -> float: ...
    @property
    def mean(self) -> float: ...
    @property
    def rms(self) -> float: ...
    @property
    def diagonal(self) -> float: ...
    @property
    def a_to_b(self) -> OneWay: ...
    @property
    def b_to_a(self) -> OneWay: ...

def measure(
    a: _MeshLike,
    b: _MeshLike,
    *,
    samples: int = 500000,
    seed: int = 0,
    weights: ArrayLike | None = None,
    progress: _Progress | None = None,
) -> Distance: ...
def vertex_distances(mesh: _MeshLike, surface: _MeshLike) -> _Floats: ...
def saliency(
    mesh: _MeshLike,
    kind: _Kind = "mesh",
    *,
    smoothing: float | None = None,
    progress: _Progress | None = None,
) -> _Floats: ...
def saliency_weights(
    saliency: ArrayLike, *, most: float = 300.0, power: int = 8
) -> _Floats: ...

@final
class Camera:
    def __new__(
        cls,
        eye: _Point,
        target: _Point,
        *,
        up: _Point = (0.0, 1.0, 0.0),
        fov_y: float = 1.0,
        height: float | None = None,
        near: float | None = None,
        far: float | None = None,
    ) -> Camera: ...
    @staticmethod
    def looking_at(
        mesh: _MeshLike, direction: _Point = (0.4, 0.3, 1.0), *, fov_y: float = 0.7
    ) -> Camera: ...
    @property
    def eye(self) -> list[float]: ...
    @property
    def target(self) -> list[float]: ...

def render(
    content: Scene | _MeshLike,
    camera: Camera | None = None,
    *,
    size: tuple[int, int] = (512, 512),
    samples: int = 2,
) -> NDArray[np.uint8]: ...

@final
class Hierarchy:
    @staticmethod
    def build(
        mesh: _MeshLike,
        *,
        alpha: float = 10.0,
        weights: ArrayLike | None = None,
        locks: ArrayLike | None = None,
        progress: _Progress | None = None,
    ) -> Hierarchy: ...
    @staticmethod
    def load(path: _Path) -> Hierarchy: ...
    def save(self, path: _Path) -> None: ...
    def is_of(self, mesh: _MeshLike) -> bool: ...
    def coarsest(self) -> Cut: ...
    def finest(self) -> Cut: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def coarsest_triangle_count(self) -> int: ...

@final
class Cut:
    def refine(
        self,
        camera: Camera,
        *,
        size: tuple[int, int] = (1920, 1080),
        lights: Sequence[_Point] = (),
        triangles: int | None = None,
        area: float = 25.0,
        flatness: float = 3.0,
        silhouette: float | None = 4.0,
        light_silhouette: float | None = 4.0,
        highlight: float = 30.0,
        highlight_area: float = 4.0,
        hysteresis: float = 1.0,
    ) -> Change: ...
    @property
    def indices(self) -> NDArray[np.uint32]: ...
    def to_mesh(self, mesh: _MeshLike) -> Mesh: ...

@final
class Change:
    @property
    def ranges(self) -> list[tuple[int, int]]: ...
    @property
    def triangles(self) -> int: ...
    @property
    def splits(self) -> int: ...
    @property
    def collapses(self) -> int: ...
    @property
    def floor(self) -> float: ...

@final
class Plan:
    @staticmethod
    def create(
        store: _Path,
        model: _Path,
        *,
        ratio: float | None = None,
        triangles: int | None = None,
        error: float | None = None,
        memory_limit: int | None = None,
        block_triangles: int | None = None,
        scheme: Literal["cells", "sweep", "slabs"] = "cells",
    ) -> Plan: ...
    @classmethod
    def open(cls, store: _Path) -> Plan: ...
    @property
    def store(self) -> Path: ...
    @property
    def model(self) -> str: ...
    def run(
        self, *, memory_limit: int | None = None, progress: _Progress | None = None
    ) -> None: ...
    def write(self, path: _Path, *, progress: _Progress | None = None) -> Summary: ...
    def verify(self) -> list[str]: ...
    def next(self) -> tuple[str, int] | None: ...
    def run_task(self, phase: str, row: int) -> dict[str, Any]: ...
    def verify_task(self, phase: str, row: int) -> dict[str, Any] | None: ...
    def commit(self, phase: str, results: Sequence[dict[str, Any]]) -> None: ...

@final
class Summary:
    @property
    def input(self) -> int: ...
    @property
    def vertices(self) -> int: ...
    @property
    def triangles(self) -> int: ...
    @property
    def error(self) -> float: ...

@final
class ControlMesh:
    @staticmethod
    def from_arrays(
        positions: ArrayLike,
        faces: _Faces,
        offsets: ArrayLike | None = None,
        *,
        creases: ArrayLike | None = None,
        crease_sharpness: ArrayLike | None = None,
        corners: ArrayLike | None = None,
        corner_sharpness: ArrayLike | None = None,
        holes: ArrayLike | None = None,
        uvs: ArrayLike | None = None,
        uv_indices: ArrayLike | None = None,
        colors: ArrayLike | None = None,
    ) -> ControlMesh: ...
    @staticmethod
    def read(path: _Path) -> ControlMesh: ...
    @property
    def positions(self) -> _Floats: ...
    @property
    def indices(self) -> _Indices: ...
    @property
    def offsets(self) -> _Indices: ...
    @property
    def creases(self) -> _Indices: ...
    @property
    def crease_sharpness(self) -> _Floats: ...
    @property
    def corners(self) -> _Indices: ...
    @property
    def corner_sharpness(self) -> _Floats: ...
    @property
    def holes(self) -> _Indices: ...
    @property
    def uvs(self) -> _Floats | None: ...
    @property
    def uv_indices(self) -> _Indices | None: ...
    @property
    def colors(self) -> _Floats | None: ...
    @property
    def warnings(self) -> list[str]: ...

@final
class Polygons:
    @property
    def positions(self) -> _Floats: ...
    @property
    def indices(self) -> _Indices: ...
    @property
    def offsets(self) -> _Indices: ...
    @property
    def faces(self) -> _Indices | None: ...
    @property
    def normals(self) -> _Floats | None: ...
    @property
    def uvs(self) -> _Floats | None: ...
    @property
    def colors(self) -> _Floats | None: ...
    def to_mesh(self) -> Mesh: ...

def subdivide(
    cage: _ControlLike,
    levels: int = 1,
    scheme: _SubdivScheme = "catmull-clark",
    *,
    boundary: _Boundary | None = None,
    crease_method: _CreaseMethod | None = None,
    triangle_rule: _TriangleRule | None = None,
    uv_rule: _UvRule | None = None,
    limit: bool = False,
    normals: bool = False,
    uvs: bool = True,
    max_faces: int = 268435456,
    progress: _Progress | None = None,
) -> Polygons: ...

@final
class Refinement:
    def __new__(
        cls,
        cage: _ControlLike,
        levels: int = 1,
        scheme: _SubdivScheme = "catmull-clark",
        *,
        boundary: _Boundary | None = None,
        crease_method: _CreaseMethod | None = None,
        triangle_rule: _TriangleRule | None = None,
        uv_rule: _UvRule | None = None,
        max_faces: int = 268435456,
        progress: _Progress | None = None,
    ) -> Refinement: ...
    def face_varying(self, indices: ArrayLike, count: int) -> Refinement: ...
    def evaluate(self, values: ArrayLike) -> _Floats: ...
    def limits(self, positions: ArrayLike) -> Limits: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def face_count(self) -> int: ...
    @property
    def indices(self) -> _Indices: ...
    @property
    def offsets(self) -> _Indices: ...
    @property
    def faces(self) -> _Indices | None: ...
    @property
    def triangles(self) -> _Indices: ...
    @property
    def parents(self) -> _Indices: ...
    @property
    def holes(self) -> NDArray[np.bool_]: ...

@final
class Limits:
    @property
    def positions(self) -> _Floats: ...
    @property
    def tangents(self) -> _Floats: ...
    @property
    def normals(self) -> _Floats: ...
    @property
    def one_sided(self) -> NDArray[np.bool_]: ...

@final
class Adaptive:
    def __new__(
        cls,
        cage: _ControlLike,
        *,
        boundary: _Boundary | None = None,
        crease_method: _CreaseMethod | None = None,
        triangle_rule: _TriangleRule | None = None,
    ) -> Adaptive: ...
    def move_cage(self, positions: ArrayLike) -> None: ...
    def refine(
        self,
        camera: Camera,
        *,
        size: tuple[int, int] = (1920, 1080),
        pixels: float | None = None,
        silhouette_pixels: float | None = None,
        terminator_pixels: float | None = None,
        side_pixels: float | None = None,
        lights: Sequence[_Point] = (),
        depth_front: int | None = None,
        depth_silhouette: int | None = None,
        depth_hidden: int = 0,
        two_sided: bool = False,
        limit: bool = True,
        max_faces: int = 4000000,
        max_kept: int = 4000000,
    ) -> AdaptiveMesh: ...
    @property
    def kept(self) -> int: ...

@final
class AdaptiveMesh:
    @property
    def mesh(self) -> Polygons: ...
    @property
    def parents(self) -> _Indices: ...
    @property
    def depths(self) -> NDArray[np.uint8]: ...
    @property
    def points(self) -> _Indices: ...
    @property
    def truncated(self) -> bool: ...

# What _retalho.pyi calls its types; there is no such module when the program runs.
from collections.abc import Callable
from os import PathLike
from typing import Literal, NotRequired, Protocol, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.uint32]
Path: TypeAlias = str | PathLike[str]
Transform: TypeAlias = tuple[float, float, float, float, float, float]
Progress: TypeAlias = Callable[[str, float], object]
Surface: TypeAlias = Literal["linear", "powell-sabin", "clough-tocher"]
Gradients: TypeAlias = Literal["normals", "quadratic", "network"]
CrossDerivative: TypeAlias = Literal["perpendicular", "cubic"]
Voids: TypeAlias = Literal["transparent", "blocks"]
Quantity: TypeAlias = Literal["height", "gradient", "slope", "aspect", "normal", "curvature"]
Parameters: TypeAlias = Literal["uniform", "centripetal", "chord", "x"]
Recovery: TypeAlias = Literal["smooth", "spr", "barycentric"]
Layout: TypeAlias = Literal["delaunay", "midpoint"]
Box: TypeAlias = tuple[float, float, float, float]
CurvePlace: TypeAlias = tuple[float, tuple[float, ...], float]
PatchStyle: TypeAlias = Literal["shaded", "lines", "isophotes", "zebra", "gaussian", "mean"]
Look: TypeAlias = tuple[bool, int, float, float]
Samples: TypeAlias = Literal["parameter", "arc-length"]

class _HasWkt(Protocol):
    def to_wkt(self) -> str: ...

Crs: TypeAlias = str | _HasWkt
class MeshCheck(TypedDict):
    watertight: bool
    open_edges: int
    boundary_edges: int
    cracks: int
    nonmanifold_edges: int
    degenerate_triangles: int
    components: int

class Join(TypedDict):
    at: float
    point: tuple[float, ...]
    C: int
    G: int
    kind: str
    gap: float
    angle: float
    curvature_gap: float
    speed_ratio: float

class PatchJoin(TypedDict):
    patches: tuple[int, int]
    sides: tuple[int, int]
    watertight: bool
    gap: float
    angle: float
    at: float
    point: tuple[float, float, float]
    kind: Literal["G0", "G1"]

class Comparison(TypedDict):
    name: str
    surface: str
    gradients: str
    cross_derivative: NotRequired[str]
    vertices: int
    triangles: int
    coefficients: int
    numbers: int
    bytes: int
    rmse: float
    max_error: float
    max_error_at: tuple[float, float]
    slope_rmse: float
    cells: int
    valid_cells: int
    uncovered: int
    violations: int
    visibility_rmse: NotRequired[float]
    visibility_max: NotRequired[float]
    visibility_mean: NotRequired[float]
    visibility_cells: NotRequired[int]
    visibility_difference: NotRequired[NDArray[np.float32]]

class FitReport(TypedDict):
    points: int
    used: int
    resolution: int
    coefficients: int
    crossed: int
    residual_mean: float
    residual_quantile: float
    residual_max: float
    outliers: int
    open_faces: int

class SurfacePart(TypedDict):
    points: int
    triangles: int
    area: float
    low: tuple[float, float, float]
    high: tuple[float, float, float]

class PatchReport(TypedDict):
    boundary_gap: float
    gradient_jump: float
    folds: int
    turned: int

class BSpline(TypedDict):
    degree: int
    knots: Floats
    points: Floats
    weights: Floats | None

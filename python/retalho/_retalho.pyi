# The types of the extension module; what things mean stands in their docstrings (help(retalho.fit)). The ignored
# overloads: a float is an ArrayLike, too, and gives a float.
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ._shapes import (
    Curve as Curve, Graph as Graph, LevelSet as LevelSet, Mesh as Mesh, Patch as Patch, PatchSet as PatchSet,
    Points as Points, RayHits as RayHits, TetraQuad as TetraQuad, draw_curves as draw_curves,
    estimate_normals as estimate_normals, read_curves as read_curves, read_lines as read_lines,
    read_mesh as read_mesh, read_patches as read_patches, read_points as read_points,
    read_quadrics as read_quadrics, write_curves as write_curves,
)
from ._types import (
    Box, Comparison, CrossDerivative, Crs, Floats, Gradients, Indices, Look, Path, Progress, Quantity, Surface,
    Transform, Voids,
)

__version__: str

# An xarray.DataArray is an ArrayLike by its __array__.
Heights: TypeAlias = ArrayLike | Path | Grid | Terrain

class Error(Exception):
    kind: str
    file: str
    where: str

class UsageError(Error, ValueError): ...
class BadInput(Error, ValueError): ...
class CannotRead(Error, OSError): ...
class CannotWrite(Error, OSError): ...

class Grid:
    def __init__(
        self, z: Heights, *, transform: ArrayLike | None = None, crs: Crs | None = None, nodata: float | None = None,
        threads: int = 0, progress: Progress | None = None,
    ) -> None: ...
    @property
    def heights(self) -> NDArray[np.float32] | Floats: ...
    @property
    def transform(self) -> Transform: ...
    @property
    def crs(self) -> str | None: ...
    @property
    def unit(self) -> str: ...
    @property
    def shape(self) -> tuple[int, int]: ...
    def write(
        self, path: Path, *, cog: bool = False, overwrite: bool = False, threads: int = 0,
        progress: Progress | None = None,
    ) -> None: ...
    def __array__(self, dtype: DTypeLike = None) -> NDArray[Any]: ...

class ErrorReport:
    @property
    def cells(self) -> int: ...
    @property
    def valid_cells(self) -> int: ...
    @property
    def uncovered(self) -> int: ...
    @property
    def violations(self) -> int: ...
    @property
    def rmse(self) -> float: ...
    @property
    def max_error(self) -> float: ...
    @property
    def max_error_at(self) -> tuple[float, float]: ...
    @property
    def slope_rmse(self) -> float: ...

class Terrain:
    @overload
    def __call__(self, x: float, y: float, *, threads: int = 0) -> float: ...  # type: ignore[misc]
    @overload
    def __call__(self, x: ArrayLike, y: ArrayLike, *, threads: int = 0) -> Floats: ...
    def gradient(self, x: ArrayLike, y: ArrayLike, *, threads: int = 0) -> Floats: ...
    @overload
    def slope(self, x: float, y: float, *, threads: int = 0) -> float: ...  # type: ignore[misc]
    @overload
    def slope(self, x: ArrayLike, y: ArrayLike, *, threads: int = 0) -> Floats: ...
    @overload
    def aspect(self, x: float, y: float, *, threads: int = 0) -> float: ...  # type: ignore[misc]
    @overload
    def aspect(self, x: ArrayLike, y: ArrayLike, *, threads: int = 0) -> Floats: ...
    def normal(self, x: ArrayLike, y: ArrayLike, *, threads: int = 0) -> Floats: ...
    @overload
    def curvature(self, x: float, y: float, *, threads: int = 0) -> float: ...  # type: ignore[misc]
    @overload
    def curvature(self, x: ArrayLike, y: ArrayLike, *, threads: int = 0) -> Floats: ...
    def sample(
        self, transform: ArrayLike | None = None, shape: tuple[int, int] | None = None, *, what: Quantity = "height",
        threads: int = 0, progress: Progress | None = None,
    ) -> Floats: ...
    def compare(
        self, z: Heights, *, transform: ArrayLike | None = None, crs: Crs | None = None, nodata: float | None = None,
        threads: int = 0, progress: Progress | None = None,
    ) -> ErrorReport: ...
    def compare_points(
        self, points: ArrayLike, *, threads: int = 0, progress: Progress | None = None
    ) -> ErrorReport: ...
    def contours(
        self, levels: ArrayLike | None = None, *, interval: float | None = None, base: float = 0.0,
        tolerance: float | None = None, simplify: bool = True, bands: bool = False, threads: int = 0,
        progress: Progress | None = None,
    ) -> Contours: ...
    def conics(
        self, levels: ArrayLike | None = None, *, interval: float | None = None, base: float = 0.0, threads: int = 0,
        progress: Progress | None = None,
    ) -> list[tuple[float, Curve]]: ...
    def mesh(self, *, tolerance: float = 0.0, threads: int = 0, progress: Progress | None = None) -> Mesh: ...
    def write_quantized_mesh(
        self, folder: Path, *, tolerance: float = 0.0, level: int = -1, outside: float = 0.0, normals: bool = True,
        gzip: bool = True, overwrite: bool = False, threads: int = 0, progress: Progress | None = None,
    ) -> dict[str, float]: ...
    def write_tileset(
        self, folder: Path, *, tolerance: float = 0.0, triangles: int = 65536, overwrite: bool = False,
        threads: int = 0, progress: Progress | None = None,
    ) -> dict[str, float]: ...
    @property
    def surface(self) -> str: ...
    @property
    def gradients(self) -> str: ...
    @property
    def cross_derivative(self) -> str: ...
    @property
    def coefficients(self) -> int: ...
    @property
    def numbers(self) -> int: ...
    @property
    def creases(self) -> int: ...
    @property
    def bounds(self) -> Box: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def vertices(self) -> Floats: ...
    @property
    def triangles(self) -> Indices: ...
    @property
    def vertex_gradients(self) -> Floats: ...
    @property
    def crs(self) -> str | None: ...
    @property
    def unit(self) -> str: ...
    @property
    def shape(self) -> tuple[int, int] | None: ...
    @property
    def transform(self) -> Transform | None: ...
    def save(self, path: Path, *, overwrite: bool = False) -> None: ...
    def to_bytes(self) -> bytes: ...

class Bicubic:
    def __init__(
        self, z: Heights, *, transform: ArrayLike | None = None, crs: Crs | None = None, nodata: float | None = None,
        twist: Literal["spline", "adini", "zero"] = "spline", ends: Literal["not-a-knot", "natural"] = "not-a-knot",
        keep_flats: bool = True, threads: int = 0, progress: Progress | None = None,
    ) -> None: ...
    @overload
    def __call__(self, x: float, y: float, *, threads: int = 0) -> float: ...  # type: ignore[misc]
    @overload
    def __call__(self, x: ArrayLike, y: ArrayLike, *, threads: int = 0) -> Floats: ...
    def gradient(self, x: ArrayLike, y: ArrayLike, *, threads: int = 0) -> Floats: ...
    @property
    def shape(self) -> tuple[int, int]: ...

class ContourLine:
    level: Final[float]
    closed: Final[bool]
    points: Final[Floats]
    def __array__(self, dtype: DTypeLike = None) -> NDArray[Any]: ...
    def __len__(self) -> int: ...

class Band:
    low: Final[float | None]
    high: Final[float | None]
    outer: Final[Floats]
    holes: Final[list[Floats]]

class Contours:
    def __len__(self) -> int: ...
    def __getitem__(self, index: int) -> ContourLine: ...
    def __iter__(self) -> Iterator[ContourLine]: ...
    @property
    def levels(self) -> Floats: ...
    @property
    def points(self) -> Floats: ...
    @property
    def offsets(self) -> NDArray[np.uint64]: ...
    @property
    def bands(self) -> list[Band] | None: ...
    @property
    def singular(self) -> list[tuple[float, tuple[float, float, float, float]]]: ...
    @property
    def tolerance(self) -> float: ...
    @property
    def crs(self) -> str | None: ...
    def write(self, path: Path, *, overwrite: bool = False, index_every: int = 5) -> None: ...

class SightLine:
    visible: Final[bool]
    clearance: Final[float]
    fresnel_clear: Final[float]
    blocked_at: Final[float]
    profile: Final[Floats]
    def write(self, path: Path, *, overwrite: bool = False) -> None: ...

class TileEntry:
    row: Final[int]
    column: Final[int]
    file: Final[str]
    bytes: Final[int]
    vertices: Final[int]
    triangles: Final[int]
    checksum: Final[str]
    cells: Final[tuple[int, int, int, int]]

class TilePlan:
    def __init__(
        self, source: Path, *, size: int = 1024, max_error: float | None = None, vertices: int | None = None,
        ratio: float | None = None, surface: Literal["linear", "powell-sabin", "clough-tocher"] = "clough-tocher",
        fit: Literal["interpolate", "least-squares"] = "interpolate", band: int = 1, nodata: float | None = None,
    ) -> None: ...
    settled: Final[bool]
    max_error: Final[float | None]
    def look(self, row: int, column: int) -> Look: ...
    def areas(self, looks: Sequence[Look], row: int, column: int) -> list[bool]: ...
    def count(self, row: int, column: int, max_error: float, areas: Sequence[bool]) -> int: ...
    def settle(self, looks: Sequence[Look], count: Callable[[float], int]) -> TilePlan: ...
    shape: Final[tuple[int, int]]
    tiles: Final[tuple[int, int]]
    def check(self, folder: Path, *, overwrite: bool = False) -> None: ...
    def tin_name(self, row: int, column: int) -> str: ...
    def make_tin(self, row: int, column: int, name: str, folder: Path) -> None: ...
    def make_tile(self, row: int, column: int, tins: Sequence[str], folder: Path) -> TileEntry: ...
    def around(self, tins: Sequence[str], row: int, column: int) -> list[str]: ...
    def missing(self, tins: Sequence[str], folder: Path) -> tuple[list[int], list[int]]: ...
    def finish(
        self, entries: Sequence[TileEntry], tins: Sequence[str], folder: Path, *, overwrite: bool = False
    ) -> None: ...
    def make(
        self, folder: Path, *, jobs: int = 0, overwrite: bool = False, threads: int = 0,
        progress: Progress | None = None,
    ) -> None: ...

class TiledModel:
    def __init__(self, folder: Path, *, memory: float = 512.0) -> None: ...
    @overload
    def __call__(self, x: float, y: float) -> float: ...  # type: ignore[misc]
    @overload
    def __call__(self, x: ArrayLike, y: ArrayLike) -> Floats: ...
    def gradient(self, x: ArrayLike, y: ArrayLike) -> Floats: ...
    @overload
    def slope(self, x: float, y: float) -> float: ...  # type: ignore[misc]
    @overload
    def slope(self, x: ArrayLike, y: ArrayLike) -> Floats: ...
    @overload
    def aspect(self, x: float, y: float) -> float: ...  # type: ignore[misc]
    @overload
    def aspect(self, x: ArrayLike, y: ArrayLike) -> Floats: ...
    def normal(self, x: ArrayLike, y: ArrayLike) -> Floats: ...
    @overload
    def curvature(self, x: float, y: float) -> float: ...  # type: ignore[misc]
    @overload
    def curvature(self, x: ArrayLike, y: ArrayLike) -> Floats: ...
    def sample(
        self, transform: ArrayLike | None = None, shape: tuple[int, int] | None = None, *, what: Quantity = "height",
        threads: int = 0, progress: Progress | None = None,
    ) -> Floats: ...
    def window(
        self, row: int, column: int, rows: int, columns: int, *, threads: int = 0, progress: Progress | None = None
    ) -> Grid: ...
    def part(self, bounds: ArrayLike) -> Terrain: ...
    def compare(self, z: Heights, *, threads: int = 0, progress: Progress | None = None) -> ErrorReport: ...
    def contours(
        self, levels: ArrayLike | None = None, *, interval: float | None = None, base: float = 0.0,
        tolerance: float | None = None, simplify: bool = True, threads: int = 0, progress: Progress | None = None,
    ) -> Contours: ...
    def write_contours(
        self, path: Path, levels: ArrayLike | None = None, *, interval: float | None = None, base: float = 0.0,
        tolerance: float | None = None, simplify: bool = True, overwrite: bool = False, index_every: int = 5,
        threads: int = 0, progress: Progress | None = None,
    ) -> dict[str, int]: ...
    def write_raster(
        self, path: Path, transform: ArrayLike | None = None, shape: tuple[int, int] | None = None, *,
        what: Literal["height", "slope", "aspect", "curvature"] = "height", cog: bool = False,
        overwrite: bool = False, threads: int = 0, progress: Progress | None = None,
    ) -> dict[str, int]: ...
    def write_mesh(
        self, path: Path, *, tolerance: float = 0.0, overwrite: bool = False, threads: int = 0,
        progress: Progress | None = None,
    ) -> dict[str, float]: ...
    shape: Final[tuple[int, int]]
    transform: Final[Transform]
    crs: Final[str | None]
    surface: Final[str]
    tolerance: Final[float]
    tile_size: Final[int]
    tiles: Final[list[TileEntry]]
    reads: Final[int]

def read_grid(
    path: Path, *, band: int = 1, nodata: float | None = None, threads: int = 0, progress: Progress | None = None
) -> Grid: ...
def fit(
    z: Heights, *, transform: ArrayLike | None = None, crs: Crs | None = None, nodata: float | None = None,
    max_error: float | None = None, vertices: int | None = None, ratio: float | None = None,
    surface: Surface = "clough-tocher", gradients: Gradients | None = None, cross_derivative: CrossDerivative = ...,
    fit: Literal["interpolate", "least-squares", "z-only"] | None = None,
    refine: Literal["flat", "surface"] | None = None, effort: Literal["fast", "normal", "best"] | None = None,
    creases: Literal["none", "auto"] | Sequence[ArrayLike] | None = None,
    threads: int = 0, progress: Progress | None = None,
) -> Terrain: ...
def fit_compact(
    z: Heights, *, transform: ArrayLike | None = None, crs: Crs | None = None, nodata: float | None = None,
    max_error: float | None = None, vertices: int | None = None, ratio: float | None = None,
    surface: Literal["linear", "clough-tocher"] = ..., fit: Literal["least-squares", "z-only"] = ...,
    creases: Literal["auto", "none"] | None = None, effort: Literal["fast", "normal", "best"] = ...,
    threads: int = 0, progress: Progress | None = None,
) -> bytes: ...
def fit_points(
    points: ArrayLike, *, crs: Crs | None = None, max_error: float | None = None, vertices: int | None = None,
    ratio: float | None = None, surface: Surface = "clough-tocher", gradients: Gradients | None = None,
    cross_derivative: CrossDerivative = "perpendicular", breaklines: Sequence[ArrayLike] | None = None,
    threads: int = 0, progress: Progress | None = None,
) -> Terrain: ...
def compare(
    z: Heights, models: Terrain | Path | Sequence[Terrain | Path] | Mapping[str, Terrain | Path] | None = None, *,
    transform: ArrayLike | None = None, crs: Crs | None = None, nodata: float | None = None,
    max_error: float | None = None, vertices: int | None = None, ratio: float | None = None, baselines: bool = False,
    visibility: float | None = None, directions: int = 180, observer_height: float = 2.0, target_height: float = 0.0,
    threads: int = 0, progress: Progress | None = None,
) -> list[Comparison]: ...
def contours(
    z: Heights, levels: ArrayLike | None = None, *, transform: ArrayLike | None = None, crs: Crs | None = None,
    nodata: float | None = None, interval: float | None = None, base: float = 0.0, tolerance: float | None = None,
    simplify: bool = True, bands: bool = False, twist: Literal["spline", "adini", "zero"] = "spline",
    ends: Literal["not-a-knot", "natural"] = "not-a-knot", keep_flats: bool = True, threads: int = 0,
    progress: Progress | None = None,
) -> Contours: ...
@overload
def viewshed(
    z: Heights, observers: ArrayLike, *, what: Literal["visible"] = "visible", transform: ArrayLike | None = None,
    crs: Crs | None = None, nodata: float | None = None, observer_height: float = 2.0, target_height: float = 0.0,
    radius: float = 0.0, azimuth: ArrayLike | None = None, vertical: ArrayLike | None = None,
    earth_curvature: bool = False, refraction: float = 0.13, voids: Voids = "transparent", exact: bool = False,
    threads: int = 0, progress: Progress | None = None,
) -> NDArray[np.bool_]: ...
@overload
def viewshed(
    z: Heights, observers: ArrayLike, *, what: Literal["count"], transform: ArrayLike | None = None,
    crs: Crs | None = None, nodata: float | None = None, observer_height: float = 2.0, target_height: float = 0.0,
    radius: float = 0.0, azimuth: ArrayLike | None = None, vertical: ArrayLike | None = None,
    earth_curvature: bool = False, refraction: float = 0.13, voids: Voids = "transparent", exact: bool = False,
    threads: int = 0, progress: Progress | None = None,
) -> NDArray[np.uint32]: ...
@overload
def viewshed(
    z: Heights, observers: ArrayLike, *, what: Literal["height"], transform: ArrayLike | None = None,
    crs: Crs | None = None, nodata: float | None = None, observer_height: float = 2.0, target_height: float = 0.0,
    radius: float = 0.0, azimuth: ArrayLike | None = None, vertical: ArrayLike | None = None,
    earth_curvature: bool = False, refraction: float = 0.13, voids: Voids = "transparent", exact: bool = False,
    threads: int = 0, progress: Progress | None = None,
) -> NDArray[np.float32]: ...
def intervisibility(
    z: Heights, *, transform: ArrayLike | None = None, crs: Crs | None = None, nodata: float | None = None,
    directions: int = 180, observer_height: float = 2.0, target_height: float = 0.0, radius: float = 0.0,
    stride: int | None = None, threads: int = 0, progress: Progress | None = None,
) -> NDArray[np.float32]: ...
def line_of_sight(
    z: Heights | TiledModel, observer: ArrayLike, target: ArrayLike, *, transform: ArrayLike | None = None,
    crs: Crs | None = None, nodata: float | None = None, observer_height: float = 2.0, target_height: float = 0.0,
    frequency: float = 0.0, earth_curvature: bool = False, refraction: float = 0.13, voids: Voids = "transparent",
    exact: bool = False, threads: int = 0, progress: Progress | None = None,
) -> SightLine: ...
def load(path: Path) -> Terrain | TetraQuad | PatchSet: ...
def from_bytes(data: bytes) -> Terrain | TetraQuad | PatchSet: ...
def render(
    z: Heights, *, transform: ArrayLike | None = None, crs: Crs | None = None, nodata: float | None = None,
    size: tuple[int, int] = (640, 480), view: Literal["plan", "perspective"] = "plan",
    colors: Literal["hypsometric", "gray"] = "hypsometric", light: tuple[float, float] = (315.0, 45.0),
    exaggeration: float | None = None, from_: float = 200.0, elevation: float = 35.0,
    limits: tuple[float, float] | None = None, error: Heights | None = None, threads: int = 0,
    progress: Progress | None = None,
) -> NDArray[np.uint8]: ...
def compare_surfaces(
    z: Heights, path: Path, levels: ArrayLike | None = None, *, transform: ArrayLike | None = None,
    crs: Crs | None = None, nodata: float | None = None, interval: float | None = None, base: float = 0.0,
    tolerance: float | None = None, zoom: int = 48, index_every: int = 5, overwrite: bool = False, threads: int = 0,
    progress: Progress | None = None,
) -> list[str]: ...
def map_sheet(
    z: Heights, path: Path, levels: ArrayLike | None = None, *, transform: ArrayLike | None = None,
    crs: Crs | None = None, nodata: float | None = None, interval: float | None = None, base: float = 0.0,
    tolerance: float | None = None, bands: bool = False, curves: bool = False, title: str = "", size: str = "A4",
    index_every: int = 5, overwrite: bool = False, threads: int = 0, progress: Progress | None = None,
) -> dict[str, float]: ...

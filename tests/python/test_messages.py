"""What the module refuses, in its own words: one row a message. That types are wrong is what many rows are for."""
# mypy: disable-error-code="arg-type, call-overload"
from __future__ import annotations

import pathlib
import re
from collections.abc import Callable

import numpy as np
import pytest
import retalho
import xarray

Z = np.add.outer(np.arange(12.0), 2 * np.arange(15.0)) + np.cos(np.arange(15.0))
POINTS = np.array([[0, 0, 1], [10, 0, 2], [0, 10, 3], [10, 11, 5], [4, 6, 2]], dtype=np.float64)
CURVES = [retalho.Curve.bezier(np.array(p, dtype=np.float64)) for p in ([[0, 0, 0], [1, 0, 0]], [[1, 0, 0], [0, 1, 0]], [[0, 1, 0], [0, 0, 0]])]
NAN = float("nan")


def model() -> retalho.Terrain:
    return retalho.fit(Z, max_error=1, refine="flat")


def ball() -> retalho.TetraQuad:
    """Of points on the unit sphere."""
    z = np.linspace(-0.99, 0.99, 200)
    a, r = np.arange(200) * 2.399963, np.sqrt(1 - z * z)
    places = np.stack([r * np.cos(a), r * np.sin(a), z], axis=1)
    return retalho.TetraQuad.fit(places, places, resolution=4, solver="local")


def plan(folder: pathlib.Path, **options: object) -> retalho.TilePlan:
    """Of a grid of 15 x 12 cells in a file."""
    file = folder / "grid.asc"
    rows = "\n".join(" ".join(f"{v:.3f}" for v in row) for row in Z)
    file.write_text(f"ncols 15\nnrows 12\nxllcorner 0\nyllcorner 0\ncellsize 1\n{rows}\n")
    return retalho.TilePlan(file, **(options or {"max_error": 1.0, "size": 16}))


def tiles(folder: pathlib.Path) -> retalho.TiledModel:
    plan(folder).make(folder / "tiles")
    return retalho.TiledModel(folder / "tiles")


def void(folder: pathlib.Path) -> retalho.TiledModel:
    """A tiled model whose tiles are all said to hold nothing."""
    plan(folder).make(folder / "tiles")
    index = folder / "tiles" / "index.json"
    index.write_text(re.sub(r'"file": *"[^"]*"', '"file": null', index.read_text()))
    return retalho.TiledModel(folder / "tiles")


ROWS: list[tuple[str, Callable[[], object]]] = [
    # arrays
    ("points must have the shape (n, 3)", lambda: retalho.fit_points(np.zeros((4, 5)))),
    ("must have the shape (n,), not", lambda: retalho.Curve.bezier(np.zeros((4, 2)), weights=np.ones((2, 2)))),
    ("do not go together: their shapes are", lambda: model()(np.zeros((2, 2)), np.zeros((3,)))),
    ("points have 2 coordinates and tangents 3", lambda: retalho.Curve.hermite(np.zeros((3, 2)), np.zeros((3, 3)))),
    # grids
    ("z must have the shape (rows, columns), not", lambda: retalho.fit(np.zeros((3, 3, 3)), max_error=1)),
    ("a side may have at most 65,535 cells", lambda: retalho.fit(np.zeros((1, 70000)), max_error=1)),
    ("crs without transform: where the cells lie in it is not known", lambda: retalho.fit(Z, max_error=1, crs="EPSG:25832")),
    ("transform must be six numbers (a, b, c, d, e, f)", lambda: retalho.fit(Z, max_error=1, transform=(1, 2))),
    ("transform holds a number that is not finite", lambda: retalho.fit(Z, max_error=1, transform=(1, 0, NAN, 0, -1, 0))),
    # fit
    ("must be one of 'linear', 'powell-sabin'", lambda: retalho.fit(Z, max_error=1, surface="smoth")),
    ("effort moves the vertices of a surface: refine='flat' has none to move", lambda: retalho.fit(Z, max_error=1, refine="flat", effort="best")),
    ("gradients exclude fit='least-squares', fit='z-only' and refine='surface', which set them",
     lambda: retalho.fit(Z, max_error=1, refine="surface", gradients="normals")),
    ("heights alone are refined to a number of vertices, not to a largest error", lambda: retalho.fit(Z, max_error=1, refine="surface", fit="z-only")),
    ("refine='surface' takes a max_error over 0", lambda: retalho.fit(Z, max_error=0, refine="surface")),
    ("creases have gradients of their own on each side: leave fit='z-only' out", lambda: retalho.fit(Z, vertices=30, creases="auto", fit="z-only")),
    ("creases go with refine='surface'", lambda: retalho.fit(Z, vertices=30, creases="auto", refine="flat")),
    ("z must be a DataArray of two dimensions, not ('y', 'x', 'band'): select the others first, as in z.squeeze() or z.isel(band=0)",
     lambda: retalho.fit(xarray.DataArray(np.zeros((3, 3, 2)), dims=("y", "x", "band")), max_error=1)),
    ("a least-squares fit takes cross_derivative='perpendicular'", lambda: retalho.fit(Z, max_error=1, fit="least-squares", cross_derivative="cubic")),
    ("there are no points", lambda: retalho.fit_points(np.zeros((0, 3)))),
    ("points holds a coordinate that is not finite", lambda: retalho.fit_points(np.array([[0, 0, 1], [1, 0, NAN], [0, 1, 2]]))),
    ("threads must be 0 (all cores) or more, not -1", lambda: retalho.fit(Z, max_error=1, threads=-1)),
    # compact
    ("give max_error, vertices or both", lambda: retalho.fit_compact(Z)),
    ("max_error must be over 0, not 0", lambda: retalho.fit_compact(Z, max_error=0)),
    ("surface must be 'linear' or 'clough-tocher', not 'powell-sabin'", lambda: retalho.fit_compact(Z, max_error=1, surface="powell-sabin")),
    ("fit must be 'least-squares' or 'z-only', not 'quick'", lambda: retalho.fit_compact(Z, max_error=1, fit="quick")),
    ("creases of a compact file must be 'auto' or 'none', not 'all'", lambda: retalho.fit_compact(Z, max_error=1, creases="all")),
    ("creases='auto' folds vertices that have gradients", lambda: retalho.fit_compact(Z, max_error=1, surface="linear", creases="auto")),
    ("fit='z-only' is for surface='clough-tocher'", lambda: retalho.fit_compact(Z, max_error=1, surface="linear", fit="z-only")),
    # terrain
    ("is none of height, gradient, slope, aspect, normal, curvature", lambda: model().sample(what="warmth")),
    ("give transform and shape, or neither (the model's own grid)", lambda: model().sample(shape=(3, 3))),
    # contours and bicubic
    ("twist must be 'spline', 'adini' or 'zero', not 'none'", lambda: retalho.Bicubic(Z, twist="none")),
    ("ends must be 'not-a-knot' or 'natural', not 'free'", lambda: retalho.Bicubic(Z, ends="free")),
    ("say which levels: levels=[...], or interval=... (with base=...)", lambda: retalho.contours(Z)),
    ("levels holds nan", lambda: retalho.contours(Z, [1.0, NAN])),
    ("z holds no data", lambda: retalho.contours(np.full((4, 4), NAN), interval=1.0)),
    # pictures
    ("size must be (width, height), 16 to 20,000 pixels each, not (3, 3)", lambda: retalho.render(Z, size=(3, 3))),
    ("view must be 'plan' or 'perspective', not 'side'", lambda: retalho.render(Z, view="side")),
    ("colors must be 'hypsometric' or 'gray', not 'red'", lambda: retalho.render(Z, colors="red")),
    ("light must be (azimuth, altitude), degrees, the altitude above 0 and at most 90", lambda: retalho.render(Z, light=(0, 0))),
    # curves
    ("order must be 0 to 3, not 4", lambda: CURVES[0].derivative(0.5, order=4)),
    # meshes
    ("triangles must be whole numbers of shape (m, 3), not", lambda: retalho.Mesh(POINTS, np.zeros((2, 2), dtype=np.int64))),
    # patches
    ("recovery must be 'barycentric', 'spr' or 'smooth', not 'rough'", lambda: retalho.PatchSet([CURVES], recovery="rough")),
    ("layout must be 'delaunay' or 'midpoint', not 'even'", lambda: retalho.PatchSet([CURVES], layout="even")),
    ("divisions must be one number or three, not 2", lambda: retalho.PatchSet([CURVES], divisions=(1, 2))),
    ("divisions must be 1 to 10,000, not 0", lambda: retalho.PatchSet([CURVES], divisions=0)),
    ("samples must be 'parameter' or 'arc-length', not 'even'", lambda: retalho.PatchSet([CURVES], samples="even")),
    ("patch 0 has 2 sides: a patch has three", lambda: retalho.PatchSet([CURVES[:2]])),
    ("parameters must be 'mean-value' or 'shape-preserving', not 'even'", lambda: retalho.PatchSet.from_mesh(retalho.Mesh(POINTS, np.array([[0, 1, 2]])), parameters="even")),
    ("the mesh has no triangles", lambda: retalho.PatchSet.from_mesh(retalho.Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)))),
    # TetraQuads
    ("divisions of a tetrahedron's edge: 1 to 16, or 0", lambda: ball().mesh(divisions=17)),
    ("there is no point with finite coordinates to make a surface of", lambda: retalho.TetraQuad.fit(np.full((5, 3), NAN), np.ones((5, 3)))),
    ("coordinates beyond 1e150: scale them", lambda: retalho.TetraQuad.fit(1e160 * POINTS, np.ones((5, 3)))),
    ("the points have no normals: estimate them first", lambda: retalho.TetraQuad.fit(POINTS, np.zeros((5, 3)))),
    ("split must be 'five' or 'kuhn', not 'six'", lambda: retalho.TetraQuad.fit(POINTS, split="six")),
    ("normals must have the shape of points, (5, 3), not (4, 3)", lambda: retalho.TetraQuad.fit(POINTS, normals=np.ones((4, 3)))),
    ("origins and directions must have the same shape (or one of them (3,))", lambda: ball().cast(np.zeros((2, 3)), np.zeros((4, 3)))),
    # visibility
    ("voids must be 'transparent' or 'blocks', not 'walls'", lambda: retalho.viewshed(Z, (3, -3), voids="walls")),
    ("there are no observers: the shape is (0, 2)", lambda: retalho.viewshed(Z, np.zeros((0, 2)))),
    ("an observer's height is nan", lambda: retalho.viewshed(Z, (3, -3), observer_height=NAN)),
    ("azimuth must be two numbers of degrees", lambda: retalho.viewshed(Z, (3, -3), azimuth=(1,))),
    ("what must be 'visible', 'count' or 'height', not 'all'", lambda: retalho.viewshed(Z, (3, -3), what="all")),
]
TILES: list[tuple[str, Callable[[pathlib.Path], object]]] = [
    ("surface must be 'linear', 'powell-sabin' or 'clough-tocher', not 'flat'", lambda f: plan(f, max_error=1.0, surface="flat")),
    ("fit must be 'interpolate' or 'least-squares', not 'quick'", lambda f: plan(f, max_error=1.0, fit="quick")),
    ("give one of max_error, vertices and ratio", lambda f: plan(f, max_error=1.0, vertices=100)),
    ("ratio must be in (0, 1], not 2", lambda f: plan(f, ratio=2.0)),
    ("this plan has a budget whose tolerance is not known yet: settle() it, or make()", lambda f: plan(f, vertices=100, size=16).make_tin(0, 0, "a", f)),
    ("tins must be nine names, row by row round the tile, not 1", lambda f: plan(f).make_tile(0, 0, ["a"], f)),
    ("tins must name all 1 tiles, not 2", lambda f: plan(f).around(["a", "b"], 0, 0)),
    ("looks must be of all 1 tiles, not 0", lambda f: plan(f, vertices=100, size=16).areas([], 0, 0)),
    ("areas must be nine, not 2", lambda f: plan(f).count(0, 0, 1.0, [True, False])),
    ("there is no tile (5, 0): the grid has", lambda f: plan(f).tin_name(5, 0)),
    ("bounds must be four numbers (left, bottom, right, top) in the CRS", lambda f: tiles(f).part((1, 2, 3))),
    ("' holds any data", lambda f: void(f).contours(interval=1.0)),
    ("z is a file, which says itself where it lies: leave transform and crs out",
     lambda f: (plan(f), retalho.fit(f / "grid.asc", max_error=1, crs="EPSG:25832"))),
]


@pytest.mark.parametrize("words,call", ROWS, ids=[row[0][:40] for row in ROWS])
def test_call_is_refused(words: str, call: Callable[[], object]) -> None:
    with pytest.raises((retalho.Error, ValueError, TypeError)) as raised:
        call()
    assert words in str(raised.value)


@pytest.mark.parametrize("words,call", TILES, ids=[row[0][:40] for row in TILES])
def test_call_on_a_file_is_refused(words: str, call: Callable[[pathlib.Path], object], tmp_path: pathlib.Path) -> None:
    with pytest.raises((retalho.Error, ValueError)) as raised:
        call(tmp_path)
    assert words in str(raised.value)

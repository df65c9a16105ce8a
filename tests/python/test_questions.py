"""Contours, viewsheds, meshes, curves, patches and TetraQuads: against formulas, SciPy, and one another."""
from __future__ import annotations

import json
import pathlib
import pickle
import subprocess
import warnings
from collections.abc import Callable

import numpy as np
import pytest
from conftest import ROOT, hills
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import BSpline, CubicSpline, RectBivariateSpline

import retalho

Find = Callable[[str], pathlib.Path]
UTM = (30.0, 0.0, 500000.0, 0.0, -30.0, 4200000.0)


def test_contours_lie_on_the_level() -> None:
    z = hills(40, 50)
    lines = retalho.contours(z, [-20, 0, 30.5], keep_flats=False, tolerance=1e-4)
    peer = RectBivariateSpline(np.arange(40), np.arange(50), z)
    assert len(lines) > 5 and list(lines.levels) == [-20, 0, 30.5]
    for line in lines:
        x, y = line.points.T
        assert np.abs(peer.ev(-y, x) - line.level).max() < 0.005  # 1e-4 of a cell on slopes up to 40 a cell
        assert line.closed == bool(np.array_equal(line.points[0], line.points[-1]))
    assert lines[-1].level == 30.5
    with pytest.raises(IndexError):
        lines[len(lines)]
    assert np.array_equal(np.vstack([np.asarray(line) for line in lines]), lines.points)
    assert np.array_equal(np.diff(lines.offsets.astype(int)), [len(line) for line in lines])
    assert np.shares_memory(lines[3].points, lines.points)


def test_contours_of_a_model_and_their_files(tmp_path: pathlib.Path) -> None:
    model = retalho.fit(hills(), transform=UTM, crs="EPSG:32611", max_error=1.0)
    lines = model.contours(interval=20, tolerance=0.01)
    for line in lines:
        heights = model(*line.points.T)
        assert np.nanmax(np.abs(heights - line.level)) < 0.1
    path = tmp_path / "lines.geojson"
    lines.write(path)
    features = json.loads(path.read_text())["features"]
    assert len(features) == len(lines)
    assert sorted(f["properties"]["elev"] for f in features) == sorted(line.level for line in lines)
    with pytest.raises(retalho.CannotWrite):
        lines.write(path)
    assert "UTM zone 11N" in repr(lines)
    with pytest.raises(ValueError, match="levels"):
        model.contours()
    with pytest.raises(ValueError, match="levels"):
        model.contours([1, 2], interval=3)
    with pytest.raises(ValueError, match="tolerance"):
        model.contours([1], tolerance=-1)


def area(ring: NDArray[np.float64]) -> float:
    x, y = ring.T
    return float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) / 2)


def test_bands_cover_the_data_once() -> None:
    bands = retalho.contours(hills(), interval=25, bands=True).bands
    assert bands is not None
    total = sum(area(b.outer) + sum(area(h) for h in b.holes) for b in bands)
    assert total == pytest.approx(79 * 59, rel=1e-9)
    assert any(b.holes for b in bands) and all(area(b.outer) > 0 for b in bands)
    assert retalho.contours(hills(), interval=25).bands is None


def test_viewshed_of_a_wall() -> None:
    z = np.zeros((11, 21))
    z[:, 10] = 50
    seen = retalho.viewshed(z, (2, -5), observer_height=2)
    assert seen.dtype == bool and seen[:, :11].all() and not seen[:, 11:].any()
    both = retalho.viewshed(z, [(2, -5, 2), (18, -5, 60)], what="count")
    assert both.dtype == np.uint32 and (both[:, 12:] == 1).all() and both[5, 3] in (1, 2)
    needed = retalho.viewshed(z, (2, -5), what="height")
    assert needed[5, 18] == pytest.approx(2 + 48 / 8 * 16, rel=1e-5) and needed[5, 5] == 0
    sight = retalho.line_of_sight(z, (2, -5), (18, -5))
    assert not sight.visible and sight.blocked_at == pytest.approx(8) and sight.profile.shape == (17, 6)
    assert retalho.viewshed(z, (2, -5), radius=3).sum() == (np.hypot(*np.mgrid[-5:6, -2:19]) <= 3).sum()
    with pytest.raises(ValueError, match="outside"):
        retalho.viewshed(z, (50, 5))
    with pytest.raises(ValueError, match="voids"):
        retalho.viewshed(z, (2, -5), voids="walls")  # type: ignore[call-overload]


def test_intervisibility_of_a_plane_and_of_a_model() -> None:
    flat = retalho.intervisibility(np.zeros((30, 40)), directions=60)
    assert flat.shape == (30, 40) and np.all(np.abs(flat / 1200 - 1) < 0.05)
    model = retalho.fit(hills(), max_error=1.0)
    assert np.array_equal(retalho.viewshed(model, (20, -20)), retalho.viewshed(model.sample(), (20, -20)))
    with pytest.raises(ValueError, match="4"):
        retalho.intervisibility(np.zeros((5, 5)), directions=2)


def test_meshes(tmp_path: pathlib.Path) -> None:
    model = retalho.fit(hills(), transform=UTM, max_error=1.0)
    mesh = model.mesh(tolerance=0.5)
    check = mesh.check()
    assert check["watertight"] and check["components"] == 1
    p = mesh.positions + mesh.offset
    heights = model(p[:, 0], p[:, 1])
    assert np.nanmax(np.abs(heights - p[:, 2])) < 1e-9
    mesh.write(tmp_path / "m.ply")
    again = retalho.read_mesh(tmp_path / "m.ply")
    assert np.allclose(again.positions, p) and np.array_equal(again.triangles, mesh.triangles)
    square = retalho.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    assert square.check()["boundary_edges"] == 4
    with pytest.raises(ValueError, match="vertex 4"):
        retalho.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 1, 4]])
    with pytest.raises(ValueError, match=r"\(2, 2\)"):
        retalho.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 1], [1, 2]])


@given(st.integers(0, 2**32 - 1), st.integers(2, 3), st.integers(1, 5))
def test_bsplines_are_scipys(seed: int, dimension: int, degree: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(9, dimension))
    inner = np.sort(rng.uniform(0, 1, 9 - degree - 1))
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    curve = retalho.Curve.bspline(points, knots, degree=degree)
    peer = BSpline(knots, points, degree)
    u = rng.uniform(0, 1, 50)
    assert np.allclose(curve(u), peer(u), atol=1e-9)
    scale = max(1.0, float(np.abs(peer.derivative()(u)).max()))
    assert np.allclose(curve.derivative(u), peer.derivative()(u), atol=1e-7 * scale)
    back = curve.to_bspline()
    assert np.allclose(BSpline(back["knots"], back["points"], back["degree"])(u), peer(u), atol=1e-8)


def test_interpolating_splines_are_scipys() -> None:
    rng = np.random.default_rng(2)
    x, y = np.sort(rng.uniform(0, 10, 12)), rng.normal(size=12)
    curve = retalho.Curve.interpolate(np.column_stack([x, y]), parameters="x")
    u = np.linspace(x[0], x[-1], 200)
    assert np.allclose(curve(u)[:, 1], CubicSpline(x, y)(u), atol=1e-9)
    natural = retalho.Curve.interpolate(np.column_stack([x, y]), parameters="x", ends="natural")
    assert np.allclose(natural(u)[:, 1], CubicSpline(x, y, bc_type="natural")(u), atol=1e-9)


def test_curves() -> None:
    k = 4 / 3 * (np.sqrt(2) - 1)
    arc = retalho.Curve.bezier([[1, 0], [1, k], [k, 1], [0, 1]])
    assert arc.length == pytest.approx(np.pi / 2, abs=3e-3)
    circle = retalho.Curve.bspline([[1, 0], [1, 1], [0, 1]], degree=2, weights=[1, np.sqrt(0.5), 1])
    assert circle.length == pytest.approx(np.pi / 2, abs=1e-10)
    assert np.allclose(np.linalg.norm(circle(np.linspace(0, 1, 20)), axis=1), 1)
    assert np.allclose(circle.curvature(np.linspace(0.1, 0.9, 5)), 1)
    assert isinstance(circle.curvature(0.5), float) and circle(0.5).shape == (2,)
    left, right = arc.split(0.3)
    assert left.length + right.length == pytest.approx(arc.length)
    assert np.allclose(arc.reversed()(0.2), arc(0.8))
    assert arc.elevated(5).degree == 5
    u, point, distance = arc.closest((2, 2))
    assert u == pytest.approx(0.5) and distance == pytest.approx(np.hypot(2 - point[0], 2 - point[1]))
    (flat,) = arc.flatten(tolerance=1e-4)
    assert 40 < len(flat) < 80, "a circle asks for 56 chords"
    assert np.array_equal(flat[0], [1, 0]) and np.array_equal(flat[-1], [0, 1])
    assert max(arc.closest(m)[2] for m in (flat[1:] + flat[:-1]) / 2) <= 1e-4
    corner = retalho.Curve.polyline([[0, 0], [1, 0], [1, 1]])
    (join,) = corner.joins()
    assert join["G"] == 0 and join["angle"] == pytest.approx(np.pi / 2)
    assert arc.control_points.shape == (4, 2) and not arc.control_points.flags.writeable
    (crossing,) = retalho.Curve.polyline([[0, 0], [1, 1]]).intersections(circle)
    assert np.allclose(crossing[2], np.sqrt(0.5))
    with pytest.raises(ValueError, match=r"\(n, 2\) or \(n, 3\), not \(2, 4\)"):
        retalho.Curve.bezier(np.zeros((2, 4)))
    with pytest.raises(ValueError, match="ends"):
        retalho.Curve.interpolate([[0, 0], [1, 1]], ends="loose")  # type: ignore[arg-type]


def test_curve_files(tmp_path: pathlib.Path) -> None:
    curves = [retalho.Curve.bezier([[0, 0], [1, 2], [3, 2], [4, 0]]), retalho.Curve.catmull_rom([[0, 0], [1, 1], [2, 0]])]
    retalho.write_curves(curves, tmp_path / "c.json")
    again = retalho.read_curves(tmp_path / "c.json")
    assert all(np.array_equal(a.control_points, b.control_points) for a, b in zip(curves, again))
    (tmp_path / "bad.json").write_text('{"curves": [{"kind": "bezier", "points": [[0]]}]}')
    with pytest.raises(retalho.BadInput, match=r"curves\[0\]"):
        retalho.read_curves(tmp_path / "bad.json")


def octant() -> list[retalho.Curve]:
    """Three quarter circles of the unit sphere."""
    w, e = np.sqrt(0.5), np.eye(3)
    return [retalho.Curve.bspline([e[i], e[i] + e[j], e[j]], degree=2, weights=[1, w, 1])
            for i, j in ((0, 1), (1, 2), (2, 0))]


def test_patches(tmp_path: pathlib.Path) -> None:
    patches = retalho.PatchSet([octant()], divisions=24)
    (patch,) = patches
    assert patch.report()["folds"] == 0 and patch.report()["boundary_gap"] < 1e-12
    s = np.linspace(0, 1, 50)
    assert np.allclose(np.linalg.norm(patch(1 - s, s), axis=1), 1), "on the side's circle"
    assert np.allclose(patch(1.0, 0.0), [1, 0, 0]) and np.allclose(patch(0.0, 1.0), [0, 1, 0])
    assert np.allclose(np.linalg.norm(patch.normal(0.3, [0.2, 0.3]), axis=1), 1)
    assert np.array_equal(patch(*patch.parameters.T).round(9), patch.positions.round(9))
    assert patch.triangles.shape == (24 * 24, 3)
    patches.save(tmp_path / "p.retalho")
    again = retalho.load(tmp_path / "p.retalho")
    assert isinstance(again, retalho.PatchSet) and np.array_equal(again[0](0.2, 0.3), patch(0.2, 0.3))
    assert pickle.loads(pickle.dumps(patches)).to_bytes() == patches.to_bytes()
    assert patches.mesh(tolerance=1e-3).check()["nonmanifold_edges"] == 0
    with pytest.raises(ValueError, match="two sides|has 2 sides"):
        retalho.PatchSet([octant()[:2]])
    with pytest.raises(ValueError, match="recovery"):
        retalho.PatchSet([octant()], recovery="none")  # type: ignore[arg-type]
    hull = retalho.read_patches(ROOT / "examples" / "patches" / "hull.json")
    assert len(hull) > 1 and all(join["watertight"] for join in hull.joins())
    disk = retalho.PatchSet.from_mesh(retalho.Mesh(patch.positions, patch.triangles))
    assert disk[0].report()["folds"] == 0


def test_tetraquads(tmp_path: pathlib.Path) -> None:
    rng = np.random.default_rng(1)
    p = rng.normal(size=(4000, 3))
    p /= np.linalg.norm(p, axis=1)[:, None]
    surface = retalho.TetraQuad.fit(p, p, resolution=16)
    d = rng.normal(size=(1000, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    hits = surface.cast(3 * d, -d)
    assert len(hits) == 1000 and hits.hit.all()
    assert np.abs(hits.t - 2).max() < 1e-4 and np.abs(hits.normals - d).max() < 0.01
    assert np.allclose(hits.points, 3 * d - hits.t[:, None] * d)
    missed = surface.cast((3, 0, 0), d + (2, 0, 0))
    assert not missed.hit.any() and np.isnan(missed.points).all()
    assert surface(0.97 * d) == pytest.approx(-0.03, abs=1e-3)
    assert np.allclose(np.linalg.norm(surface.gradient(0.97 * d), axis=1), 1, atol=0.02)
    feet, normals = surface.project(1.02 * d)
    found = ~np.isnan(feet[:, 0])
    assert found.mean() > 0.95, "a few start outside of the tetrahedra"
    feet, normals, d = feet[found], normals[found], d[found]
    assert np.abs(np.linalg.norm(feet, axis=1) - 1).max() < 1e-4 and np.abs(normals - d).max() < 0.02
    mesh = surface.mesh()
    assert mesh.check()["open_edges"] == 0
    assert np.abs(np.linalg.norm(mesh.positions, axis=1) - 1).max() < 1e-4
    surface.save(tmp_path / "s.retalho")
    again = retalho.load(tmp_path / "s.retalho")
    assert isinstance(again, retalho.TetraQuad) and np.array_equal(again.quadrics, surface.quadrics)
    assert np.array_equal(again.cast(3 * d, -d).t, hits.t[found])
    guessed = retalho.TetraQuad.fit(p, resolution=12)
    assert np.abs(guessed.cast(3 * d, -d).t - 2).max() < 0.02, "normals are estimated, outwards"
    with pytest.raises(ValueError, match=r"\(4000, 3\), not \(7, 3\)"):
        retalho.TetraQuad.fit(p, p[:7])
    with pytest.raises(ValueError, match=r"\(5, 3\) and \(3, 3\)"):
        surface.cast(np.zeros((5, 3)), np.zeros((3, 3)))
    with pytest.raises(ValueError):
        retalho.TetraQuad.fit(p, p, resolution=1)


def test_tetraquads_by_other_ways(tmp_path: pathlib.Path) -> None:
    rng = np.random.default_rng(3)
    p = rng.normal(size=(4000, 3))
    p /= np.linalg.norm(p, axis=1)[:, None]
    d = rng.normal(size=(500, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    for solver, error in (("cholesky", 1e-4), ("cg", 1e-3), ("local", 1e-2)):
        surface = retalho.TetraQuad.fit(p, p, resolution=12, solver=solver)  # type: ignore[arg-type]
        assert np.abs(surface.cast(3 * d, -d).t - 2).max() < error, solver
    with pytest.raises(ValueError, match="solver must be"):
        retalho.TetraQuad.fit(p, p, solver="svd")  # type: ignore[arg-type]
    cut = p[p[:, 2] < 0.7]
    assert retalho.TetraQuad.fit(cut, cut, resolution=12, closed=True).mesh().check()["open_edges"] == 0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert retalho.TetraQuad.fit(cut, cut, resolution=12).mesh().check()["open_edges"] > 0
    adaptive = retalho.TetraQuad.fit(p, p, adaptive=20000)
    adaptive.save(tmp_path / "a.retalho")
    again = retalho.load(tmp_path / "a.retalho")
    assert isinstance(again, retalho.TetraQuad) and np.array_equal(again.cast(3 * d, -d).t, adaptive.cast(3 * d, -d).t)


def test_equal_to_the_program(tmp_path: pathlib.Path, program: pathlib.Path, data: Find) -> None:
    dem = data("dem/SainteHelens.dem")
    grid = retalho.read_grid(dem)
    rows, columns = grid.shape
    a, _, c, _, e, f = grid.transform
    x, y = c + a * (columns // 2), f + e * (rows // 2)
    seen = tmp_path / "seen.tif"
    subprocess.run([program, "viewshed", dem, "-o", seen, "--observer", f"{x},{y},10", "-q"], check=True)
    expected = np.nan_to_num(np.asarray(retalho.read_grid(seen))) > 0
    assert np.array_equal(retalho.viewshed(grid, (x, y, 10)), expected)
    assert 0 < expected.sum() < expected.size
    lines = tmp_path / "lines.geojson"
    done = subprocess.run([program, "contour", dem, "-o", lines, "--interval", "100", "--json", "-q"], check=True,
                          capture_output=True)
    told = json.loads(done.stdout)
    ours = retalho.contours(grid, interval=100)
    assert len(ours) == told["lines"] and sum(line.closed for line in ours) == told["closed_lines"]
    assert len(ours.points) == told["vertices"] + told["closed_lines"]

"""Terrain models against formulas, against the program's own files and against SciPy."""
from __future__ import annotations

import json
import pathlib
import pickle
import subprocess
from collections.abc import Callable
from typing import Literal

import numpy as np
import pytest
from conftest import hills
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import CloughTocher2DInterpolator, RectBivariateSpline
from scipy.interpolate.interpnd import estimate_gradients_2d_global
from scipy.spatial import Delaunay

import retalho

Surface = Literal["linear", "powell-sabin", "clough-tocher"]
Find = Callable[[str], pathlib.Path]
number = st.floats(-5, 5)


@given(number, number, number, st.sampled_from(["linear", "powell-sabin", "clough-tocher"]),
       st.sampled_from([("flat", 1e-9), ("surface", 1e-6)]))  # what is fitted ends when conjugate gradients do
def test_planes_are_reproduced(
        a: float, b: float, c: float, surface: Surface, how: tuple[Literal["flat", "surface"], float]) -> None:
    y, x = np.mgrid[0:12, 0:9]
    refine, within = how
    model = retalho.fit(a + b * x - c * y, max_error=0.5, surface=surface, refine=refine)
    px, py = np.linspace(0, 8, 37), -np.linspace(0, 11, 37)
    assert np.allclose(model(px, py), a + b * px + c * py, atol=within)
    if surface != "linear":
        assert np.allclose(model.gradient(px, py), (b, c), atol=within)
        assert np.allclose(model.slope(px, py), np.degrees(np.arctan(np.hypot(b, c))), atol=max(1e-6, 100 * within))


@given(st.integers(0, 2**32 - 1))
def test_quadratics_of_scattered_points_are_reproduced(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-1, 1, (2, 200))
    a = rng.normal(size=6)

    def f(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(a[0] + a[1] * x + a[2] * y + a[3] * x * x + a[4] * x * y + a[5] * y * y)

    model = retalho.fit_points(np.column_stack([x, y, f(x, y)]))
    px, py = rng.uniform(-0.8, 0.8, (2, 100))
    inside = ~np.isnan(model(px, py))
    assert inside.sum() > 90, "not degenerate"
    px, py = px[inside], py[inside]
    assert np.allclose(model(px, py), f(px, py), atol=1e-7)
    assert np.allclose(model.curvature(px, py)[0] * 0, 0)


def test_tolerance_holds_at_every_cell() -> None:
    z = hills()
    model = retalho.fit(z, max_error=2.0, surface="linear")
    assert np.abs(model.sample() - z).max() <= 2.0 * (1 + 1e-12)
    report = model.compare(z)
    assert report.violations == 0 and report.cells == z.size and report.max_error <= 2.0
    assert report.rmse == pytest.approx(np.sqrt(np.mean((model.sample() - z) ** 2)), rel=1e-9)
    surface = retalho.fit(z, max_error=2.0, refine="surface")
    assert np.abs(surface.sample() - z).max() <= 2.0 * (1 + 1e-9)
    assert len(surface.vertices) < len(model.vertices)
    assert retalho.fit(z, vertices=50).vertices.shape == (50, 3)
    assert "tolerance 2, no CRS" in repr(model) and "of 60 x 80 cells" in repr(model)


def test_samples_are_the_values_at_centres() -> None:
    model = retalho.fit(hills(), max_error=1.0)
    transform = (0.75, 0.0, 3.0, 0.0, -0.5, -4.0)
    x, y = 3 + 0.75 * (np.arange(31) + 0.5), -4 - 0.5 * (np.arange(23)[:, None] + 0.5)
    assert np.allclose(model.sample(transform, (23, 31)), model(x, y), atol=1e-9)
    quantities: list[Literal["gradient", "slope", "aspect", "normal", "curvature"]] = [
        "gradient", "slope", "aspect", "normal", "curvature"]
    for what in quantities:
        expected = getattr(model, what)(x, y)
        assert np.allclose(model.sample(transform, (23, 31), what=what), expected, atol=1e-7, equal_nan=True), what
    with pytest.raises(ValueError, match="shape"):
        model.sample(transform, (0, 5))
    with pytest.raises(ValueError, match="transform and shape"):
        model.sample(transform)


def test_equal_to_the_program(tmp_path: pathlib.Path, program: pathlib.Path, data: Find) -> None:
    dem = data("dem/LisbonElevation.tif")
    saved = tmp_path / "m.retalho"
    done = subprocess.run([program, "fit", dem, "-o", saved, "--max-error", "5", "--json", "-q"], check=True,
                          capture_output=True)
    told = json.loads(done.stdout)
    model = retalho.fit(dem, max_error=5.0)
    assert model.to_bytes() == saved.read_bytes()
    assert retalho.fit(retalho.read_grid(dem), max_error=5.0, threads=1).to_bytes() == saved.read_bytes()
    report = model.compare(dem)
    assert report.rmse == told["rmse"] and report.max_error == told["max_error"]
    assert list(report.max_error_at) == told["max_error_at"]
    loaded = retalho.load(saved)
    assert isinstance(loaded, retalho.Terrain) and loaded.to_bytes() == saved.read_bytes()


def lattice(rows: int, columns: int) -> NDArray[np.float64]:
    """Points of equilateral triangles: there the line between neighbouring centres is at right angles to the edge, and
    the cross derivatives of SciPy's surface and of ours are the same rule."""
    r, c = np.mgrid[0:rows, 0:columns]
    return np.column_stack([(c + 0.5 * (r % 2)).ravel(), (np.sqrt(0.75) * r).ravel()])


def test_clough_tocher_is_scipys() -> None:
    rng = np.random.default_rng(3)
    p = lattice(14, 15)
    z = rng.normal(size=len(p))
    model = retalho.fit_points(np.column_stack([p, z]), gradients="network")
    peer = CloughTocher2DInterpolator(p, z, tol=1e-13, maxiter=10000)
    # Three edges from the border of the hull, whose slivers are not equilateral. Gradients are global, so that they
    # agree only if both are the minimum-norm network's.
    x, y = rng.uniform(3, 11, 2000), rng.uniform(2.6, 8.6, 2000)
    assert np.abs(model(x, y) - peer(x, y)).max() < 1e-6
    assert np.ptp(peer(x, y)) > 1


def test_network_gradients_are_scipys() -> None:
    rng = np.random.default_rng(4)
    p = rng.uniform(0, 10, (300, 2))
    z = np.sin(p[:, 0]) * np.cos(0.7 * p[:, 1])
    model = retalho.fit_points(np.column_stack([p, z]), gradients="network")
    peer = estimate_gradients_2d_global(Delaunay(p), z, tol=1e-13, maxiter=10000).reshape(-1, 2)
    order = {tuple(v): g for v, g in zip(model.vertices[:, :2].tolist(), model.vertex_gradients)}
    ours = np.array([order[tuple(q)] for q in p.tolist()])
    assert np.abs(ours - peer).max() < 1e-6 * max(1.0, np.abs(peer).max())


def test_clough_tocher_along_edges_is_scipys() -> None:
    """On any triangulation both surfaces are the same cubic along every edge."""
    rng = np.random.default_rng(5)
    p = rng.uniform(0, 10, (150, 2))
    z = rng.normal(size=150)
    model = retalho.fit_points(np.column_stack([p, z]), gradients="network")
    peer = CloughTocher2DInterpolator(p, z, tol=1e-13, maxiter=10000)
    t, v = model.triangles, model.vertices
    for s in (0.2, 0.5, 0.7):
        q = (1 - s) * v[t[:, 0], :2] + s * v[t[:, 1], :2]
        both = np.column_stack([model(q[:, 0], q[:, 1]), peer(q)])
        both = both[~np.isnan(both).any(axis=1)]  # edges of the hull may fall to either side
        assert len(both) > 200
        assert np.abs(both[:, 0] - both[:, 1]).max() < 1e-5


def test_bicubic_is_scipys() -> None:
    z = hills(25, 31)
    surface = retalho.Bicubic(z, keep_flats=False)
    # Both are the not-a-knot tensor spline; y runs to the south there.
    peer = RectBivariateSpline(np.arange(25), np.arange(31), z, kx=3, ky=3, s=0)
    rng = np.random.default_rng(6)
    x, y = rng.uniform(0, 30, 3000), rng.uniform(0, 24, 3000)
    assert np.abs(surface(x, -y) - peer.ev(y, x)).max() < 1e-9
    assert np.abs(surface.gradient(x, -y)[:, 0] - peer.ev(y, x, dy=1)).max() < 1e-8
    assert np.abs(surface.gradient(x, -y)[:, 1] + peer.ev(y, x, dx=1)).max() < 1e-8
    assert np.isnan(surface(-1.0, -3.0))


@pytest.mark.parametrize("surface", ["linear", "powell-sabin", "clough-tocher"])
def test_model_files(tmp_path: pathlib.Path, surface: Surface) -> None:
    transform = (30.0, 0.0, 500000.0, 0.0, -30.0, 4200000.0)
    model = retalho.fit(hills(), transform=transform, crs="EPSG:32611", max_error=1.0, surface=surface)
    path = tmp_path / "m.retalho"
    model.save(path)
    with pytest.raises(retalho.CannotWrite, match="exists"):
        model.save(path)
    loaded = retalho.load(path)
    assert isinstance(loaded, retalho.Terrain)
    assert loaded.surface == surface and loaded.transform == transform and loaded.tolerance == 1.0
    x, y = np.random.default_rng(7).uniform(0, 1500, (2, 500))
    assert np.array_equal(loaded(500000 + x, 4200000 - y), model(500000 + x, 4200000 - y), equal_nan=True)
    assert pickle.loads(pickle.dumps(model)).to_bytes() == path.read_bytes()
    whole = path.read_bytes()
    for size in (0, 10, 31, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:size])
        with pytest.raises(OSError, match="m.retalho") as caught:
            retalho.load(path)
        assert isinstance(caught.value, retalho.CannotRead) and caught.value.file == str(path)
    with pytest.raises(retalho.CannotRead):
        retalho.from_bytes(whole[:-1])


def test_points_far_out_keep_their_digits() -> None:
    rng = np.random.default_rng(8)
    p = rng.uniform(0, 100, (200, 2)) + (500000, 4200000)
    z = 0.01 * (p[:, 0] - 500000) ** 2
    model = retalho.fit_points(np.column_stack([p, z]), crs="EPSG:32611")
    at = dict(zip(map(tuple, p.tolist()), z))
    assert all(at[(v[0], v[1])] == v[2] for v in model.vertices.tolist())
    assert model(500050.0, 4200050.0) == pytest.approx(25, abs=1e-6)
    assert model.shape is None and "of points" in repr(model)
    with pytest.raises(ValueError, match=r"\(n, 3\), not \(5, 2\)"):
        retalho.fit_points(np.zeros((5, 2)))
    with pytest.raises(ValueError, match="not finite"):
        retalho.fit_points(np.array([[0, 0, 0], [1, 0, np.nan], [0, 1, 0]]))

"""TiledModel: what the joined model says, tile by tile."""
from __future__ import annotations

import pathlib
import subprocess

import numpy as np
import pytest
from conftest import hills

import retalho

PLACE = (30, 0, 500000, 0, -30, 4200000)


@pytest.fixture(params=["linear", "powell-sabin", "clough-tocher"])
def folder(tmp_path: pathlib.Path, request: pytest.FixtureRequest) -> pathlib.Path:
    z = hills(98, 131)
    z[20:50, 30:60] = np.nan
    path = tmp_path / "dem.tif"
    retalho.Grid(z, transform=PLACE, crs="EPSG:32611").write(path)
    retalho.TilePlan(path, size=40, max_error=1.0, surface=request.param).make(tmp_path / "t")
    return tmp_path / "t"


def joined_of(folder: pathlib.Path) -> retalho.Terrain:
    joined = retalho.load(folder)
    assert isinstance(joined, retalho.Terrain)
    return joined


def test_answers_at_points_and_on_rasters(folder: pathlib.Path) -> None:
    joined, tiled = joined_of(folder), retalho.TiledModel(folder, memory=1)
    assert tiled.shape == joined.shape and tiled.transform == joined.transform and tiled.crs == joined.crs
    assert tiled.surface == joined.surface and tiled.tolerance == 1 and tiled.tile_size == 40
    assert len(tiled.tiles) == 12 and repr(tiled).startswith("<retalho.TiledModel " + joined.surface)
    rng = np.random.default_rng(3)
    x, y = rng.uniform(499900, 504000, 500), rng.uniform(4197000, 4200050, 500)
    x[:3] = np.nan, np.inf, 1e30
    for name in ("__call__", "gradient", "slope", "aspect", "normal", "curvature"):
        a, b = getattr(joined, name)(x, y), getattr(tiled, name)(x, y)
        assert a.shape == b.shape
        np.testing.assert_allclose(a, b, atol=1e-7, equal_nan=True)
    assert isinstance(tiled(502000.0, 4199000.0), float)
    for what in ("height", "gradient", "slope", "normal", "curvature"):
        a, b = joined.sample(what=what), tiled.sample(what=what)  # type: ignore[arg-type]
        np.testing.assert_allclose(a, b, atol=1e-6, equal_nan=True)
    other = dict(transform=(17, 0, 500100, 0, -23, 4199800), shape=(90, 150))
    np.testing.assert_allclose(joined.sample(**other), tiled.sample(**other), atol=1e-9, equal_nan=True)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="what"):
        tiled.sample(what="colour")  # type: ignore[arg-type]


def test_each_tile_is_read_once_whatever_the_order(folder: pathlib.Path) -> None:
    tiled = retalho.TiledModel(folder, memory=1)
    rng = np.random.default_rng(4)
    tiled(rng.uniform(500100, 503800, 3000), rng.uniform(4197200, 4199900, 3000))
    assert tiled.reads <= 24  # a point on a seam may ask its neighbour


def test_windows_and_parts(folder: pathlib.Path) -> None:
    joined, tiled = joined_of(folder), retalho.TiledModel(folder)
    whole = joined.sample()
    grid = tiled.window(35, 30, 20, 60)
    np.testing.assert_allclose(grid.heights, whole[35:55, 30:90], atol=1e-9, equal_nan=True)
    assert grid.transform == (30, 0, 500000 + 30 * 30, 0, -30, 4200000 - 35 * 30) and grid.crs == tiled.crs
    assert retalho.viewshed(grid, (502000, 4198800)).shape == (20, 60)
    assert tiled.reads == 6  # of twelve: two rows of three
    for wrong in ((-1, 0, 5, 5), (0, 0, 99, 5), (0, 130, 5, 2), (0, 0, 0, 5)):
        with pytest.raises(ValueError, match="not within the model's grid"):
            tiled.window(*wrong)
    part = tiled.part((500100, 4199000, 501000, 4199900))
    assert part.shape == (41, 41) and part.surface == joined.surface
    x, y = np.linspace(500050, 501150, 30), np.linspace(4198850, 4199950, 30)
    np.testing.assert_allclose(part(x, y), joined(x, y), atol=1e-8)
    assert tiled.part((500000, 4190000, 600000, 4300000)).triangles.shape == joined.triangles.shape
    with pytest.raises(ValueError, match="no tile"):
        tiled.part((0, 0, 1, 1))
    with pytest.raises(ValueError, match="bounds"):
        tiled.part((0, 0, 1))


def test_lines_are_the_joined_models(folder: pathlib.Path, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    joined, tiled = joined_of(folder), retalho.TiledModel(folder, memory=1)

    def sorted_lines(lines: retalho.Contours) -> list[tuple[float, bool, list[list[float]]]]:
        found = []
        for line in lines:
            points = line.points[:-1] if line.closed else line.points
            first = min(range(len(points)), key=lambda i: tuple(points[i])) if line.closed else 0
            found.append((line.level, line.closed, np.roll(points, -first, axis=0).tolist()))
        return sorted(found)

    raw = tiled.contours(interval=10, simplify=False, tolerance=2)
    assert sorted_lines(raw) == sorted_lines(joined.contours(interval=10, simplify=False, tolerance=2))
    assert len(raw) > 20 and raw.crs == joined.crs and (np.diff([line.level for line in raw]) >= 0).all()
    thin = tiled.contours([260, 300], tolerance=2.0)
    assert len(thin) == len(joined.contours([260, 300], tolerance=2.0)) and thin.tolerance == 2
    said = tiled.write_contours(tmp_path / "a.shp", interval=10, tolerance=2.0)
    assert said["lines"] == len(tiled.contours(interval=10, tolerance=2.0))
    subprocess.run([program, "contour", folder, "-o", tmp_path / "b.shp", "--interval", "10", "--tolerance", "2", "-q"],
                   check=True)
    assert (tmp_path / "a.shp").read_bytes() == (tmp_path / "b.shp").read_bytes()
    with pytest.raises(OSError):
        tiled.write_contours(tmp_path / "a.shp", interval=10)
    with pytest.raises(ValueError, match="levels"):
        tiled.contours()


def test_meshes_are_the_joined_models(folder: pathlib.Path, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    joined, tiled = joined_of(folder), retalho.TiledModel(folder, memory=1)
    said = tiled.write_mesh(tmp_path / "a.ply", tolerance=0.5)
    assert said["watertight"] and said["tolerance"] == 0.5
    mesh, expected = retalho.read_mesh(tmp_path / "a.ply"), joined.mesh(tolerance=0.5)
    assert mesh.check() == expected.check() and len(mesh.triangles) == said["triangles"]
    corners = mesh.positions[mesh.triangles]
    assert (corners == (expected.positions + expected.offset)[expected.triangles]).all()
    subprocess.run([program, "mesh", folder, "-o", tmp_path / "b.ply", "--tolerance", "0.5", "-q"], check=True,
                   capture_output=True)
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    assert tiled.write_mesh(tmp_path / "c.glb")["triangles"] > 100


def test_errors_and_sight(folder: pathlib.Path) -> None:
    joined, tiled = joined_of(folder), retalho.TiledModel(folder)
    dem = folder.parent / "dem.tif"
    expected, of_path, of_grid = joined.compare(dem), tiled.compare(dem), tiled.compare(retalho.read_grid(dem))
    for report in (of_path, of_grid):
        assert report.valid_cells == expected.valid_cells and report.violations == expected.violations
        assert report.rmse == pytest.approx(expected.rmse, rel=1e-9)
        assert report.max_error == pytest.approx(expected.max_error, rel=1e-9)
    with pytest.raises(ValueError, match="shape"):
        tiled.compare(np.zeros((3, 4)))
    retalho.Grid(np.zeros((300, 300)), transform=(7, 0, 0, 0, -7, 0)).write(dem.parent / "elsewhere.tif")
    with pytest.raises(ValueError, match="is not the grid that the model was made from"):
        tiled.compare(dem.parent / "elsewhere.tif")
    ends = ((500300, 4199600, 3), (500800, 4198500))
    fresh = retalho.TiledModel(folder)
    a, b = retalho.line_of_sight(joined, *ends), retalho.line_of_sight(fresh, *ends)
    assert a.visible == b.visible and fresh.reads <= 2
    np.testing.assert_allclose(a.profile, b.profile, atol=1e-8, equal_nan=True)
    with pytest.raises(ValueError, match="TiledModel"):
        retalho.line_of_sight(fresh, *ends, transform=PLACE)


def test_what_is_refused(tmp_path: pathlib.Path) -> None:
    with pytest.raises(OSError, match="index.json"):
        retalho.TiledModel(tmp_path)
    with pytest.raises(ValueError, match="memory"):
        retalho.TiledModel(tmp_path, memory=0)

"""Pictures, map sheets and breaklines: what the program draws, and arrays."""
from __future__ import annotations

import pathlib
import subprocess

import numpy as np
import pytest
from conftest import hills

import retalho

PLACE = (30, 0, 500000, 0, -30, 4200000)


@pytest.fixture
def grid() -> retalho.Grid:
    z = hills(80, 100)
    z[30:45, 20:40] = np.nan
    return retalho.Grid(z, transform=PLACE, crs="EPSG:32611")


def test_a_picture_is_the_programs(grid: retalho.Grid, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    gdal = pytest.importorskip("osgeo.gdal")
    grid.write(tmp_path / "dem.tif")
    model = retalho.fit(grid, max_error=2.0, refine="flat")
    model.save(tmp_path / "m.retalho")
    for view in ("plan", "perspective"):
        for z, name in ((retalho.read_grid(tmp_path / "dem.tif"), "dem.tif"), (model, "m.retalho")):
            subprocess.run([program, "render", tmp_path / name, "-o", tmp_path / "p.png", "--view", view, "--size",
                            "216x166", "--no-captions", "--overwrite", "-q"], check=True, capture_output=True)
            sheet = np.moveaxis(gdal.Open(str(tmp_path / "p.png")).ReadAsArray(), 0, -1)
            ours = retalho.render(z, size=(196, 146), view=view)  # type: ignore[arg-type]
            assert (sheet[10:-10, 10:-10] == ours).all(), "a sheet has a margin of ten pixels"


def test_a_picture_shows_relief_and_voids(grid: retalho.Grid) -> None:
    plan = retalho.render(grid, size=(100, 80), exaggeration=2.0)
    assert (plan[36:40, 26:34] == 255).all(), "no data is white"
    assert len(np.unique(plan.reshape(-1, 3), axis=0)) > 500
    gray = retalho.render(grid, size=(100, 80), colors="gray", light=(135, 30))
    assert np.ptp(gray.astype(int), axis=2).max() < 30 and (gray != plan).any()
    assert (retalho.render(grid, size=(100, 80), threads=1) == retalho.render(grid, size=(100, 80), threads=3)).all()
    side = retalho.render(retalho.fit(grid, max_error=2.0, refine="flat"), size=(120, 90), view="perspective",
                          from_=45, elevation=20)
    assert side.shape == (90, 120, 3) and 0.2 < (side != 255).any(axis=2).mean() < 0.95
    error = retalho.render(retalho.fit(grid, max_error=20.0, refine="flat"), size=(100, 80), error=grid)
    red, blue = error[..., 0].astype(int) - error[..., 2], error[..., 2].astype(int) - error[..., 0]
    assert red.max() > 40 and blue.max() > 40, "above and below"
    for wrong, word in (({"size": (3, 3)}, "size"), ({"view": "side"}, "view"), ({"colors": "red"}, "colors"),
                        ({"light": (0, 0)}, "light"), ({"exaggeration": 0.0}, "exaggeration"),
                        ({"elevation": 95.0}, "elevation")):
        with pytest.raises(ValueError, match=word):
            retalho.render(grid, **wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="Terrain"):
        retalho.render(retalho.fit(grid, max_error=20.0, refine="flat"), transform=PLACE)


@pytest.mark.parametrize("options", [{}, {"bands": True}, {"curves": True, "bands": True, "tolerance": 5.0}])
def test_a_map_sheet_is_the_programs(
        grid: retalho.Grid, tmp_path: pathlib.Path, program: pathlib.Path, options: dict[str, float]) -> None:
    grid.write(tmp_path / "dem.tif")
    model = retalho.fit(grid, max_error=2.0, refine="flat", surface="powell-sabin")
    model.save(tmp_path / "m.retalho")
    words = [w for name, value in options.items() for w in ([f"--{name}"] if value is True else [f"--{name}", str(value)])]
    inputs: list[tuple[retalho.Grid | retalho.Terrain, str]] = [
        (retalho.read_grid(tmp_path / "dem.tif"), "dem.tif"), (model, "m.retalho")]
    for z, name in inputs:
        for ending in ("svg", "pdf"):
            said = retalho.map_sheet(z, tmp_path / f"ours.{ending}", interval=20, title="Hills", size="A3",
                                     overwrite=True, **options)  # type: ignore[arg-type]
            assert said["labels"] > 0 and (said["curves"] > 0) == ("curves" in options)
            subprocess.run([program, "contour", tmp_path / name, "-o", tmp_path / f"theirs.{ending}", "--interval", "20",
                            "--title", "Hills", "--sheet", "A3", "--overwrite", "-q", *words], check=True,
                           capture_output=True)
            assert (tmp_path / f"ours.{ending}").read_bytes() == (tmp_path / f"theirs.{ending}").read_bytes()
    with pytest.raises(ValueError, match=".svg or .pdf"):
        retalho.map_sheet(grid, tmp_path / "x.png", interval=20)
    with pytest.raises(ValueError, match="B7"):
        retalho.map_sheet(grid, tmp_path / "x.svg", interval=20, size="B7")
    with pytest.raises(OSError):
        retalho.map_sheet(grid, tmp_path / "ours.svg", interval=20)


def test_breaklines_are_the_programs(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    rng = np.random.default_rng(5)
    xy = rng.uniform(0, 100, (400, 2))
    points = np.column_stack([xy, np.abs(xy[:, 0] - 50)])  # a ditch along x = 50
    ditch = np.array([[50.0, 2, 0], [50, 98, 0]])
    plain, creased = retalho.fit_points(points), retalho.fit_points(points, breaklines=[ditch])
    x = np.array([49.0, 49.9, 50.1, 51.0])
    truth = np.abs(x - 50)
    assert np.abs(creased(x, 50.0) - truth).max() < 0.3 * np.abs(plain(x, 50.0) - truth).max()
    np.savetxt(tmp_path / "points.xyz", points, fmt="%.17g")
    (tmp_path / "lines.geojson").write_text(
        '{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": {"type": '
        '"LineString", "coordinates": [[50, 2, 0], [50, 98, 0]]}}]}')
    made = subprocess.run([program, "fit", tmp_path / "points.xyz", "-o", tmp_path / "m.retalho", "--breaklines",
                           tmp_path / "lines.geojson", "-q"], capture_output=True, text=True)
    if made.returncode == 0:  # GeoJSON has a CRS of its own, which the program may not take for points without one
        theirs = retalho.load(tmp_path / "m.retalho")
        assert isinstance(theirs, retalho.Terrain) and theirs.to_bytes() == creased.to_bytes()
    draped = retalho.fit_points(points, breaklines=[ditch[:, :2], np.array([[2.0, 50], [20, 50]])])
    assert len(draped.vertices) > len(points)
    with pytest.raises(ValueError, match="breaklines"):
        retalho.fit_points(points, breaklines=[ditch], max_error=1.0)
    with pytest.raises(ValueError, match="breaklines"):
        retalho.fit_points(points, breaklines=[[1, 2, 3, 4]])


def test_a_grids_surface_folds_along_creases() -> None:
    y, x = np.mgrid[0:41, 0:51]
    z = 3 * np.abs(x - 25.0) + 0.5 * y  # a roof with its ridge at x = 25
    ridge = np.array([[25.0, 0], [25, -40]])
    plain, folded = retalho.fit(z, vertices=60, refine="surface"), retalho.fit(z, vertices=60, creases=[ridge])
    assert folded.compare(z).max_error < 1e-5 < plain.compare(z).max_error
    chosen = retalho.fit(z, vertices=60, creases="auto")
    assert chosen.compare(z).rmse <= retalho.fit(z, vertices=60, creases="none").compare(z).rmse
    for words, wrong in (("give vertices or ratio", {"max_error": 1.0}), ("fold", {"vertices": 60, "surface": "linear"}),
                         ("fit='z-only'", {"vertices": 60, "fit": "z-only", "refine": "surface"}),
                         ("refine='surface'", {"vertices": 60, "refine": "flat"})):
        with pytest.raises(ValueError, match=words):
            retalho.fit(z, creases="auto", **wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="creases"):
        retalho.fit(z, vertices=60, creases="some")

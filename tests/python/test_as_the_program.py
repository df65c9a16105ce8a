"""What the program can do, by arrays: the same numbers, or the same bytes."""
from __future__ import annotations

import json
import pathlib
import subprocess
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from conftest import hills
from numpy.typing import NDArray

import retalho

PLACE = (30.0, 0.0, 500000.0, 0.0, -30.0, 4200000.0)
EYE = (500740.0, 4199110.0)  # not at a cell's centre


@pytest.fixture
def model(tmp_path: pathlib.Path) -> retalho.Terrain:
    z = hills(50, 60)
    z[20:24, 30:36] = np.nan
    made = retalho.fit(z, transform=PLACE, crs="EPSG:32611", max_error=2.0, refine="flat")
    made.save(tmp_path / "m.retalho")
    return made


def call(program: pathlib.Path, folder: pathlib.Path, *words: object) -> dict[str, Any]:
    done = subprocess.run([program, *map(str, words), "--json", "-q"], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert isinstance(said, dict)
    return said


def refuse(*cases: tuple[Callable[[], object], str]) -> None:
    for wrong, match in cases:
        with pytest.raises(ValueError, match=match):
            wrong()


def picture(path: pathlib.Path) -> NDArray[np.uint8]:
    gdal = pytest.importorskip("osgeo.gdal")
    return np.asarray(np.moveaxis(gdal.Open(str(path)).ReadAsArray(), 0, -1), dtype=np.uint8)


def test_exact_viewsheds(model: retalho.Terrain, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    observers = [(*EYE, 10.0), (501200.0, 4199400.0, 3.0)]
    words = [w for x, y, h in observers for w in ("--observer", f"{x},{y},{h}")]
    for what in ("count", "height"):
        call(program, tmp_path, "viewshed", "m.retalho", "-o", f"{what}.tif", "--exact", "--what", what, *words)
        theirs = retalho.read_grid(tmp_path / f"{what}.tif").heights
        ours = np.asarray(retalho.viewshed(model, observers, what=what, exact=True), dtype=np.float32)  # type: ignore[call-overload]
        seen = ~np.isnan(theirs)
        assert np.array_equal(theirs[seen], ours[seen])
        assert what == "height" or (ours[~seen] == 0).all()
    seen, cells = retalho.viewshed(model, observers, exact=True), retalho.viewshed(model, observers)
    assert seen.dtype == bool and 0 < (seen != cells).mean() < 0.2, "near those of cells, and others"
    with pytest.raises(ValueError, match="fit the grid first"):
        retalho.viewshed(hills(), (3, -3), exact=True)
    with pytest.raises(ValueError, match="no data"):
        retalho.viewshed(model, (500000 + 33 * 30, 4200000 - 22 * 30), exact=True)


def test_exact_sight_lines_and_their_pictures(
        model: retalho.Terrain, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    target = (501300.0, 4199600.0)
    for exact in (False, True):
        said = call(program, tmp_path, "viewshed", "m.retalho", "--observer", f"{EYE[0]},{EYE[1]},10", "--to",
                    f"{target[0]},{target[1]}", "--frequency", 2.4e9, "-o", "theirs.svg", "--overwrite",
                    *(["--exact"] if exact else []))
        line = retalho.line_of_sight(model, (*EYE, 10.0), target, frequency=2.4e9, exact=exact)
        assert line.visible == said["visible"] and line.clearance == said["clearance"]
        assert np.array_equal(line.profile[:, 0], [p["distance"] for p in said["profile"]])
        line.write(tmp_path / "ours.svg", overwrite=True)
        assert (tmp_path / "ours.svg").read_bytes() == (tmp_path / "theirs.svg").read_bytes()
    with pytest.raises(OSError):
        line.write(tmp_path / "ours.svg")
    assert tuple(line.profile[0, 1:3]) == pytest.approx(EYE), "where it is said to be, not in the middle of a cell"


def test_exact_counts_of_every_nth_cell(
        model: retalho.Terrain, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    call(program, tmp_path, "viewshed", "m.retalho", "-o", "n.tif", "--intervisibility", "--stride", 7, "--radius", 900)
    counts = retalho.intervisibility(model, stride=7, radius=900)
    assert np.array_equal(counts, retalho.read_grid(tmp_path / "n.tif").heights, equal_nan=True)
    assert counts.shape == (7, 9) and counts.dtype == np.float32
    grid = retalho.Grid(model.sample(), transform=PLACE, crs="EPSG:32611")
    row, column = 2 * 7 + 3, 5 * 7 + 3
    eye = (PLACE[2] + 30 * (column + 0.5), PLACE[5] - 30 * (row + 0.5))
    assert counts[2, 5] == retalho.viewshed(grid, eye, radius=900).sum()
    assert (counts[~np.isnan(counts)] == np.rint(counts[~np.isnan(counts)])).all()
    for stride, words in ((0, "1 or more"), (51, "60 x 50 cells")):
        with pytest.raises(ValueError, match=words):
            retalho.intervisibility(model, stride=stride)


def test_sight_lines_over_tiles_let_other_threads_run(tmp_path: pathlib.Path) -> None:
    z = np.random.default_rng(0).normal(size=(300, 300))
    retalho.Grid(z, transform=(1, 0, 0, 0, -1, 0)).write(tmp_path / "z.tif")
    retalho.TilePlan(tmp_path / "z.tif", size=100, max_error=0.4).make(tmp_path / "tiles", jobs=2)
    tiles = retalho.TiledModel(tmp_path / "tiles", memory=1)
    ticks, done = 0, threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.wait(0.005):
            ticks += 1

    ticker = threading.Thread(target=tick)
    ticker.start()
    start = time.monotonic()
    retalho.line_of_sight(tiles, (2.5, -2.5), (290.5, -280.5))
    took = time.monotonic() - start
    done.set()
    ticker.join()
    assert tiles.reads >= 3 and ticks > 20 * took, "the interpreter was held"


def test_conics(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    model = retalho.fit(hills(30, 40), transform=PLACE, max_error=4.0, surface="powell-sabin", refine="flat")
    model.save(tmp_path / "m.retalho")
    said = call(program, tmp_path, "contour", "m.retalho", "-o", "c.json", "--interval", 15, "--conics")
    lines = model.conics(interval=15)
    assert len(lines) == said["lines"] > 10 and {curve.degree for _, curve in lines} == {2}
    theirs = retalho.read_curves(tmp_path / "c.json")
    assert all(np.array_equal(a.control_points, b.control_points) for (_, a), b in zip(lines, theirs))
    quantum = said["height_quantum"]  # that heights are rounded to before they are traced
    assert quantum < 1e-4
    for level, curve in lines:
        x, y = curve(np.linspace(curve.breaks[0], curve.breaks[-1], 50)).T
        inside = ~np.isnan(model(x, y))  # the ends may lie outside by a rounding
        assert np.abs(model(x, y)[inside] - level).max() < 2 * quantum and inside.sum() >= 48
    with pytest.raises(ValueError, match="cubic"):
        retalho.fit(hills(30, 40), max_error=4.0, refine="flat").conics([0])
    with pytest.raises(ValueError, match="levels"):
        model.conics()


def two_balls() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    way = np.random.default_rng(2).normal(size=(1300, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    large = np.arange(1300) < 1000
    return np.where(large[:, None], way, 0.4 * way + (2, 0, 0)), way


def test_parts_of_a_surface(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    points, normals = two_balls()
    np.savetxt(tmp_path / "p.xyz", np.column_stack([points, normals]), fmt="%.17g")
    both = retalho.TetraQuad.fit(points, normals, resolution=12)
    parts = both.parts(points)
    assert [round(p["points"], -2) for p in parts] == [1000, 300]
    assert parts[0]["area"] == pytest.approx(4 * np.pi, rel=0.03)
    assert parts[1]["low"] == pytest.approx((1.6, -0.4, -0.4), abs=0.05)
    for option, words in (({"parts": 1}, ["--parts", 1]), ({"part_points": 500}, ["--part-points", 500])):
        one = retalho.TetraQuad.fit(points, normals, resolution=12, **option)  # type: ignore[arg-type]
        said = call(program, tmp_path, "reconstruct", "p.xyz", "-o", "p.retalho", "--resolution", 12, "--overwrite", *words)
        theirs = retalho.load(tmp_path / "p.retalho")
        assert one.to_bytes() == theirs.to_bytes() and len(one.parts(points)) == 1 == said["parts_left_out"]
        assert one.report is not None and one.report["residual_max"] == said["residual_max"]
        assert isinstance(theirs, retalho.TetraQuad) and theirs.report is None
    for option, said_of in (({"parts": 0}, "parts"), ({"part_points": 9999}, "9999"),
                            ({"resolution": 9, "adaptive": 5000}, "resolution")):
        with pytest.raises(ValueError, match=said_of):
            retalho.TetraQuad.fit(points, normals, **{"resolution": 8, **option})  # type: ignore[arg-type]
    guessed = retalho.estimate_normals(points, neighbours=12)
    assert (np.sum(guessed * normals, axis=1) > 0.9).mean() > 0.99


def test_pictures_in_space(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    points, normals = two_balls()
    ball = retalho.TetraQuad.fit(points, normals, resolution=10)
    ball.save(tmp_path / "b.retalho")
    call(program, tmp_path, "render", "b.retalho", "-o", "b.png", "--size", "180x180", "--no-captions", "--cut", "x<1.9",
         "--cut", "y>-0.5", "--outlines", "--jumps", "--up", "y", "--from", 30, "--elevation", 20)
    ours = ball.render(size=(160, 160), cuts=["x<1.9", "y>-0.5"], outlines=True, jumps=True, up="y", from_=30,
                       elevation=20)
    assert (picture(tmp_path / "b.png")[10:-10, 10:-10] == ours).all(), "a sheet has a margin of ten pixels"
    assert (ball.render(size=(90, 60), threads=1) == ball.render(size=(90, 60), threads=3)).all()
    for wrong, words in (({"cuts": ["q<1"]}, "axis"), ({"up": "w"}, "up must be 'x', 'y' or 'z', not 'w'"), ({"size": (3, 4)}, "size"),
                         ({"elevation": 95.0}, "horizon")):
        with pytest.raises(ValueError, match=words):
            ball.render(**wrong)  # type: ignore[arg-type]
    ball.write_tetrahedra(tmp_path / "b.vtk")
    assert (tmp_path / "b.vtk").read_text().count("\n") > ball.tetrahedra
    e, w = np.eye(3), 0.5 ** 0.5
    sides = [retalho.Curve.bspline([e[i], e[i] + e[j], e[j]], degree=2, weights=[1, w, 1])
             for i, j in ((0, 1), (1, 2), (2, 0))]
    octant = retalho.PatchSet([sides], divisions=8)
    octant.save(tmp_path / "o.retalho")
    for style in ("shaded", "lines", "isophotes", "zebra", "gaussian", "mean"):
        call(program, tmp_path, "patch", "o.retalho", "-o", "o.png", "--size", "120x100", "--style", style, "--overwrite")
        assert (picture(tmp_path / "o.png") == octant.render(size=(120, 100), style=style)).all()  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="style"):
        octant.render(style="stripes")  # type: ignore[arg-type]


def test_tables_of_models(model: retalho.Terrain, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    z = hills(50, 60)
    z[20:24, 30:36] = np.nan
    grid = retalho.Grid(z, transform=PLACE, crs="EPSG:32611")
    grid.write(tmp_path / "dem.tif")
    grid = retalho.read_grid(tmp_path / "dem.tif")
    flat = retalho.fit(grid, vertices=200, surface="linear")
    flat.save(tmp_path / "f.retalho")
    sight = ["--visibility", 600, "--directions", 16]
    said = call(program, tmp_path, "compare", "dem.tif", "m.retalho", "f.retalho", *sight)["models"]
    table = retalho.compare(grid, {"m.retalho": model, "f.retalho": flat}, visibility=600, directions=16)
    assert len(table) == len(said) == 2
    for ours, theirs in zip(table, said):
        for key, value in theirs.items():
            assert ours[key] == (tuple(value) if isinstance(value, list) else value), key  # type: ignore[literal-required]
        difference = ours["visibility_difference"]
        assert difference.shape == (50, 60) and np.nanmax(np.abs(difference)) == ours["visibility_max"]
        assert np.isnan(difference).sum() == 24 == 50 * 60 - ours["visibility_cells"]
    assert [row["name"] for row in retalho.compare(grid, [model, tmp_path / "f.retalho"])] == [
        "clough-tocher normals", str(tmp_path / "f.retalho")]
    asked: list[tuple[list[object], dict[str, Any], dict[str, retalho.Terrain] | None]] = [
        (["--ratio", "4%"], {"ratio": 0.04}, None),
        (["f.retalho", "--baselines"], {"baselines": True}, {"f.retalho": flat})]
    for words, options, models in asked:
        said = call(program, tmp_path, "compare", "dem.tif", *words)["models"]
        rows = retalho.compare(grid, models, **options)
        assert [dict(row, max_error_at=list(row["max_error_at"])) for row in rows] == said
    refuse((lambda: retalho.compare(grid), "give models"),
           (lambda: retalho.compare(grid, flat, vertices=9), "exclude each other"),
           (lambda: retalho.compare(grid, flat, baselines=True, visibility=0), "exclude each other"),
           (lambda: retalho.compare(grid, []), "empty"),
           (lambda: retalho.compare(grid, flat, visibility=-1), "radius of 0"))
    with pytest.raises(TypeError, match="Terrains or paths"):
        retalho.compare(grid, [3])  # type: ignore[list-item]


def test_rasters_to_files(model: retalho.Terrain, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    gdal = pytest.importorskip("osgeo.gdal")
    retalho.Grid(model.sample(), transform=PLACE, crs="EPSG:32611").write(tmp_path / "z.tif", cog=True)
    assert gdal.Open(str(tmp_path / "z.tif")).GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE") == "COG"
    retalho.TilePlan(tmp_path / "z.tif", size=32, max_error=2.0).make(tmp_path / "tiles", jobs=1)
    tiles = retalho.TiledModel(tmp_path / "tiles", memory=1)
    for what in ("height", "slope", "aspect", "curvature"):
        said = call(program, tmp_path, "sample", "tiles", "-o", "theirs.tif", "--what", what, "--cog", "--overwrite")
        facts = tiles.write_raster(tmp_path / "ours.tif", what=what, cog=True, overwrite=True)  # type: ignore[arg-type]
        assert facts["valid_cells"] == said["valid_cells"] and (facts["rows"], facts["columns"]) == (50, 60)
        assert (tmp_path / "ours.tif").read_bytes() == (tmp_path / "theirs.tif").read_bytes()
    place = (10.0, 0.0, 500305.0, 0.0, -10.0, 4199905.0)
    tiles.write_raster(tmp_path / "part.tif", place, (40, 50), what="slope")
    part = retalho.read_grid(tmp_path / "part.tif")
    assert part.transform == place
    assert np.array_equal(part.heights, tiles.sample(place, (40, 50), what="slope").astype("float32"), equal_nan=True)
    refuse((lambda: tiles.write_raster(tmp_path / "p.tif", what="normal"), "what"),  # type: ignore[arg-type]
           (lambda: tiles.write_raster(tmp_path / "p.asc", cog=True), ".tif"),
           (lambda: part.write(tmp_path / "p.asc", cog=True), ".tif"))
    with pytest.raises(OSError):
        tiles.write_raster(tmp_path / "part.tif")


def test_points_and_lines_from_files(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    rng = np.random.default_rng(4)
    xyz = np.column_stack([rng.uniform(0, 100, (300, 2)) + (500000, 4200000), rng.normal(size=300)])
    np.savetxt(tmp_path / "p.csv", xyz, fmt="%.17g", delimiter=",")
    (tmp_path / "bad.xyz").write_text("1 2 3\n1 nan 2\n4 5 6\n")
    points = retalho.read_points(tmp_path / "p.csv", crs="EPSG:32611")
    assert np.array_equal(points.positions, xyz) and np.array_equal(np.asarray(points), xyz)
    assert len(points) == 300 and points.normals is None and "UTM zone 11N" in (points.crs or "")
    assert not points.positions.flags.writeable and "300" in repr(points)
    assert retalho.read_points(tmp_path / "bad.xyz").skipped == 1
    ridge = np.array([[500020.0, 4200020, 3], [500080, 4200070, 3]])
    retalho.write_curves([retalho.Curve.polyline(ridge)], tmp_path / "ridge.shp")
    lines = retalho.read_lines(tmp_path / "ridge.shp")
    assert len(lines) == 1 and np.array_equal(lines[0], ridge)
    ours = retalho.fit_points(points, crs=points.crs, breaklines=lines)
    call(program, tmp_path, "fit", "p.csv", "-o", "p.retalho", "--crs", "EPSG:32611", "--breaklines", "ridge.shp")
    theirs = retalho.load(tmp_path / "p.retalho")
    assert isinstance(theirs, retalho.Terrain) and np.array_equal(theirs.vertices, ours.vertices)
    report = ours.compare_points(points)
    assert report.max_error < 1e-9 and report.valid_cells == 300
    assert ours.creases > 0 and ours.coefficients == len(ours.vertices) + 2 * len(ours.vertex_gradients)
    assert ours.numbers == 2 * len(ours.vertices) + ours.coefficients + ours.creases
    assert retalho.fit_points(points).numbers == 5 * 300
    left, bottom, right, top = ours.bounds
    assert left == pytest.approx(xyz[:, 0].min()) and top == pytest.approx(xyz[:, 1].max())
    assert right > left and top > bottom and ours.cross_derivative == "perpendicular"
    with pytest.raises(OSError):
        retalho.read_points(tmp_path / "none.xyz")
    with pytest.raises(ValueError, match="layer"):
        retalho.read_lines(tmp_path / "ridge.shp", layer="roads")


def test_what_curves_are_asked_for(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    loop = retalho.Curve.bezier([[0, 0], [3, 3], [-2, 3], [1, 0]])
    retalho.write_curves([loop], tmp_path / "c.json", names=["loop"])
    said = call(program, tmp_path, "curve", "c.json", "--crossings", "--closest", "1,2", "-o", "theirs.svg", "--control",
                "--comb", "--tangents", "--casteljau", 0.4, "--hodograph", "--joins", "--axes", "--title", "Loop",
                "--window=-1,-1,2,3", "--size", "300x200")["curves"][0]
    assert said["name"] == "loop"
    for key, ours in (("curvature_extrema", loop.curvature_extrema()), ("inflections", loop.inflections()),
                      ("closest", loop.closest_points((1, 2)))):
        value = "distance" if key == "closest" else "curvature"
        assert [(p["at"], tuple(p["point"]), p[value]) for p in said[key]] == ours
    crossing, = loop.self_intersections()
    assert loop(crossing[0]) == pytest.approx(loop(crossing[1])) and list(crossing[:2]) == said["self_intersections"][0]["at"]
    assert len(loop.closest_points((0.5, -1))) >= 2
    circle = [retalho.Curve.bspline([[1, 0], [1, 1], [0, 1]], degree=2, weights=[1, 0.5 ** 0.5, 1])]
    assert circle[0].area == pytest.approx(np.pi / 4 - 0.5), "closed by its chord"
    retalho.draw_curves(loop, tmp_path / "ours.svg", control=True, comb=True, tangents=True, casteljau=0.4, hodograph=True,
                        joins=True, axes=True, title="Loop", window=(-1, -1, 2, 3), size=(300, 200))
    assert (tmp_path / "ours.svg").read_bytes() == (tmp_path / "theirs.svg").read_bytes()
    read = retalho.read_curves(tmp_path / "ours.svg")
    assert any(c.control_points.shape == (4, 2) and np.allclose(c.control_points, loop.control_points) for c in read)
    retalho.write_curves([loop], tmp_path / "lines.json", flatten=1e-3)
    line, = retalho.read_curves(tmp_path / "lines.json")
    assert line.degree == 1 and max(loop.closest(p)[2] for p in line.control_points) < 1e-12
    with pytest.raises(ValueError, match="2 names for 1 curves"):
        retalho.write_curves([loop], tmp_path / "x.json", names=["a", "b"])
    for wrong, match in (({"window": (3, 3, 1, 1)}, "xmin < xmax"), ({"view": "back"}, "view"), ({"size": (9, 9)}, "size")):
        with pytest.raises(ValueError, match=match):
            retalho.draw_curves([loop], tmp_path / "x.png", **wrong)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="Curves"):
        retalho.draw_curves([3], tmp_path / "x.png")  # type: ignore[list-item]


def test_curves_by_formulas(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    graph = retalho.Graph("1 / x", -1, 2)
    assert len(graph.lines) == 2 and graph.breaks == pytest.approx([0], abs=1e-6) and graph.curve is None
    x, y = graph.lines[1].T
    assert y == pytest.approx(1 / x) and (np.diff(x) > 0).all()
    exact = retalho.Graph("x^3 - x", -2, 2).curve
    assert exact is not None and exact.degree == 3 and exact.control_points[0] == pytest.approx((-2, -6))
    circle = retalho.LevelSet("x^2 + y^2 - 1", (-2, -2, 2, 2), depth=6)
    ring, = circle.lines
    assert np.hypot(*ring.T) == pytest.approx(1) and np.array_equal(ring[0], ring[-1])
    cross = retalho.LevelSet("x * y", (-1, -1, 1.1, 1.2), depth=5)
    assert any(x0 <= 0 <= x1 and y0 <= 0 <= y1 for x0, y0, x1, y1 in cross.unresolved), "no line through the crossing"
    (tmp_path / "f.json").write_text(json.dumps({"curves": [
        {"kind": "implicit", "f": "x^2 + y^2 - 1", "box": [-2, -2, 2, 2]}, {"kind": "explicit", "f": "1 / x", "from": -1, "to": 2}]}))
    call(program, tmp_path, "curve", "f.json", "-o", "theirs.svg", "--depth", 6)
    retalho.draw_curves([circle, graph], tmp_path / "ours.svg")
    assert (tmp_path / "ours.svg").read_bytes() == (tmp_path / "theirs.svg").read_bytes()
    refuse((lambda: retalho.Graph("1 +", 0, 1), "1"), (lambda: retalho.LevelSet("x", (0, 0, 1)), "box"),
           (lambda: retalho.LevelSet("x", (0, 0, 1, 1), depth=99), "depth"))


def test_patches_of_meshes_and_their_derivatives(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    n = 9
    corner = [(i / n, j / n) for i in range(n + 1) for j in range(n + 1 - i)]
    number = {(round(u * n), round(v * n)): k for k, (u, v) in enumerate(corner)}
    points = np.array([(u, v, 0.3 * np.sin(2 * u) * v) for u, v in corner])
    triangles = [[number[i, j], number[i + 1, j], number[i, j + 1]] for i in range(n) for j in range(n - i)]
    triangles += [[number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]] for i in range(n - 1) for j in range(n - 1 - i)]
    mesh = retalho.Mesh(points, triangles)
    mesh.write(tmp_path / "m.ply")
    corners = [number[0, 0], number[n, 0], number[0, n]]
    ours = retalho.PatchSet.from_mesh(mesh, corners=corners)
    call(program, tmp_path, "patch", "m.ply", "-o", "m.retalho", "-o", "theirs.ply", "--refine", 3, "--corners",
         ",".join(map(str, corners)))
    assert ours.to_bytes() == retalho.load(tmp_path / "m.retalho").to_bytes()
    ours.mesh(refine=3).write(tmp_path / "ours.ply")
    assert (tmp_path / "ours.ply").read_bytes() == (tmp_path / "theirs.ply").read_bytes()
    patch, h = ours[0], 1e-5
    second = patch.second_derivatives(0.31, 0.27)
    slopes = (patch.derivatives(0.31 + h, 0.27) - patch.derivatives(0.31 - h, 0.27)) / (2 * h)
    assert second[:6] == pytest.approx(slopes, abs=1e-3), "d/du of d/du and of d/dv"
    refuse((lambda: retalho.PatchSet.from_mesh(mesh, corners=[0, 1]), "three"),
           (lambda: retalho.PatchSet.from_mesh(mesh, corners=[0, 1, 999]), "999"),
           (lambda: ours.mesh(refine=2, tolerance=0.1), "refine"))


def test_compact_budgets(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    retalho.Grid(hills(40, 40), transform=PLACE).write(tmp_path / "z.tif")
    grid = retalho.read_grid(tmp_path / "z.tif")
    call(program, tmp_path, "fit", "z.tif", "-o", "z.retalho", "--ratio", "5%", "--format", "compact", "--effort", "fast")
    assert retalho.fit_compact(grid, ratio=0.05, effort="fast") == (tmp_path / "z.retalho").read_bytes()
    with pytest.raises(ValueError, match="effort must be 'fast', 'normal' or 'best', not 'slow'"):
        retalho.fit_compact(grid, ratio=0.05, effort="slow")  # type: ignore[arg-type]


def test_surfaces_side_by_side(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    retalho.Grid(hills(40, 40), transform=PLACE).write(tmp_path / "z.tif")
    grid = retalho.read_grid(tmp_path / "z.tif")
    names = retalho.compare_surfaces(grid, tmp_path / "ours.svg", interval=30, zoom=12)
    said = call(program, tmp_path, "contour", "z.tif", "--interval", 30, "--compare-surfaces", "theirs.svg", "--zoom", 12)
    assert names == said["surfaces"] and len(names) == 8
    assert (tmp_path / "ours.svg").read_bytes() == (tmp_path / "theirs.svg").read_bytes()
    low, high = (float(f(grid.heights)) for f in (np.min, np.max))
    wide = retalho.render(grid, size=(60, 60), exaggeration=1.0, limits=(low - 500, high + 500))
    own = retalho.render(grid, size=(60, 60), exaggeration=1.0, limits=(low, high))
    half = retalho.render(grid.heights[:20], size=(60, 60), exaggeration=1.0, transform=PLACE, limits=(low - 500, high + 500))
    assert np.ptp(wide.astype(int), axis=(0, 1)).sum() < np.ptp(own.astype(int), axis=(0, 1)).sum()
    assert half.shape == wide.shape
    refuse((lambda: retalho.render(grid, limits=(3, 3)), r"limits must be \(low, high\)"),
           (lambda: retalho.compare_surfaces(np.full((9, 9), np.nan), tmp_path / "n.svg", interval=1), "no data"))

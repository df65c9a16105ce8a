"""Arrays in and out: what is no data, where cells lie, what is refused and in which words."""
from __future__ import annotations

import pathlib
import subprocess
import sys
from typing import Any

import numpy as np
import pytest
import xarray
from conftest import hills
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import retalho

UTM = (30.0, 0.0, 500000.0, 0.0, -30.0, 4200000.0)


def test_nan_masked_and_nodata_are_the_same() -> None:
    z = hills()
    void = np.zeros(z.shape, bool)
    void[10:20, 30:50] = True
    with_nan = np.where(void, np.nan, z)
    with_mask: np.ma.MaskedArray[Any, Any] = np.ma.masked_where(void, z)  # type: ignore[no-untyped-call]
    with_value = np.where(void, -9999.0, z)
    infinite = np.where(void, np.inf, z)
    expected = retalho.fit(with_nan, max_error=1.0).to_bytes()
    assert retalho.fit(with_mask, max_error=1.0).to_bytes() == expected
    assert retalho.fit(with_value, nodata=-9999, max_error=1.0).to_bytes() == expected
    assert retalho.fit(infinite, max_error=1.0).to_bytes() == expected
    sampled = retalho.fit(with_nan, max_error=1.0).sample()
    assert np.array_equal(np.isnan(sampled), void)


@given(hnp.arrays(st.sampled_from([np.int16, np.uint8, np.int32, np.float32, np.float64]), (5, 7),
                  elements=st.integers(0, 200)))
def test_any_number_type_gives_the_same_heights(z: np.ndarray[tuple[int, int], np.dtype[np.float64]]) -> None:
    grid = retalho.Grid(z)
    assert np.array_equal(grid.heights, z)
    assert np.array_equal(retalho.Grid(z.tolist()).heights, z)
    assert np.array_equal(retalho.Grid(np.asfortranarray(z)).heights, z)
    assert np.array_equal(retalho.Grid(z[::-1, ::-1]).heights, z[::-1, ::-1])


def test_heights_are_float32_only_where_that_is_exact() -> None:
    assert retalho.Grid(np.array([[1.5, 2.0], [3.0, 4.0]])).heights.dtype == np.float32
    assert retalho.Grid(np.array([[0.1, 2.0], [3.0, 4.0]])).heights.dtype == np.float64
    assert retalho.Grid(np.array([[16777217, 2], [3, 4]])).heights.dtype == np.float64


def test_transform_and_crs() -> None:
    grid = retalho.Grid(hills(), transform=UTM, crs="EPSG:32611")
    assert grid.transform == UTM
    assert grid.crs is not None and "UTM zone 11N" in grid.crs
    assert grid.unit == "metre"
    assert repr(grid) == "<retalho.Grid 60 x 80 cells of 30 x 30 metre, WGS 84 / UTM zone 11N>"
    model = retalho.fit(grid, max_error=0.0)
    # Centres of cells, rows from north.
    assert model(500015.0, 4199985.0) == pytest.approx(hills()[0, 0], abs=1e-9)
    assert model(500015.0 + 30 * 7, 4199985.0 - 30 * 3) == pytest.approx(hills()[3, 7], abs=1e-9)
    degrees = retalho.Grid(hills(), transform=(0.001, 0, -122, 0, -0.001, 46), crs="EPSG:4326")
    assert degrees.unit == "metre"
    assert np.allclose(degrees.transform, (0.001, 0, -122, 0, -0.001, 46), rtol=1e-14)


class Wkt:
    """As rasterio's and pyproj's CRS."""

    def __init__(self, text: str) -> None:
        self.text = text

    def to_wkt(self) -> str:
        return self.text


def test_crs_objects_and_paths(tmp_path: pathlib.Path) -> None:
    grid = retalho.Grid(hills(), transform=UTM, crs="EPSG:32611")
    assert grid.crs is not None
    assert retalho.Grid(hills(), transform=UTM, crs=Wkt(grid.crs)).crs == grid.crs
    path = tmp_path / "z.tif"
    grid.write(path)
    again = retalho.read_grid(path)
    assert np.allclose(again.heights, grid.heights, atol=1e-12)
    assert again.transform == UTM
    assert retalho.fit(path, max_error=1).to_bytes() == retalho.fit(str(path), max_error=1).to_bytes()
    with pytest.raises(OSError, match="z.tif.*exists"):
        grid.write(path)
    grid.write(path, overwrite=True)


def test_data_arrays_lie_by_their_coordinates() -> None:
    z = hills(20, 30)
    x, y = 500015.0 + 30 * np.arange(30), 4199985.0 - 30 * np.arange(20)
    expected = retalho.fit(z, transform=UTM, crs="EPSG:32611", max_error=1.0).to_bytes()
    north = xarray.DataArray(z, dims=("y", "x"), coords={"y": y, "x": x}, attrs={"crs": "EPSG:32611"})
    assert retalho.fit(north, max_error=1.0).to_bytes() == expected
    assert retalho.fit(north[::-1], max_error=1.0).to_bytes() == expected, "rows from south are turned"
    assert retalho.fit(north[:, ::-1], max_error=1.0).to_bytes() == expected, "columns from east are turned"
    filled = north.where(north > 0, -1e4)
    filled.attrs["_FillValue"] = -1e4
    assert np.isnan(retalho.Grid(filled).heights).sum() == (z <= 0).sum()
    with pytest.raises(ValueError, match="'x' is not evenly spaced"):
        retalho.Grid(north.assign_coords(x=np.geomspace(1, 30, 30)))
    with pytest.raises(ValueError, match="two dimensions"):
        retalho.Grid(north.expand_dims("band"))


def test_xarray_is_not_imported() -> None:
    code = "import sys, numpy, retalho; retalho.fit(numpy.eye(5)); sys.exit('xarray' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


@pytest.mark.parametrize(("z", "options", "words"), [
    (np.zeros((2, 3, 4)), {}, r"not \(2, 3, 4\)"),
    (np.zeros(7), {}, r"not \(7,\)"),
    (np.zeros((0, 4)), {}, r"not \(0, 4\)"),
    (np.full((4, 4), np.nan), {}, "valid"),
    (np.zeros((4, 4)), {"transform": (1, 0, 0, 0, 1, 0)}, r"z\[::-1\]"),
    (np.zeros((4, 4)), {"transform": (1, 0.5, 0, 0, -1, 0)}, "rotated"),
    (np.zeros((4, 4)), {"transform": (1, 0, 0, 0, -1)}, r"\(5,\)"),
    (np.zeros((4, 4)), {"transform": (1, 0, np.nan, 0, -1, 0)}, "not finite"),
    (np.zeros((4, 4)), {"crs": "EPSG:32611"}, "crs without transform"),
    (np.zeros((4, 4)), {"transform": UTM, "crs": "EPSG:1"}, "'EPSG:1' is not a CRS"),
    (np.zeros((4, 4)), {"max_error": -1.0}, "max_error.*-1"),
    (np.zeros((4, 4)), {"vertices": 2}, "vertices.*2"),
    (np.zeros((4, 4)), {"ratio": 1.5}, "ratio.*1.5"),
    (np.zeros((4, 4)), {"vertices": 5, "ratio": 0.5}, "one of them"),
    (np.zeros((4, 4)), {"surface": "cubic"}, "'powell-sabin'.*'cubic'"),
    (np.zeros((4, 4)), {"threads": -1}, "threads.*-1"),
    (np.zeros((4, 4)), {"gradients": "network", "fit": "least-squares"}, "gradients"),
])
def test_what_is_refused(z: object, options: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words) as caught:
        retalho.fit(z, **options)  # type: ignore[arg-type]
    assert isinstance(caught.value, retalho.Error)
    assert caught.value.kind in ("usage", "bad_input")


def test_types_that_are_refused() -> None:
    with pytest.raises(TypeError, match="complex128"):
        retalho.fit(np.zeros((3, 3), complex))
    with pytest.raises(TypeError, match="crs must be a str"):
        retalho.fit(np.zeros((3, 3)), transform=UTM, crs=32611)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="progress"):
        retalho.fit(hills(), progress=7)  # type: ignore[arg-type]
    with pytest.raises(TypeError):
        retalho.fit(hills(), UTM)  # type: ignore[misc]  # options by name only


def test_views_share_memory_and_outlive_the_name() -> None:
    model = retalho.fit(hills(), max_error=1.0)
    triangles, again = model.triangles, model.triangles
    assert np.shares_memory(triangles, again)
    assert not triangles.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        triangles[0, 0] = 1
    copy = triangles.copy()
    del model, again
    assert np.array_equal(triangles, copy)
    grid = retalho.Grid(hills())
    assert np.shares_memory(grid.heights, np.asarray(grid))


def test_broadcasting() -> None:
    model = retalho.fit(hills(), max_error=1.0)
    x, y = np.linspace(0, 79, 11), -np.linspace(0, 59, 7)[:, None]
    z = model(x, y)
    assert z.shape == (7, 11)
    assert isinstance(model(3.0, -4.0), float)
    assert z[2, 5] == model(x[5], y[2, 0])
    assert model.gradient(x, y).shape == (7, 11, 2)
    assert model.normal(x, y).shape == (7, 11, 3)
    assert np.isnan(model([-5.0, np.nan, np.inf], [-3.0, -3.0, -3.0])).all()
    with pytest.raises(ValueError, match=r"x and y.*\(3,\) and \(4,\)"):
        model(np.zeros(3), np.zeros(4))

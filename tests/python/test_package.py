"""The package itself: types, docstrings, the tour, rasterio beside it."""
from __future__ import annotations

import ast
import inspect
import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest
from conftest import ROOT, hills

import retalho

PACKAGE = pathlib.Path(retalho.__file__).parent
STUB = ast.parse((PACKAGE / "_retalho.pyi").read_text() + (PACKAGE / "_shapes.pyi").read_text())


def test_types_are_checked_strictly(tmp_path: pathlib.Path) -> None:
    """The stub, and these tests against it."""
    environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
    here = pathlib.Path(__file__).parent
    command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml"), "--cache-dir",
               str(tmp_path), "-p", "retalho"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    command[-2:] = [str(path) for path in sorted(here.glob("*.py"))]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=here)
    assert done.returncode == 0, done.stdout


def test_types_find_a_mistake(tmp_path: pathlib.Path) -> None:
    (tmp_path / "wrong.py").write_text("import retalho\nretalho.fit([[1.0]], max_error='2')\n")
    environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "c"), "wrong.py"],
                          capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert done.returncode == 1 and "max_error" in done.stdout


def signature(docstring: str) -> list[str]:
    """Names of pybind11's signature line, with "*" where options begin."""
    inside = docstring.split("(", 1)[1]
    depth, names, word = 0, [], ""
    for letter in inside:
        if letter == ")" and depth == 0:
            break
        depth += (letter in "([{") - (letter in ")]}")
        if letter == "," and depth == 0:
            names.append(word)
            word = ""
        else:
            word += letter
    names.append(word)
    return [n for n in (re.split(r"[:=]", name)[0].strip() for name in names) if n and n != "self" and n != "arg0"]


def stub_names(function: ast.FunctionDef) -> list[str]:
    a = function.args
    return [x.arg for x in a.args if x.arg != "self"] + (["*"] if a.kwonlyargs else []) + [x.arg for x in a.kwonlyargs]


def stubbed() -> list[tuple[str, ast.FunctionDef, object]]:
    found: list[tuple[str, ast.FunctionDef, object]] = []
    for node in STUB.body:
        if isinstance(node, ast.FunctionDef):
            found.append((node.name, node, getattr(retalho, node.name)))
        elif isinstance(node, ast.ClassDef) and hasattr(retalho, node.name):
            owner = getattr(retalho, node.name)
            for inner in node.body:
                if isinstance(inner, ast.FunctionDef):
                    found.append((f"{node.name}.{inner.name}", inner, inspect.getattr_static(owner, inner.name)))
    return found


def test_the_stub_names_what_is_there() -> None:
    compared = 0
    for name, node, thing in stubbed():
        decorators = [d.id for d in node.decorator_list if isinstance(d, ast.Name)]
        if isinstance(thing, property):
            assert decorators == ["property"], name
            continue
        assert "property" not in decorators, name
        if isinstance(thing, staticmethod):
            assert decorators == ["staticmethod"], name
            thing = thing.__func__
        document = thing.__doc__ or ""
        if node.name in ("__len__", "__iter__", "__array__"):
            continue
        order = signature(document)
        expected = stub_names(node)
        assert [n for n in order if n != "*"][: len(expected)] == order[: len(expected)] or "*" in order, name
        at = expected.index("*") if "*" in expected else len(expected)
        # Overloads may name the options in another order.
        assert order[:at] == expected[:at] and sorted(order) == sorted(expected), f"{name}: {order}, stub {expected}"
        compared += 1
    assert compared > 50


def test_everything_public_is_stubbed_and_described() -> None:
    names = {node.name for node in STUB.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    for name in retalho.__all__:
        if name == "__version__":
            continue
        assert name in names, f"{name} has no types"
        thing = getattr(retalho, name)
        assert (thing.__doc__ or "").strip(), f"{name} has no docstring"
        if inspect.isclass(thing) and not issubclass(thing, Exception):
            stub = next(n for n in STUB.body if isinstance(n, ast.ClassDef) and n.name == name)
            typed = {n.name for n in stub.body if isinstance(n, ast.FunctionDef)}
            typed |= {n.target.id for n in stub.body if isinstance(n, ast.AnnAssign) and isinstance(n.target, ast.Name)}
            public = {n for n in vars(thing) if not n.startswith("_")}
            assert public - typed == set(), f"{name} has attributes without types"
            assert thing.__module__ == "retalho"
            assert "__repr__" in vars(thing), name
    assert retalho.__version__ == (ROOT / "VERSION").read_text().strip()


def test_errors_are_values_and_files() -> None:
    assert issubclass(retalho.UsageError, ValueError) and issubclass(retalho.BadInput, ValueError)
    assert issubclass(retalho.CannotRead, OSError) and issubclass(retalho.CannotWrite, OSError)
    for error in (retalho.UsageError, retalho.BadInput, retalho.CannotRead, retalho.CannotWrite):
        assert issubclass(error, retalho.Error)


def test_the_tour_runs(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """docs/python.md from top to bottom, as one session; what it shows after >>> is what comes out."""
    import doctest

    text = (ROOT / "docs" / "python.md").read_text()
    blocks = re.findall(r"```pycon\n(.*?)```", text, re.S)
    assert len(blocks) >= 8
    monkeypatch.chdir(tmp_path)
    session = doctest.DocTestParser().get_doctest("\n".join(blocks), {}, "docs/python.md", None, 0)
    assert len(session.examples) > 20
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS)
    result = runner.run(session)
    assert result.failed == 0, capsys.readouterr().out


def test_rasterio_round_trip(tmp_path: pathlib.Path) -> None:
    rasterio = pytest.importorskip("rasterio", reason="python3-rasterio is not installed")
    transform = rasterio.Affine(30, 0, 500000, 0, -30, 4200000)
    z = hills().astype("float32")
    z[5:9, 5:9] = -9999
    path = tmp_path / "z.tif"
    with rasterio.open(path, "w", driver="GTiff", width=80, height=60, count=1, dtype="float32", nodata=-9999,
                       transform=transform, crs=rasterio.crs.CRS.from_epsg(32611)) as out:
        out.write(z, 1)
    with rasterio.open(path) as file:
        band, where, crs = file.read(1, masked=True), file.transform, file.crs
    model = retalho.fit(band, transform=where, crs=crs, max_error=1.0)
    own = retalho.fit(path, max_error=1.0)  # but for the words of its WKT
    assert np.array_equal(model.vertices, own.vertices) and np.array_equal(model.triangles, own.triangles)
    assert model.crs is not None and own.crs is not None
    assert rasterio.crs.CRS.from_wkt(model.crs) == rasterio.crs.CRS.from_wkt(own.crs)
    assert model.transform is not None and rasterio.Affine(*model.transform) == transform
    smooth = model.sample(where, band.shape)
    back = tmp_path / "smooth.tif"
    with rasterio.open(back, "w", driver="GTiff", width=80, height=60, count=1, dtype="float64", nodata=np.nan,
                       transform=where, crs=model.crs) as out:
        out.write(smooth, 1)
    again = retalho.read_grid(back)
    assert np.array_equal(again.heights, smooth, equal_nan=True) and again.transform == tuple(where)[:6]
    assert np.isnan(smooth).sum() == 16
    report = model.compare(again)
    assert report.max_error < 1e-9 and report.valid_cells == 80 * 60 - 16

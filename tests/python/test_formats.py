"""Formats of other programs, read anew by small validators of their specifications: LandXML 1.2, quantized-mesh 1.0,
3D Tiles 1.1 with glTF."""
from __future__ import annotations

import gzip
import json
import math
import pathlib
import struct
import subprocess
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from conftest import hills
from numpy.typing import NDArray

import retalho

Array = NDArray[Any]
A, B = 6378137.0, 6356752.3142451793  # WGS 84
TRANSFORM = (30.0, 0.0, 500000.0, 0.0, -30.0, 4200000.0)


@pytest.fixture
def model(tmp_path: pathlib.Path, program: pathlib.Path) -> pathlib.Path:
    z = 1500 + 3 * hills(90, 120)
    z[60:70, 20:50] = np.nan
    retalho.Grid(z, transform=TRANSFORM, crs="EPSG:32611").write(tmp_path / "dem.tif")
    path = tmp_path / "m.retalho"
    subprocess.run([program, "fit", tmp_path / "dem.tif", "-o", path, "--max-error", "2", "-q"], check=True,
                   capture_output=True)
    return path


def mesh(program: pathlib.Path, *arguments: object, code: int = 0) -> str:
    done = subprocess.run([program, "mesh", *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return done.stdout if code == 0 else done.stderr


def degrees(points: Array) -> Array:
    """EPSG:32611 to longitude and latitude, by PROJ's own program."""
    text = "\n".join(f"{x!r} {y!r}" for x, y in points.tolist())
    done = subprocess.run(["gdaltransform", "-s_srs", "EPSG:32611", "-t_srs", "+proj=longlat +datum=WGS84",
                           "-output_xy"], input=text, capture_output=True, text=True, check=True)
    return np.array([[float(w) for w in line.split()] for line in done.stdout.splitlines()])


def earth_centred(lonlat: Array, height: Array) -> Array:
    lon, lat = np.radians(lonlat[..., 0]), np.radians(lonlat[..., 1])
    e2 = 1 - (B / A) ** 2
    n = A / np.sqrt(1 - e2 * np.sin(lat) ** 2)
    return np.stack([(n + height) * np.cos(lat) * np.cos(lon), (n + height) * np.cos(lat) * np.sin(lon),
                     (n * (1 - e2) + height) * np.sin(lat)], axis=-1)


# LandXML

SPACE = "{http://www.landxml.org/schema/LandXML-1.2}"
UNITS = {"areaUnit", "linearUnit", "volumeUnit", "temperatureUnit", "pressureUnit"}


def read_landxml(path: pathlib.Path) -> tuple[Array, Array, Any]:
    """(points as x, y, z; faces from 0; root), by what LandXML-1.2.xsd demands of a TIN."""
    root = ElementTree.parse(path).getroot()
    assert root.tag == SPACE + "LandXML" and root.get("version") == "1.2"
    assert root.get("date") and root.get("time"), "required by the schema"
    units = root.findall(SPACE + "Units")
    assert len(units) == 1 and len(units[0]) == 1
    assert set(units[0][0].attrib) >= UNITS
    surface, = root.findall(f"{SPACE}Surfaces/{SPACE}Surface")
    assert surface.get("name")
    definition, = surface.findall(SPACE + "Definition")
    assert definition.get("surfType") == "TIN" and [e.tag for e in definition] == [SPACE + "Pnts", SPACE + "Faces"]
    number: dict[str, int] = {}
    points: list[tuple[float, float, float]] = []
    for p in definition[0]:
        assert p.tag == SPACE + "P" and p.text
        name = p.attrib["id"]
        assert name not in number and int(name) > 0
        number[name] = len(points)
        north, east, up = map(float, p.text.split())
        points.append((east, north, up))
    faces = []
    for f in definition[1]:
        assert f.tag == SPACE + "F" and f.text
        corners = f.text.split()
        assert len(corners) == 3
        faces.append([number[c] for c in corners])
    return np.array(points), np.array(faces), root


def test_landxml(model: pathlib.Path, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    mesh(program, model, "-o", tmp_path / "s.xml", "--tolerance", "1")
    mesh(program, model, "-o", tmp_path / "s.landxml", "--tolerance", "1")
    mesh(program, model, "-o", tmp_path / "s.ply", "--tolerance", "1")
    assert (tmp_path / "s.xml").read_bytes() == (tmp_path / "s.landxml").read_bytes()
    points, faces, root = read_landxml(tmp_path / "s.xml")
    assert len(faces) > 1000
    terrain = retalho.load(model)
    assert isinstance(terrain, retalho.Terrain)
    twin = terrain.mesh(tolerance=1.0)
    assert (points == twin.positions + twin.offset).all() and (faces == twin.triangles).all()
    assert points[:, 0].min() >= 500000 and points[:, 1].min() > 4000000, "easting and northing are in their places"
    heights = terrain(points[:, 0], points[:, 1])
    inside = np.isfinite(heights)
    assert inside.sum() > 0.9 * len(points)
    assert np.abs(heights - points[:, 2])[inside].max() < 1e-9
    a, b, c = (points[faces[:, k], :2] for k in range(3))
    assert ((b - a)[:, 0] * (c - a)[:, 1] > (b - a)[:, 1] * (c - a)[:, 0]).all(), "counter-clockwise"
    crs = root.find(SPACE + "CoordinateSystem")
    assert crs is not None and crs.get("epsgCode") == "32611" and "UTM zone 11N" in (crs.get("ogcWktCode") or "")
    assert root.find(SPACE + "Units")[0].get("linearUnit") == "meter"
    words = mesh(program, model, "-o", tmp_path / "s.xml", code=5)
    assert "--overwrite" in words


# quantized-mesh

@dataclass
class Tile:
    u: Array
    v: Array
    height: Array  # metres
    triangles: Array
    normals: Array
    centre: Array
    sphere: Array
    occlusion: Array
    edges: list[Array]  # west, south, east, north


def read_tile(data: bytes) -> Tile:
    """By the specification, all of the bytes."""
    if data[:2] == b"\x1f\x8b":
        data = gzip.decompress(data)
    at = 0

    def take(form: str) -> tuple[Any, ...]:
        nonlocal at
        values = struct.unpack_from("<" + form, data, at)
        at += struct.calcsize("<" + form)
        return values

    head = take("3d2f4d3d")
    count, = take("I")

    def decode() -> Array:
        raw = np.array(take(f"{count}H"), dtype=np.int64)
        values = np.cumsum((raw >> 1) ^ -(raw & 1))
        assert values.min() >= 0 and values.max() <= 32767
        return np.asarray(values)

    u, v, h = decode(), decode(), decode()
    wide = count > 65536
    size, letter = (4, "I") if wide else (2, "H")
    at += -at % size
    triangles, = take("I")
    codes = take(f"{3 * triangles}{letter}")
    highest, indices = 0, []
    for code in codes:
        indices.append(highest - code)
        highest += code == 0
    assert min(indices) >= 0 and max(indices) < count and highest == count, "every vertex is used"
    edges = []
    for _ in range(4):
        n, = take("I")
        edges.append(np.array(take(f"{n}{letter}"), dtype=np.int64))
    normals = np.zeros((0, 3))
    while at < len(data):
        kind, length = take("BI")
        assert kind == 1 and length == 2 * count
        xy = np.array(take(f"{length}B"), dtype=np.float64).reshape(-1, 2) / 255 * 2 - 1
        z = 1 - np.abs(xy).sum(axis=1)
        folded = (1 - np.abs(xy[:, ::-1])) * np.where(xy < 0, -1, 1)
        xy = np.where(z[:, None] < 0, folded, xy)
        normals = np.column_stack([xy, z])
        normals /= np.linalg.norm(normals, axis=1)[:, None]
    assert at == len(data)
    low, high = head[3], head[4]
    return Tile(u, v, low + h / 32767 * (high - low), np.array(indices).reshape(-1, 3), normals,
                np.array(head[:3]), np.array(head[5:9]), np.array(head[9:12]), edges)


def positions(tile: Tile, level: int, x: int, y: int) -> Array:
    size = 180 / 2 ** level
    lonlat = np.column_stack([-180 + size * (x + tile.u / 32767), -90 + size * (y + tile.v / 32767)])
    return earth_centred(lonlat, tile.height)


def check_tile(tile: Tile, level: int, x: int, y: int) -> None:
    on = [tile.u == 0, tile.v == 0, tile.u == 32767, tile.v == 32767]
    for edge, here in zip(tile.edges, on, strict=True):
        assert sorted(edge) == sorted(np.flatnonzero(here)) and len(edge) >= 2
    places = np.column_stack([tile.u, tile.v])
    assert len(np.unique(places, axis=0)) == len(places)
    a, b, c = (places[tile.triangles[:, k]] for k in range(3))
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert (area > 0).all(), "counter-clockwise"
    assert area.sum() == 2 * 32767 ** 2, "the triangles cover the tile once"
    p = positions(tile, level, x, y)
    assert (np.linalg.norm(p - tile.sphere[:3], axis=1) <= tile.sphere[3] * (1 + 1e-12)).all()
    size = 180 / 2 ** level
    middle = earth_centred(np.array([-180 + size * (x + 0.5), -90 + size * (y + 0.5)]), np.array(0.0))
    assert np.linalg.norm(tile.centre - middle) < 1e5
    if level >= 6:  # seen from the occlusion point, no vertex rises over the horizon plane behind it
        scaled = p / (A, A, B)
        length2 = (tile.occlusion ** 2).sum()
        assert length2 >= 1
        # Where the point itself is hidden from a camera on its own axis' far side, so are all vertices.
        camera = -tile.occlusion / math.sqrt(length2) * 3
        to = scaled - camera
        beyond = -(to @ camera) > (camera @ camera) - 1
        cone = (to @ -camera) ** 2 > ((camera @ camera) - 1) * (to * to).sum(axis=1)
        assert (beyond & cone).all()
    assert np.allclose(np.linalg.norm(tile.normals, axis=1), 1)
    assert (np.einsum("ij,ij->i", tile.normals, p / np.linalg.norm(p, axis=1)[:, None]) > 0).all(), "normals look up"


def test_quantized_mesh(model: pathlib.Path, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    folder = tmp_path / "q"
    printed = json.loads(mesh(program, model, "-o", folder / "layer.json", "--tolerance", "1", "--level", "13", "--json"))
    layer = json.loads((folder / "layer.json").read_text())
    assert layer["format"] == "quantized-mesh-1.0" and layer["scheme"] == "tms" and layer["projection"] == "EPSG:4326"
    assert layer["extensions"] == ["octvertexnormals"] and layer["maxzoom"] == 13 and layer["minzoom"] == 0
    assert len(layer["available"]) == 14 and layer["available"][0] == [{"startX": 0, "startY": 0, "endX": 1, "endY": 0}]
    tiles: dict[tuple[int, int, int], Tile] = {}
    for level, (part,) in enumerate(layer["available"]):
        for x in range(part["startX"], part["endX"] + 1):
            for y in range(part["startY"], part["endY"] + 1):
                path = folder / str(level) / str(x) / f"{y}.terrain"
                data = path.read_bytes()
                assert data[:2] == b"\x1f\x8b"
                tiles[level, x, y] = read_tile(data)
    assert len(tiles) == printed["tiles"] == len(list(folder.rglob("*.terrain")))
    finest = [key for key in tiles if key[0] == 13]
    assert len(finest) >= 6
    for key, tile in tiles.items():
        check_tile(tile, *key)
    # Neighbours, read back: the same places, heights to the bit, and normals.
    joined = 0
    for level, x, y in tiles:
        a = tiles[level, x, y]
        for dx, dy, mine, other, along in ((1, 0, 2, 0, "v"), (0, 1, 3, 1, "u")):
            b = tiles.get((level, x + dx, y + dy))
            if b is None:
                continue
            i, j = a.edges[mine], b.edges[other]
            i, j = i[np.argsort(getattr(a, along)[i])], j[np.argsort(getattr(b, along)[j])]
            assert (getattr(a, along)[i] == getattr(b, along)[j]).all() and len(i) == len(j)
            assert (a.height[i] == b.height[j]).all()
            assert (a.normals[i] == b.normals[j]).all()
            joined += int(level == 13 and len(i) > 5)
    assert joined >= 4, "edges with something on them"
    # The heights are the model's, at the places that the tiles say.
    terrain = retalho.load(model)
    assert isinstance(terrain, retalho.Terrain)
    dem = retalho.read_grid(tmp_path / "dem.tif")
    corner = degrees(np.array([[500000 + 30 * 60, 4200000 - 30 * 45]]))[0]
    size = 180 / 2 ** 13
    x, y = int((corner[0] + 180) // size), int((corner[1] + 90) // size)
    tile = tiles[13, x, y]
    lonlat = np.column_stack([-180 + size * (x + tile.u / 32767), -90 + size * (y + tile.v / 32767)])
    back = subprocess.run(["gdaltransform", "-s_srs", "+proj=longlat +datum=WGS84", "-t_srs", "EPSG:32611",
                           "-output_xy"], input="\n".join(f"{a!r} {b!r}" for a, b in lonlat.tolist()),
                          capture_output=True, text=True, check=True)
    xy = np.array([[float(w) for w in line.split()] for line in back.stdout.splitlines()])
    here = terrain(xy[:, 0], xy[:, 1])
    inside = np.isfinite(here)
    assert inside.sum() > 50
    assert np.abs(here - tile.height)[inside].max() <= printed["step"]
    assert (tile.height[~inside] == 0).all(), "what is not covered has the height that was said"
    assert dem.shape == (90, 120)
    # Normals against the gradient of the model, in the plane of the map (converges within a degree of north here).
    gradient = terrain.gradient(xy[:, 0], xy[:, 1])
    lon, lat = np.radians(lonlat[:, 0]), np.radians(lonlat[:, 1])
    east = np.column_stack([-np.sin(lon), np.cos(lon), 0 * lon])
    up = np.column_stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    north = np.cross(up, east)
    normal = up - gradient[:, :1] * east - gradient[:, 1:] * north
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    angle = np.degrees(np.arccos(np.clip(np.einsum("ij,ij->i", normal, tile.normals), -1, 1)))[inside]
    assert angle.max() < 2.0 and np.abs(gradient[inside]).max() > 0.3, "oct-encoding in 16 bits is within a degree"
    # Options: no normals, no gzip, another height outside; what is there is not replaced unasked.
    mesh(program, model, "-o", folder / "layer.json", "--level", "3", code=5)
    mesh(program, model, "-o", tmp_path / "r" / "layer.json", "--level", "3", "--outside", "-50", "--no-gzip",
         "--no-normals")
    plain = (tmp_path / "r" / "0" / "0" / "0.terrain").read_bytes()
    assert plain[:2] != b"\x1f\x8b" and len(read_tile(plain).normals) == 0 and read_tile(plain).height.min() == -50
    assert "extensions" not in json.loads((tmp_path / "r" / "layer.json").read_text())
    mesh(program, model, "-o", tmp_path / "s" / "layer.json", "--level", "99", code=2)


# 3D Tiles

def read_glb(path: pathlib.Path) -> tuple[Array, Array, Array]:
    """Positions, normals and triangles in the axes of the scene: glTF's, y up."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert magic == b"glTF" and version == 2 and length == len(data)
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON" and size % 4 == 0
    document = json.loads(data[20:20 + size])
    binary, kind = struct.unpack_from("<I4s", data, 20 + size)
    assert kind == b"BIN\0" and 28 + size + binary == len(data)
    body = data[28 + size:]

    def values(index: int, form: str, width: int) -> Array:
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        return np.frombuffer(body, form, accessor["count"] * width, view["byteOffset"]).reshape(-1, width)

    primitive = document["meshes"][0]["primitives"][0]
    p = values(primitive["attributes"]["POSITION"], "<f4", 3).astype(np.float64)
    n = values(primitive["attributes"]["NORMAL"], "<f4", 3).astype(np.float64)
    t = values(primitive["indices"], "<u4", 1).reshape(-1, 3)
    root = document["nodes"][document["scenes"][0]["nodes"][0]]
    node = document["nodes"][root["children"][0]]
    p = p + np.array(node["translation"])
    x, y, z, w = root["rotation"]
    q = np.array([x, y, z])

    def turn(v: Array) -> Array:
        return np.asarray(v + 2 * np.cross(q, np.cross(q, v) + w * v))

    return turn(p), turn(n), t


def z_up(v: Array) -> Array:
    """What a reader of 3D Tiles does with glTF's y-up."""
    return np.asarray(np.column_stack([v[:, 0], -v[:, 2], v[:, 1]]))


def test_three_d_tiles(model: pathlib.Path, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    folder = tmp_path / "t"
    printed = json.loads(mesh(program, model, "-o", folder / "tileset.json", "--tolerance", "1", "--tile-triangles",
                              "3000", "--json"))
    tileset = json.loads((folder / "tileset.json").read_text())
    assert tileset["asset"]["version"] == "1.1" and tileset["geometricError"] > 0
    root = tileset["root"]
    assert root["refine"] == "ADD" and len(root["children"]) == printed["tiles"] >= 3
    matrix = np.array(root["transform"]).reshape(4, 4).T
    assert np.abs(matrix[:3, :3] @ matrix[:3, :3].T - np.eye(3)).max() < 1e-14 and np.linalg.det(matrix) > 0
    assert (matrix[3] == (0, 0, 0, 1)).all()

    def box(volume: dict[str, Any]) -> tuple[Array, Array]:
        values = np.array(volume["box"])
        assert values.shape == (12,)
        half = values[3:].reshape(3, 3)
        assert (half == np.diag(np.diag(half))).all()
        return values[:3] - np.diag(half), values[:3] + np.diag(half)

    outer = box(root["boundingVolume"])
    everything, count, shared = [], 0, 0
    seen: set[bytes] = set()
    for child in root["children"]:
        assert 0 <= child["geometricError"] < root["geometricError"]
        p, n, t = read_glb(folder / child["content"]["uri"])
        local, normal = z_up(p), z_up(n)
        low, high = box(child["boundingVolume"])
        assert (local >= low - 1e-6).all() and (local <= high + 1e-6).all()
        assert (low >= outer[0] - 1e-9).all() and (high <= outer[1] + 1e-9).all()
        assert t.max() < len(p)
        count += len(t)
        a, b, c = (local[t[:, k]] for k in range(3))
        facet = np.cross(b - a, c - a)
        assert (facet[:, 2] > 0).all(), "counter-clockwise seen from above"
        assert (np.einsum("ij,ij->i", facet, normal[t[:, 0]]) > 0).all()
        here = {row.tobytes() for row in local}
        shared += len(here & seen)
        seen |= here
        everything.append((local, normal))
    assert count == printed["triangles"] and shared > 50, "tiles share their vertices to the last bit"
    local = np.concatenate([e[0] for e in everything])
    earth = local @ matrix[:3, :3].T + matrix[:3, 3]
    terrain = retalho.load(model)
    assert isinstance(terrain, retalho.Terrain)
    twin = terrain.mesh(tolerance=1.0)
    world = twin.positions + twin.offset
    truth = earth_centred(degrees(world[:, :2]), world[:, 2])
    # Each vertex of the twin is in the tiles, within the lattice of a tenth of a millimetre.
    key = {tuple(row) for row in np.round(truth, 1).tolist()}
    near = sum(tuple(row) in key for row in np.round(earth, 1).tolist())
    assert near > 0.97 * len(earth), "rounding puts a few on the other side"
    order, other = np.lexsort(truth.T), np.lexsort(np.unique(earth, axis=0).T)
    assert len(order) == len(other)
    assert np.abs(np.sort(truth[:, 0]) - np.sort(np.unique(earth, axis=0)[:, 0])).max() < 1e-3
    mesh(program, model, "-o", folder / "tileset.json", code=5)


def test_the_module_writes_what_the_program_writes(
        model: pathlib.Path, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    terrain = retalho.load(model)
    assert isinstance(terrain, retalho.Terrain)
    notes = terrain.write_quantized_mesh(tmp_path / "a", tolerance=1, level=11)
    mesh(program, model, "-o", tmp_path / "b" / "layer.json", "--tolerance", "1", "--level", "11")
    notes_3d = terrain.write_tileset(tmp_path / "c", tolerance=1, triangles=3000)
    mesh(program, model, "-o", tmp_path / "d" / "tileset.json", "--tolerance", "1", "--tile-triangles", "3000")
    for one, two in (("a", "b"), ("c", "d")):
        files = sorted(p.relative_to(tmp_path / one) for p in (tmp_path / one).rglob("*") if p.is_file())
        assert len(files) > 3
        for path in files:
            assert (tmp_path / one / path).read_bytes() == (tmp_path / two / path).read_bytes(), path
    assert notes["tiles"] == len(list((tmp_path / "a").rglob("*.terrain"))) and notes["levels"] == 12
    assert notes_3d["tiles"] == len(list((tmp_path / "c").glob("*.glb")))
    with pytest.raises(OSError, match="overwrite"):
        terrain.write_tileset(tmp_path / "c")
    with pytest.raises(ValueError, match="level"):
        terrain.write_quantized_mesh(tmp_path / "e", level=-2)
    with pytest.raises(ValueError, match="triangles"):
        terrain.write_tileset(tmp_path / "e", triangles=0)
    with pytest.raises(ValueError, match="CRS"):
        retalho.fit(hills(), max_error=1).write_tileset(tmp_path / "e")
    assert not (tmp_path / "e").exists()


def test_compact_files(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    grid = retalho.Grid(hills(), transform=TRANSFORM, crs="EPSG:32611")
    grid.write(tmp_path / "dem.tif")
    data = retalho.fit_compact(retalho.read_grid(tmp_path / "dem.tif"), max_error=2.0)
    subprocess.run([program, "fit", tmp_path / "dem.tif", "-o", tmp_path / "c.retalho", "--max-error", "2", "--format",
                    "compact", "-q"], check=True, capture_output=True)
    read, twin = retalho.from_bytes(data), retalho.load(tmp_path / "c.retalho")
    assert isinstance(read, retalho.Terrain) and isinstance(twin, retalho.Terrain)
    assert (read.vertices == twin.vertices).all() and (read.vertex_gradients == twin.vertex_gradients).all()
    assert read.compare(grid).max_error <= 2.0 and len(data) < len(retalho.fit(grid, max_error=2.0).to_bytes())
    smooth = retalho.fit_compact(grid, max_error=2.0, creases="none")
    assert smooth[4] == 1 and data == retalho.fit_compact(grid, max_error=2.0, creases="auto")
    assert retalho.fit_compact(grid, vertices=200) == retalho.fit_compact(grid, vertices=200, creases="none")
    flat = retalho.from_bytes(retalho.fit_compact(grid, vertices=200, surface="linear"))
    assert isinstance(flat, retalho.Terrain) and len(flat.vertices) <= 200
    for wrong in ({}, {"max_error": 0.0}, {"vertices": 2}, {"max_error": 1.0, "surface": "powell-sabin"},
                  {"max_error": 1.0, "fit": "interpolate"}, {"max_error": 1.0, "surface": "linear", "fit": "z-only"}):
        with pytest.raises(ValueError):
            retalho.fit_compact(grid, **wrong)  # type: ignore[arg-type]


def test_globes_need_a_crs(tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    retalho.fit(hills(), max_error=1).save(tmp_path / "m.retalho")
    for name in ("layer.json", "tileset.json"):
        assert "CRS" in mesh(program, tmp_path / "m.retalho", "-o", tmp_path / "x" / name, code=3)
    assert not list((tmp_path / "x").rglob("*.json")) if (tmp_path / "x").exists() else True
    mesh(program, tmp_path / "m.retalho", "-o", tmp_path / "m.xml")
    _, _, root = read_landxml(tmp_path / "m.xml")
    assert root.find(SPACE + "CoordinateSystem") is None
    assert "not known" in root.find(f"{SPACE}Surfaces/{SPACE}Surface").get("desc")


def test_real_terrain_as_quantized_mesh(
        tmp_path: pathlib.Path, program: pathlib.Path, data: Any) -> None:
    subprocess.run([program, "fit", data("dem/zion_srtm.tif"), "-o", tmp_path / "m.retalho", "--max-error", "10", "-q"],
                   check=True, capture_output=True)
    printed = json.loads(mesh(program, tmp_path / "m.retalho", "-o", tmp_path / "q" / "layer.json", "--tolerance", "5",
                              "--json"))
    assert printed["tiles"] > 20
    for path in (tmp_path / "q").rglob("*.terrain"):
        level, x, y = int(path.parts[-3]), int(path.parts[-2]), int(path.stem)
        check_tile(read_tile(path.read_bytes()), level, x, y)

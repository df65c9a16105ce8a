"""Files that are wrong in one way each, and what the program says of them: rows of messages.py."""
import json
import re
import struct

PLY = "ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\nelement face {m}\nproperty list uchar int vertex_indices\nend_header\n"
DISK = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
SIDES = '"sides": [0, 1, 2]'


def ply(vertices, faces, more=""):
    text = PLY.format(n=len(vertices), m=len(faces))
    text += "".join(" ".join(map(str, v)) + "\n" for v in vertices)
    return text + "".join(f"{len(f)} " + " ".join(map(str, f)) + "\n" for f in faces) + more


def document(patch, curves=""):
    lines = ", ".join(f'{{"kind": "bezier", "points": {p}}}' for p in ("[[0,0],[1,0]]", "[[1,0],[0,1]]", "[[0,1],[0,0]]"))
    return f'{{"curves": [{lines}{curves}], "patches": [{patch}]}}'


def curve(text):
    return f'{{"curves": [{text}]}}'


def quadrics(**changes):
    """One tetrahedron of five in a cube, with one quadric a vertex; a change of None leaves the key out."""
    text = {"step": 1, "split": "kuhn", "tetrahedra": [[0, 0, 0, 0]], "quadrics": []}
    text.update(changes)
    return json.dumps({k: v for k, v in text.items() if v is not None})


SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
RING = [(0, 0, 0), (9, 0, 0), (9, 9, 0), (0, 9, 0), (3, 3, 0), (6, 3, 0), (6, 6, 0), (3, 6, 0)]
RING_FACES = [(k, (k + 1) % 4, 4 + (k + 1) % 4) for k in range(4)] + [(k, 4 + (k + 1) % 4, 4 + k) for k in range(4)]
# A file, its text, the command, the exit code, a part of the message.
TEXTS = [
    # meshes
    ("slash.obj", DISK + "f 1 2 /3\n", "patch {f}", 3, "a corner without a vertex"), ("pair.obj", DISK + "f 1 2\n", "patch {f}", 3, "a face of 2 corners"),
    ("digit.obj", DISK + "f 1 2 x\n", "patch {f}", 3, "is not the number of a vertex"), ("far.obj", DISK + "f 1 2 9\n", "patch {f}", 3, "the face names vertex 9 of 3"),
    ("word.obj", "v 0 0 up\n", "patch {f}", 3, "'up' is not the z of a vertex"), ("empty.obj", "# nothing\n", "patch {f}", 4, "is not an OBJ file: it has no vertices"),
    ("noface.obj", DISK, "patch {f}", 3, "remove them"), ("three.obj", "v 1 2 x\n", "reconstruct {f} -o o.ply", 4, "wants three numbers, and 'x' is none"),
    ("normal.obj", DISK + "vn 0 0 1\nf 1//4 2//1 3//1\n", "reconstruct {f} -o o.ply", 4, "there are 1 so far"),
    ("body.ply", ply([(0, 0, 0)], []).replace("ascii", "binary_little_endian"), "patch {f}", 4, "the file ends here"), ("many.ply", PLY.format(n=99999999, m=0), "patch {f}", 4, "the file was cut short"),
    ("number.ply", ply([(0, 0, "x")], []), "patch {f}", 4, "not a number in vertex"), ("short.ply", ply(SQUARE, []).replace("face 0", "face 1"), "patch {f}", 4, "the file ends within"),
    ("bare.ply", "ply\nformat\nend_header\n", "patch {f}", 4, "the format is missing"), ("format.ply", "ply\nformat morse 1.0\nend_header\n", "patch {f}", 4, "unknown format 'morse'"),
    ("type.ply", PLY.format(n=1, m=0).replace("float z", "quad z"), "patch {f}", 4, "unknown type 'quad'"), ("noxyz.ply", PLY.format(n=0, m=0).replace("float z", "float w"), "patch {f}", 4, "the vertices have no x, y and z"),
    ("stray.ply", "ply\nformat ascii 1.0\nflavour sweet\nend_header\n", "patch {f}", 4, "is not expected in a PLY header"), ("pair.ply", ply(SQUARE, [(0, 1)]), "patch {f}", 3, "has 2 corners"),
    ("hollow.ply", ply([], []), "patch {f}", 4, "no vertices"), ("count.ply", PLY.format(n="-4", m=0), "patch {f}", 4, "is not a number of elements"),
    ("open.ply", "ply\nformat ascii 1.0\n", "patch {f}", 4, "the header has no end_header"), ("plain.ply", "plane\n", "patch {f}", 4, "it does not begin with 'ply'"),
    ("infinite.ply", ply([(0, 0, "inf")], []), "patch {f}", 4, "is not finite"),
    ("ring2.ply", ply([*RING, (20, 0, 0), (29, 0, 0), (20, 9, 0)], RING_FACES), "patch {f}", 3, "vertices belong to no triangle, the first is"),
    ("parts.ply", ply([*SQUARE[:3], (5, 0, 0), (6, 0, 0), (5, 1, 0)], [(0, 1, 2), (3, 4, 5)]), "patch {f}", 3, "the mesh has 2 separate parts"),
    ("holes.ply", ply(RING, RING_FACES), "patch {f}", 3, "fill all holes but one"), ("turned.ply", ply(SQUARE, [(0, 1, 2), (0, 3, 2)]), "patch {f}", 3, "are oriented against each other"),
    ("edge.ply", ply([*SQUARE, (0.5, 0.5, 1)], [(0, 1, 2), (0, 2, 3), (0, 2, 4)]), "patch {f}", 3, "a surface has at most"), ("twice.ply", ply(SQUARE, [(0, 1, 1)]), "patch {f}", 3, "names vertex 1 twice"),
    ("touch.ply", ply([(0, 0, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)], [(0, 1, 2), (0, 3, 4)]), "patch {f}", 3, "two parts of the surface touch at"),
    ("length.ply", ply([(0, 0, 0), (0, 0, 0), (0, 1, 0)], [(0, 1, 2)]), "patch {f}", 3, "has an edge of no length"),
    # documents of patches
    ("text.json", document(f'{{{SIDES}, "name": 3}}'), "patch {f}", 3, "expected a text, got number"), ("key.json", document(f'{{{SIDES}, "colour": 3}}'), "patch {f}", 3, "a patch has no such key; it has sides, divisions, name"),
    ("p-two.json", document('{"sides": [0, 1]}'), "patch {f}", 3, "expected an array of three curves"), ("div2.json", document(f'{{{SIDES}, "divisions": [3, 4]}}'), "patch {f}", 3, "expected one number or three, got 2"),
    ("huge.json", document(f'{{{SIDES}}}').replace("[[0,0]", "[[1e400,0]"), "patch {f}", 3, "not usable JSON"), ("p-none.json", '{"patches": []}', "patch {f}", 3, "expected an array of at least one patch"),
    ("turn.json", document('{"sides": [{"curve": 0, "reversed": 3}, 1, 2]}'), "patch {f}", 3, "expected true or false, got number"),
    ("colour.json", document('{"sides": [{"curve": 0, "colour": 3}, 1, 2]}'), "patch {f}", 3, "a side that names a curve has the keys"),
    ("list.json", document("7"), "patch {f}", 3, "expected an object, got number"), ("nopatch.json", "[]", "patch {f}", 3, 'expected an object with the key "patches"'),
    ("loop.json", document('{"sides": [0, 1, 3]}', ', {"kind": "bezier", "points": [[0,1],[5,9],[-5,9],[0,1]]}'), "patch {f}", 3, "ends where it starts"),
    ("cross.json", document('{"sides": [3, 1, 2]}', ', {"kind": "bezier", "points": [[0,0],[3,3],[-2,3],[1,0]]}'), "patch {f}", 3, "crosses itself at"),
    # documents of curves
    ("name.json", curve('{"kind": "bezier", "name": 3, "points": [[0,0],[1,1]]}'), "curve {f}", 3, "expected a text, got number"),
    ("parameters.json", curve('{"kind": "bezier", "degree": 1, "points": [[0,0],[1,1],[2,0]], "breaks": [0, 2, 1]}'), "curve {f}", 3, "parameters must ascend"),
    ("over.json", curve('{"kind": "bezier", "points": [[0,0],[1e400,1]]}'), "curve {f}", 3, "not usable JSON"), ("large.json", curve('{"kind": "bezier", "points": [[0,0],[1e150,1]]}'), "curve {f}", 3, "scale the curves below 1e100"),
    ("flat.json", curve('{"kind": "bezier", "points": [[0],[1]]}'), "curve {f}", 3, "expected 2 or 3 numbers, got 1"), ("mixed.json", curve('{"kind": "bezier", "points": [[0,0],[1,1,1]]}'), "curve {f}", 3, "expected 2 numbers, got 3"),
    ("kind.json", curve('{"kind": "spiral", "points": [[0,0],[1,1]]}'), "curve {f}", 3, "is none of"), ("word.json", curve('{"kind": "bezier", "points": [[0,"a"],[1,1]]}'), "curve {f}", 3, "expected a number, got string"),
    ("extra.json", curve('{"kind": "bezier", "points": [[0,0],[1,1]], "colour": 1}'), "curve {f}", 3, 'a curve of kind "bezier" has no such key'), ("object.json", '{"curves": 3}', "curve {f}", 3, "expected an array, got number"),
    ("nocurves.json", "[]", "curve {f}", 3, 'expected an object with the key "curves", an array'), ("node.json", curve('{"kind": "lagrange", "points": [[0,0],[1,2]], "nodes": [1,1]}'), "curve {f}", 3, "node"),
    ("control.json", curve('{"kind": "explicit", "f": "x\\u0001", "from": 0, "to": 1}'), "curve {f}", 3, "the formula has a control character (code 1) at place"),
    ("bad.json", curve('{"kind": "explicit", "f": "frob(x)", "from": 0, "to": 1}'), "curve {f}", 3, 'formula "frob(x)"'),
    ("number.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0 L 3 q'/></svg>", "curve {f}", 3, "path data, character"),
    ("command.svg", "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0 Z ; 3'/></svg>", "curve {f}", 3, "expected a command letter"),
    ("points.geojson", '{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": {"type": "Point", "coordinates": [1, 2]}}]}', "curve {f}", 3, "holds no line and no polygon"),
    # quadrics
    ("q-step.json", quadrics(step=0), "reconstruct {f} -o o.ply", 3, "'step' must be above 0"), ("q-word.json", quadrics(step="a"), "reconstruct {f} -o o.ply", 3, "must be a finite number"),
    ("q-none.json", quadrics(tetrahedra=[]), "reconstruct {f} -o o.ply", 3, "must hold at least one [i, j, k, type]"), ("q-four.json", quadrics(tetrahedra=[[1]]), "reconstruct {f} -o o.ply", 3, "are [i, j, k, type] each"),
    ("q-type.json", quadrics(tetrahedra=[[0, 0, 0, 77]]), "reconstruct {f} -o o.ply", 3, "whole numbers from 0 to"), ("q-split.json", quadrics(split="six"), "reconstruct {f} -o o.ply", 3, 'is "five" or "kuhn"'),
    ("q-array.json", quadrics(tetrahedra=3), "reconstruct {f} -o o.ply", 3, "must be an array"), ("q-quadric.json", quadrics(), "reconstruct {f} -o o.ply", 3, "has none"),
    ("q-vertex.json", quadrics(quadrics=[{"constant": 1}]), "reconstruct {f} -o o.ply", 3, 'need "vertex": [i, j, k] each'),
    ("q-where.json", quadrics(quadrics=[{"vertex": [9, 9, 9]}]), "reconstruct {f} -o o.ply", 3, "belongs to no tetrahedron"), ("q-origin.json", quadrics(origin=[1]), "reconstruct {f} -o o.ply", 3, "must be [x, y, z]"),
    ("q-not.json", "{", "reconstruct {f} -o o.ply", 4, "it is no JSON at byte"),
    # points and grids
    ("line.xyz", "0 0 1\n1 1 1\n2 2 1\n3 3 1\n", "fit {f} -o o.retalho", 3, "lie on one line: there is no area to triangulate"), ("pair.xyz", "0 0 1\n1 1 1\n", "fit {f} -o o.retalho", 3, "a triangulation needs three"),
    ("same.xyz", "1 1 1\n" * 5, "fit {f} -o o.retalho", 3, "different places: a triangulation needs three"), ("utf16.xyz", "\xff\xfe1\0 \x002\0 \x003\0\n\0", "info {f}", 4, "is UTF-16 text: save it as UTF-8 or ASCII"),
    ("nan.vrt", '<VRTDataset rasterXSize="4" rasterYSize="4"><GeoTransform>0,nan,0,0,0,-1</GeoTransform><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>', "info {f}", 3, "the geotransform holds a number that is not finite"),
    ("packed.las", "LASF" + "\0" * 20 + "\1\2" + "\0" * 78 + "\x82" + "\0" * 300, "info {f}", 4, "is compressed (LAZ), which is not read"),
    ("layers2.gpx", '<gpx version="1.1"><wpt lat="1" lon="2"/><trk><trkseg><trkpt lat="1" lon="2"/></trkseg></trk></gpx>', "info {f} --height-field ele", 3, "say which one"),
]


def with_bytes(data, at, new):
    return data[:at] + new + data[at + len(new):]


# Made of a file that the program wrote: its name, the new one's, the change, the command, the exit code, a part of the message.
CHANGED = [
    ("m.retalho", "empty.retalho", lambda d: b"", "info {f}", 4, "the file is empty"), ("m.retalho", "sign.retalho", lambda d: d[:5], "info {f}", 4, "within its signature"),
    ("m.retalho", "head.retalho", lambda d: d[:20], "info {f}", 4, "bytes of header"), ("m.retalho", "half.retalho", lambda d: d[:len(d) // 2], "info {f}", 4, "it was cut short"),
    ("m.retalho", "more.retalho", lambda d: d + b"xyz", "info {f}", 4, "bytes and should have"), ("m.retalho", "flip.retalho", lambda d: with_bytes(d, len(d) - 3, bytes([d[-3] ^ 1])), "info {f}", 4, "damaged: the checksum does not fit the content"),
    ("m.retalho", "new.retalho", lambda d: with_bytes(d, 8, struct.pack("<H", 99)), "info {f}", 4, "written by a newer Retalho (format 99"),
    ("s.tif", "cut.tif", lambda d: d[:-60], "info {f}", 4, "is damaged or cut off: "), ("s.shp", "cut.shp", lambda d: d[:-100], "curve {f}", 4, "is damaged or cut off: "),
    ("s.shp", "cut.shp", lambda d: d[:-100], "info {f} --height-field elev", 4, "is damaged or cut off: "),
    ("c.retalho", "c-head.retalho", lambda d: d[:7], "info {f}", 4, "within its header"), ("c.retalho", "c-new.retalho", lambda d: with_bytes(d, 4, b"\x63"), "info {f}", 4, "written by a newer Retalho (compact form 99"),
    ("c.retalho", "c-half.retalho", lambda d: d[:len(d) // 2], "info {f}", 4, "it was cut short"), ("c.retalho", "c-more.retalho", lambda d: d + b"xyz", "info {f}", 4, "bytes and should hold"),
    ("c.retalho", "c-flip.retalho", lambda d: with_bytes(d, len(d) - 3, bytes([d[-3] ^ 1])), "info {f}", 4, "damaged: the checksum does not fit the content"),
]


def index(pattern, new):
    return lambda d: re.sub(pattern, new, d.decode(), count=1).encode()


# The same for a tiled model's index.
INDICES = [
    ("t-json", lambda d: b"{", "is not the index of a tiled model"), ("t-format", index('"retalho-tiles"', '"tiles"'), "its format is another one"), ("t-version", index('"version": 1', '"version": 9'), "its version is 9, and this Retalho knows 1"),
    ("t-columns", index('"columns": 12', '"columns": 1'), "cells in tiles of"), ("t-cell", index('"cell_width": 10.0', '"cell_width": -1'), "is no number that can be used"),
    ("t-surface", index('"surface": "[a-z-]*"', '"surface": "sponge"'), "an unknown kind of surface"), ("t-fit", index('"fit": "interpolate"', '"fit": "magic"'), "an unknown fit 'magic'"),
    ("t-row", index('"row": 0', '"row": 3'), "is not that of row 0, column 0"), ("t-tiles", index('"rows": 10', '"rows": 40'), "make up the grid"),
    ("t-outside", index('"file": "', '"file": "../'), "would lie outside of the folder"), ("t-other", index('"checksum": "..', '"checksum": "zz'), "its checksum is another one"),
]


def void(data):
    return re.sub(rb'"file": *"[^"]*"', b'"file": null', data)


def make(stock):
    """Writes the files, of those that `stock` holds, and returns the rows."""
    rows = []
    for name, text, words, code, part in TEXTS:
        (stock / name).write_bytes(text.encode("latin-1"))
        rows.append((words.format(f=name), code, part))
    for old, name, change, words, code, part in CHANGED:
        (stock / name).write_bytes(change((stock / old).read_bytes()))
        if old.endswith(".shp"):
            for other in (".shx", ".dbf"):  # stay whole
                (stock / name).with_suffix(other).write_bytes((stock / old).with_suffix(other).read_bytes())
        rows.append((words.format(f=name), code, part))
    tiled = {file.name: file.read_bytes() for file in (stock / "tiled").iterdir()}
    for name, change, part in [*INDICES, ("t-void", void, None)]:
        (stock / name).mkdir()
        for file, data in tiled.items():
            (stock / name / file).write_bytes(change(data) if file == "index.json" else data)
        if part:
            rows.append((f"sample {name} --at 1030,2030", 4, part))
    return rows

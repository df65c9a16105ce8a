"""The bad files of tests/corrupt, one list a reader: (name, bytes, must_refuse).

Each is a sound file with one fault. `must_refuse` is False where the fault may leave a sound file (a byte flipped in a
number, a table cut at a line): then the program must do its work or refuse, and nothing else.
"""
import json
import math
import random
import struct
import zlib

NUMBERS = ["nan", "inf", "-inf", "1e308", "1e400", "-1", "0", "2147483648", "9223372036854775808", "1,5", "x", "1e", "--1",
           "0x10", "", "\u0661"]


def cuts(data, count=8):
    """Proper prefixes, from nothing to all but one byte."""
    places = {0, 1, len(data) - 1} | {len(data) * k // count for k in range(1, count)}
    return [(f"cut-{p}", data[:p]) for p in sorted(places)]


def flips(data, count=12, seed=1):
    draw = random.Random(seed)
    out = []
    for place in sorted(draw.sample(range(len(data)), min(count, len(data)))):
        changed = bytearray(data)
        changed[place] ^= 1 << draw.randrange(8)
        out.append((f"flip-{place}", bytes(changed)))
    return out


def pgm():
    w, h = 9, 7
    rows = [[100 + 7 * c + 5 * r * (c % 3) for c in range(w)] for r in range(h)]
    body = "\n".join(" ".join(map(str, row)) for row in rows) + "\n"
    sound = f"P2\n{w} {h}\n255\n{body}"
    text = lambda size, top="255", b=body: f"P2\n{size}\n{top}\n{b}"
    bad = {
        "one-column-more": text("10 7"), "one-row-more": text("9 8"), "one-column-less": text("8 7"), "one-row-less": text("9 6"),
        "no-rows": text("9 0"), "no-columns": text("0 7"), "negative-width": text("-9 7"), "negative-height": text("9 -7"),
        "width-2-31": text("2147483648 7"), "width-2-31-less-1": text("2147483647 2147483647"), "width-2-63": text("9223372036854775808 7"),
        "width-2-64": text("18446744073709551616 7"), "two-million-square": text("2000000 2000000"), "size-1e5": text("1e5 7"),
        "size-fraction": text("9.5 7"), "size-word": text("nine 7"), "no-maximum": f"P2\n{w} {h}\n", "maximum-0": text("9 7", "0"),
        "maximum-too-small": text("9 7", "99"), "maximum-negative": text("9 7", "-255"), "maximum-2-64": text("9 7", "18446744073709551616"),
        "only-magic": "P2", "only-magic-line": "P2\n", "magic-p9": "P9\n9 7\n255\n" + body,
        "magic-glued": "P29 7\n255\n" + body, "bom": "\ufeff" + sound, "comment-unended": "P2\n# 9 7 255 1 2 3",
        "more-samples": sound + "1 2 3\n", "decimal-comma": sound.replace(" 107 ", " 107,5 ", 1), "decimal-point": sound.replace(" 107 ", " 107.5 ", 1),
        "zero-bytes": sound.replace(" 107 ", "\0\0\0", 1), "utf-16": None,
    }
    out = [(name, t.encode() if t is not None else sound.encode("utf-16"), True) for name, t in bad.items()]
    for k, n in enumerate(NUMBERS):
        if n not in ("0", ""):
            out.append((f"sample-{k}", sound.replace(" 107 ", f" {n} ", 1).encode(), True))
    out += [(n, d, len(d) < len(sound) - 4) for n, d in cuts(sound.encode())]
    out += [(n, d, False) for n, d in flips(sound.encode())]
    out += [("swapped", text("7 9").encode(), False), ("crlf", sound.replace("\n", "\r\n").encode(), False)]
    out += [("magic-p5", b"P5\n9 7\n255\n" + body.encode(), False)]  # the digits are taken for bytes
    return out


def asc():
    head = "ncols 6\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n"
    body = "".join(" ".join(str(100 + c * r) for c in range(6)) + "\n" for r in range(5))
    sound = head + body
    change = lambda a, b: sound.replace(a, b, 1)
    bad = {
        "no-rows": change("nrows 5", "nrows 0"), "negative-columns": change("ncols 6", "ncols -6"), "columns-2-31": change("ncols 6", "ncols 2147483648"),
        "columns-2-63": change("ncols 6", "ncols 9223372036854775808"), "two-million-square": change("ncols 6\nnrows 5", "ncols 2000000\nnrows 2000000"),
        "rows-missing": change("nrows 5", "nrows 9"), "columns-missing": change("ncols 6", "ncols 16"),
        "cells-0": change("cellsize 10", "cellsize 0"), "cells-nan": change("cellsize 10", "cellsize nan"), "cells-inf": change("cellsize 10", "cellsize inf"),
        "corner-nan": change("xllcorner 0", "xllcorner nan"), "corner-1e308": change("xllcorner 0", "xllcorner 1e308"), "all-void": head + "-9999 " * 30,
        "header-only": head, "no-header": body
    }
    out = [(n, t.encode(), True) for n, t in bad.items()]
    out += [(n, d, len(d) < len(head) + 40) for n, d in cuts(sound.encode()) if n not in ("cut-0",)] + [("empty", b"", True)]
    out += [("bom", b"\xef\xbb\xbf" + sound.encode(), False), ("crlf", sound.replace("\n", "\r\n").encode(), False),
            ("decimal-comma", change("104", "104,5").encode(), False), ("nodata-0", change("-9999", "0").encode(), False),
            ("height-1e308", change("104", "1e308").encode(), False), ("height-inf", change("104", "inf").encode(), False),
            ("height-nan", change("104", "nan").encode(), False), ("word", change("104", "height").encode(), False),  # GDAL takes a word for 0
            ("one-cell", b"ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 10\n5\n", False),
            ("one-row", b"ncols 5\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 10\n5 6 7 8 9\n", False)]
    return out


def tif():
    """A TIFF of one strip, made by hand: every field can be wrong."""
    def make(width=6, height=5, bits=32, form=3, strip=None, offset=None, count=None, entries=None, cell=10.0, samples=1):
        data = b"".join(struct.pack("<f", 100 + 3 * c * r) for r in range(5) for c in range(6))
        tags = [(256, 4, 1, width), (257, 4, 1, height), (258, 3, 1, bits), (259, 3, 1, 1), (262, 3, 1, 1), (273, 4, 1, None),
                (277, 3, 1, samples), (278, 4, 1, height if strip is None else strip), (279, 4, 1, len(data) if count is None else count),
                (339, 3, 1, form), (33550, 12, 3, None), (33922, 12, 6, None)]
        directory = 8
        extra = directory + 2 + 12 * len(tags) + 4
        scale, tie = struct.pack("<3d", cell, cell, 0), struct.pack("<6d", 0, 0, 0, 1000, 2000, 0)
        at = {33550: extra, 33922: extra + len(scale), 273: extra + len(scale) + len(tie) if offset is None else offset}
        body = struct.pack("<2sHI", b"II", 42, directory) + struct.pack("<H", len(tags) if entries is None else entries)
        for tag, kind, n, value in tags:
            value = at.get(tag, value)
            body += struct.pack("<HHI", tag, kind, n) + (struct.pack("<HH", value & 0xFFFF, 0) if kind == 3 else struct.pack("<I", value & 0xFFFFFFFF))
        return body + struct.pack("<I", 0) + scale + tie + data
    sound = make()
    bad = {
        "no-rows": make(height=0), "no-columns": make(width=0), "width-2-31": make(width=2**31), "height-2-32-less-1": make(height=2**32 - 1),
        "two-million-square": make(width=2_000_000, height=2_000_000, strip=1), "claims-400-gigabytes": make(width=300_000, height=300_000),
        "bits-0": make(bits=0), "bits-77": make(bits=77),
        "strip-outside": make(offset=1_000_000), "strip-at-2-32": make(offset=2**32 - 1), "entries-0": make(entries=0),
        "entries-65535": make(entries=65535), "cell-nan": make(cell=float("nan")), "cell-inf": make(cell=float("inf")),
        "twice-as-high": make(height=10, strip=10), "empty": b"", "magic-only": b"II*\0", "no-directory": b"II*\0\0\0\0\0", "directory-outside": b"II*\0\xff\xff\xff\x7f",
        "magic-43": b"II+\0" + sound[4:], "text": b"this is no raster", "html": b"<html><body>404 Not Found</body></html>",
    }
    out = [(n, d, True) for n, d in bad.items()]
    out += [(n, d, True) for n, d in cuts(sound) if len(d) > 0]
    out += [(n, d, False) for n, d in flips(sound, 16)]
    out += [("cell-0", make(cell=0.0), False), ("cell-negative", make(cell=-10.0), False), ("big-endian-mark", b"MM" + sound[2:], True)]
    return out


def vrt():
    def make(columns=6, rows=5, geo="0, 10, 0, 0, 0, -10", source="grid.asc", band="Float32", rect='xOff="0" yOff="0" xSize="6" ySize="5"'):
        return (f'<VRTDataset rasterXSize="{columns}" rasterYSize="{rows}"><GeoTransform>{geo}</GeoTransform><VRTRasterBand dataType="{band}" band="1">'
                f'<SimpleSource><SourceFilename relativeToVRT="1">{source}</SourceFilename><SourceBand>1</SourceBand><SrcRect {rect}/><DstRect {rect}/>'
                "</SimpleSource></VRTRasterBand></VRTDataset>").encode()
    sound = make()
    out = [("forty-thousand-square-no-source", make(40000, 40000, source="missing.asc"), True), ("two-million-square", make(2_000_000, 2_000_000), True),
           ("size-2-31", make(2**31, 5), True), ("size-negative", make(-6, 5), True), ("size-word", make("six", 5), True), ("source-missing", make(source="missing.asc"), True),
           ("geotransform-nan", make(geo="0, nan, 0, 0, 0, -10"), True), ("geotransform-cells-0", make(geo="0, 0, 0, 0, 0, 0"), True),
           ("rotated", make(geo="0, 10, 5, 0, 5, -10"), True), ("complex", make(band="CFloat32"), True), ("band-type-word", make(band="Height"), True),
           ("itself", make(source="itself.vrt"), True)]
    out += [(n, d, True) for n, d in cuts(sound, 5) if len(d) > 20]
    return out


def xyz():
    points = [(10 * c + 0.5 * r, 10 * r, 100 + c * r) for r in range(5) for c in range(6)]
    sound = "".join(f"{x} {y} {z}\n" for x, y, z in points)
    bad = {
        "empty": "", "blank": "\n\n\n", "words": "these are\nno points\nat all\n", "two-columns": "1 2\n3 4\n5 6\n", "one-column": "1\n2\n3\n",
        "decimal-comma": sound.replace(".", ","), "decimal-comma-semicolon": "x;y;z\n1,5;2,5;3,5\n2,5;3,5;4,5\n", "width-changes": sound + "1 2 3 4\n",
        "short-line": sound + "1 2\n", "word-in-x": sound.replace("10.0 ", "ten ", 1), "hexadecimal": sound.replace("10.0 ", "0x10 ", 1),
        "zero-bytes": sound.replace(" ", "\0"), "collinear": "".join(f"{k} {2 * k} {k}\n" for k in range(9)), "collinear-far": "".join(f"{5e6 + k} {5e6 + k} {k}\n" for k in range(9)),
        "one-place": "1 2 3\n" * 9, "two-points": "1 2 3\n4 5 6\n", "all-nan": "nan nan nan\n" * 9, "all-inf": "inf 1 2\n" * 9, "all-1e400": "1e400 0 1\n" * 9,
        "binary": "".join(chr(k) for k in range(256)) * 4,
    }
    out = [(n, t.encode("latin-1"), True) for n, t in bad.items()] + [("utf-16", sound.encode("utf-16"), True)]
    for k, n in enumerate(NUMBERS):
        out.append((f"number-{k}", sound.replace("10.0 ", f"{n} ", 1).encode(), n in ("x", "1e", "--1", "0x10", "\u0661")))
    out += [(n, d, len(d) < 12) for n, d in cuts(sound.encode())]
    out += [("bom", b"\xef\xbb\xbf" + sound.encode(), False), ("crlf", sound.replace("\n", "\r\n").encode(), False), ("duplicates", (sound * 3).encode(), False),
            ("duplicates-other-heights", (sound + sound.replace(" 100\n", " 500\n")).encode(), False), ("huge", "".join(f"{x}e300 {y}e300 {z}e300\n" for x, y, z in points).encode(), False),
            ("tiny", "".join(f"{x}e-300 {y}e-300 {z}e-300\n" for x, y, z in points).encode(), False)]
    return out


def ply_text(vertices, faces=None, header=None, count=None, face_count=None):
    lines = ["ply", "format ascii 1.0", f"element vertex {len(vertices) if count is None else count}"]
    lines += [f"property float {p}" for p in (["x", "y", "z", "nx", "ny", "nz"][:len(vertices[0])])]
    if faces is not None:
        lines += [f"element face {len(faces) if face_count is None else face_count}", "property list uchar int vertex_indices"]
    lines += ["end_header"] if header is None else header
    lines += [" ".join(map(str, v)) for v in vertices]
    lines += [" ".join(map(str, [len(f), *f])) for f in faces or []]
    return "\n".join(lines) + "\n"


def sphere(n=60):
    out = []
    for k in range(n):
        z = 1 - (2 * k + 1) / n
        a, r = 2.399963 * k, math.sqrt(1 - z * z)
        out.append((round(r * math.cos(a), 4), round(r * math.sin(a), 4), round(z, 4)) * 2)
    return out


def ply_points():
    points = sphere()
    sound = ply_text(points)
    change = lambda a, b: sound.replace(a, b, 1)
    binary_head = "ply\nformat binary_little_endian 1.0\nelement vertex {}\n" + "".join(f"property float {p}\n" for p in ["x", "y", "z", "nx", "ny", "nz"]) + "end_header\n"
    packed = b"".join(struct.pack("<6f", *p) for p in points)
    binary = binary_head.format(60).encode() + packed
    bad = {
        "count-more": change("vertex 60", "vertex 61"), "count-2-31": change("vertex 60", "vertex 2147483648"), "count-2-63": change("vertex 60", "vertex 9223372036854775808"),
        "count-2-64": change("vertex 60", "vertex 18446744073709551616"), "count-0": change("vertex 60", "vertex 0"), "count-negative": change("vertex 60", "vertex -60"),
        "count-word": change("vertex 60", "vertex many"), "no-count": change("vertex 60", "vertex"), "no-vertex": change("element vertex", "element point"),
        "format-unknown": change("ascii", "utf8"), "no-format": change("format ascii 1.0\n", ""), "type-unknown": change("property float x", "property real x"),
        "no-x": change("property float x\n", ""), "x-is-a-list": change("property float x", "property list uchar float x"), "no-end": change("end_header\n", ""),
        "magic": change("ply\n", "plx\n"), "word": change(" 0.", " a.") , "bom": "\ufeff" + sound, "no-normals": ply_text([p[:3] for p in points[:2]]),
        "one-place": ply_text([points[0]] * 60), "huge-line": "ply\n" + "x" * 100000 + "\n",
    }
    out = [(n, t.encode(), True) for n, t in bad.items()]
    out += [("binary-count-more", binary_head.format(61).encode() + packed, True), ("binary-count-2-31", binary_head.format(2**31).encode() + packed, True),
            ("binary-count-2-62", binary_head.format(2**62).encode() + packed, True)]
    out += [(f"binary-{n}", d, True) for n, d in cuts(binary)] + [(n, d, len(d) < 300) for n, d in cuts(sound.encode())]
    out += [(f"binary-{n}", d, False) for n, d in flips(binary)] + [("big-endian-word", change("ascii 1.0", "binary_big_endian 1.0").encode(), False),
            ("collinear", ply_text([(k, 0, 0, 0, 0, 1) for k in range(60)]).encode(), False), ("normals-0", ply_text([p[:3] + (0, 0, 0) for p in points]).encode(), False)]
    out += [("nan", ply_text([("nan",) + p[1:] if k == 3 else p for k, p in enumerate(points)]).encode(), False),
            ("1e308", ply_text([("1e308",) + p[1:] if k == 3 else p for k, p in enumerate(points)]).encode(), False)]
    return out


def disk():
    side = 5
    vertices = [(c, r, round(0.1 * c * r, 2)) for r in range(side) for c in range(side)]
    faces = []
    for r in range(side - 1):
        for c in range(side - 1):
            k = r * side + c
            faces += [(k, k + 1, k + side), (k + 1, k + side + 1, k + side)]
    return vertices, faces


def ply_mesh():
    vertices, faces = disk()
    sound = ply_text(vertices, faces)
    change = lambda a, b: sound.replace(a, b, 1)
    far = [(0, 1, 99)] + faces[1:]
    out = [(n, t.encode(), True) for n, t in {
        "index-outside": ply_text(vertices, far), "index-negative": ply_text(vertices, [(0, 1, -5)] + faces[1:]), "faces-more": ply_text(vertices, faces, face_count=33),
        "faces-2-63": ply_text(vertices, faces, face_count=2**63), "list-longer": change("3 0 1 5", "9 0 1 5"), "list-1e9": change("3 0 1 5", "1000000000 0 1 5"),
        "list-negative": change("3 0 1 5", "-3 0 1 5"), "list-of-2": change("3 0 1 5", "2 0 1"), "index-fraction": change("3 0 1 5", "3 0 1 5.5"),
        "nan": change("\n1 0 0.0\n", "\nnan 0 0.0\n"), "inf": change("\n1 0 0.0\n", "\ninf 0 0.0\n"), "1e400": change("\n1 0 0.0\n", "\n1e400 0 0.0\n"), "no-faces": ply_text(vertices, []),
        "no-face-element": ply_text(vertices), "face-twice": ply_text(vertices, faces + faces[:1]), "face-turned": ply_text(vertices, [faces[0][::-1]] + faces[1:]),
        "corner-twice": ply_text(vertices, [(0, 0, 5)] + faces[1:]), "two-pieces": ply_text(vertices + [(x + 9, y, z) for x, y, z in vertices], faces + [tuple(k + 25 for k in f) for f in faces]),
        "closed": ply_text([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]), "three-at-an-edge": ply_text(vertices + [(9, 9, 9)], faces + [(0, 1, 25)]),
    }.items()]
    return out + [(n, d, len(d) < 500) for n, d in cuts(sound.encode(), 5)]


def obj():
    vertices, faces = disk()
    sound = "".join(f"v {x} {y} {z}\n" for x, y, z in vertices) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
    change = lambda a, b: sound.replace(a, b, 1)
    out = [(n, t.encode(), True) for n, t in {
        "empty": "", "no-vertices": "f 1 2 3\n", "index-0": change("f 1 2 6", "f 0 2 6"), "index-outside": change("f 1 2 6", "f 1 2 99"), "index-before": change("f 1 2 6", "f 1 2 -99"),
        "index-2-63": change("f 1 2 6", "f 1 2 9223372036854775808"), "index-word": change("f 1 2 6", "f 1 2 six"), "two-corners": change("f 1 2 6", "f 1 2"),
        "texture-missing": change("f 1 2 6", "f 1/7 2/7 6/7"), "normal-missing": change("f 1 2 6", "f 1//7 2//7 6//7"), "nan": change("v 1 0", "v nan 0"), "inf": change("v 1 0", "v inf 0"),
        "1e400": change("v 1 0", "v 1e400 0"), "decimal-comma": change("v 1 0", "v 1,5 0"), "two-coordinates": change("v 1 0 0.0", "v 1 0"), "word": change("v 1 0", "v one 0"),
        "no-faces": "".join(f"v {x} {y} {z}\n" for x, y, z in vertices), "binary": "\0\1\2" * 99,
    }.items()]
    return out + [(n, d, len(d) < 200) for n, d in cuts(sound.encode(), 5)]


def curve_json():
    sound = {"curves": [{"kind": "bezier", "points": [[0, 0], [1, 2], [3, 2], [4, 0]]}]}
    spline = {"kind": "bspline", "degree": 2, "knots": [0, 0, 0, 1, 2, 2, 2], "points": [[0, 0], [1, 2], [3, 2], [4, 0]]}
    one = lambda **changes: json.dumps({"curves": [{**sound["curves"][0], **changes}]})
    b = lambda **changes: json.dumps({"curves": [{**spline, **changes}]})
    texts = {
        "empty": "", "null": "null", "number": "7", "list": "[]", "no-curves": "{}", "curves-empty": '{"curves": []}', "curves-number": '{"curves": 7}', "curve-number": '{"curves": [7]}',
        "kind-missing": '{"curves": [{"points": [[0,0],[1,1]]}]}', "kind-unknown": one(kind="nurbs"), "kind-number": one(kind=3), "points-missing": '{"curves": [{"kind": "bezier"}]}',
        "points-empty": one(points=[]), "points-word": one(points="many"), "point-of-1": one(points=[[0], [1]]), "point-of-4": one(points=[[0, 0, 0, 0], [1, 1, 1, 1]]), "point-word": one(points=[["a", "b"], [1, 1]]),
        "point-null": one(points=[[None, 0], [1, 1]]), "dimensions-mixed": one(points=[[0, 0], [1, 1, 1], [2, 2], [3, 3]]), "key-unknown": one(pointz=[1]), "nan-bare": one().replace("[3, 2]", "[NaN, 2]"),
        "inf-bare": one().replace("[3, 2]", "[Infinity, 2]"), "1e400": one().replace("[3, 2]", "[1e400, 2]"), "comma-behind": one().replace("[4, 0]]", "[4, 0],]"), "comment": "// curves\n" + one(),
        "quotes-single": one().replace('"', "'"), "decimal-comma": one().replace("[3, 2]", "[3,5, 2, 1]"), "degree-negative": one(degree=-1), "degree-0": one(degree=0), "degree-fraction": one(degree=2.5),
        "degree-2-31": one(degree=2**31), "degree-2-63": one(degree=2**63), "degree-of-other-count": one(degree=2, points=[[0, 0], [1, 2], [3, 2], [4, 0]]), "weights-short": one(weights=[1, 1]), "weight-0": one(weights=[1, 0, 1, 1]),
        "weight-negative": one(weights=[1, -1, 1, 1]), "deep": "[" * 100000, "deep-objects": '{"curves":' * 50000, "string-unended": '{"curves": "', "bom-twice": "\ufeff\ufeff" + one(), "zero-byte": one().replace("bezier", "be\0zier"),
        "knots-falling": b(knots=[0, 0, 0, 2, 1, 2, 2]), "knots-few": b(knots=[0, 0, 1, 1]), "knots-many": b(knots=[0] * 99), "knots-equal": b(knots=[0] * 7), "knots-word": b(knots="uniform?"), "spline-degree-0": b(degree=0), "spline-degree-99": b(degree=99),
        "hermite-short": '{"curves": [{"kind": "hermite", "points": [[0,0],[1,1]], "tangents": [[1,0]]}]}', "implicit-empty": '{"curves": [{"kind": "implicit", "f": "", "box": [-2,-2,2,2]}]}',
        "implicit-unknown-name": '{"curves": [{"kind": "implicit", "f": "x + q", "box": [-2,-2,2,2]}]}', "implicit-unbalanced": '{"curves": [{"kind": "implicit", "f": "((x)", "box": [-2,-2,2,2]}]}',
        "implicit-deep": '{"curves": [{"kind": "implicit", "f": "' + "(" * 20000 + "x" + ")" * 20000 + '", "box": [-2,-2,2,2]}]}', "implicit-box-turned": '{"curves": [{"kind": "implicit", "f": "x", "box": [2,2,-2,-2]}]}',
        "implicit-box-short": '{"curves": [{"kind": "implicit", "f": "x", "box": [2,2]}]}', "implicit-box-1e308": '{"curves": [{"kind": "implicit", "f": "x*x-y", "box": [-1e308,-1e308,1e308,1e308]}]}',
        "explicit-turned": '{"curves": [{"kind": "explicit", "f": "x", "from": 1, "to": 0}]}', "explicit-equal": '{"curves": [{"kind": "explicit", "f": "x", "from": 1, "to": 1}]}', "explicit-number": '{"curves": [{"kind": "explicit", "f": 3, "from": 0, "to": 1}]}',
        "spline-one-point": '{"curves": [{"kind": "spline", "points": [[0,0]]}]}', "spline-equal-points": '{"curves": [{"kind": "spline", "points": [[1,1],[1,1],[1,1]]}]}', "spline-ends-unknown": '{"curves": [{"kind": "spline", "points": [[0,0],[1,1],[2,0]], "ends": "loose"}]}',
    }
    out = [(n, t.encode("utf-8", "surrogatepass"), True) for n, t in texts.items()] + [("utf-16", one().encode("utf-16"), True), ("latin-1", one(name="caf\xe9").replace("\\u00e9", "\xe9").encode("latin-1"), True)]
    out += [(n, d, True) for n, d in cuts(one().encode(), 10)]
    out += [("points-1e308", one(points=[[-1e308, 0], [1e308, 1e308], [0, 1], [1, 1e-308]]).encode(), False), ("points-equal", one(points=[[1, 1]] * 4).encode(), False), ("bom", b"\xef\xbb\xbf" + one().encode(), False)]
    return out


def patch_json():
    sides = [{"kind": "bezier", "points": [[0, 0, 0], [1, 0, 1], [2, 0, 0]]}, {"kind": "bezier", "points": [[2, 0, 0], [2, 1, 1], [1, 2, 0]]}, {"kind": "bezier", "points": [[1, 2, 0], [0, 1, 1], [0, 0, 0]]}]
    make = lambda s=sides, **more: json.dumps({"patches": [{"sides": s, **more}]})
    texts = {"two-sides": make(sides[:2]), "four-sides": make(sides + sides[:1]), "no-sides": '{"patches": [{}]}', "patches-empty": '{"patches": []}', "no-patches": "{}", "side-number": make([1, 2, 3]), "open": make([sides[0], sides[1], {"kind": "bezier", "points": [[9, 9, 9], [0, 1, 1], [0, 0, 0]]}]),
             "turned": make([sides[0], {"kind": "bezier", "points": sides[1]["points"][::-1]}, sides[2]]), "divisions-0": make(divisions=0), "divisions-negative": make(divisions=-3), "divisions-2-31": make(divisions=2**31), "divisions-2-63": make(divisions=2**63), "divisions-1e9": make(divisions=10**9), "divisions-word": make(divisions="many"),
             "closed-side": make([{"kind": "bezier", "points": [[0, 0, 0], [1, 1, 1], [0, 0, 0]]}] * 3), "one-point": make([{"kind": "bezier", "points": [[1, 1, 1]] * 3}] * 3), "nan": make().replace("[2, 1, 1]", "[NaN, 1, 1]"), "kind-unknown": make().replace("bezier", "arc")}
    out = [(n, t.encode(), True) for n, t in texts.items()]
    crossing = make([{"kind": "bezier", "points": [[0, 0, 0], [9, 3, 0], [-7, 3, 0], [2, 0, 0]]}, sides[1], sides[2]])
    return out + [(n, d, True) for n, d in cuts(make().encode(), 6)] + [("self-crossing", crossing.encode(), False), ("1e308", make().replace("[2, 1, 1]", "[1e308, 1, 1]").encode(), False)]


def quadric_json(sound):
    value = json.loads(sound)
    out = [("empty", b"", True), ("null", b"null", True), ("no-keys", b"{}", True), ("list", b"[]", True), ("word", b'"quadrics"', True)]
    for key in value:
        out.append((f"without-{key}", json.dumps({k: v for k, v in value.items() if k != key}).encode(), False))
        for name, other in [("null", None), ("word", "x"), ("list", []), ("object", {}), ("number", -1), ("2-63", 2**63)]:
            out.append((f"{key}-{name}", json.dumps({**value, key: other}).encode(), False))
    return out + [(n, d, True) for n, d in cuts(sound.strip(), 8)]


def model(sound):
    """Every change breaks the checksum. What gets past it is tests/model's business."""
    out = [(n, d, True) for n, d in cuts(sound, 12)] + [(n, d, True) for n, d in flips(sound, 30)]
    return out + [("longer", sound + b"\0", True), ("twice", sound + sound, True), ("zeros", b"\0" * 4096, True), ("version", sound[:8] + b"\xff\xff" + sound[10:], True), ("text", b"retalho\n", True)]


def svg():
    make = lambda d: f'<svg xmlns="http://www.w3.org/2000/svg"><path d="{d}"/></svg>'
    texts = {"empty": "", "no-path": '<svg xmlns="http://www.w3.org/2000/svg"></svg>', "not-xml": "M 0 0 L 1 1", "path-empty": make(""), "unknown-letter": make("M 0 0 K 1 1"), "no-move": make("L 1 1"), "odd-numbers": make("M 0 0 L 1"), "word": make("M zero 0 L 1 1"),
             "nan": make("M nan 0 L 1 1"), "1e400": make("M 1e400 0 L 1 1"), "arc-short": make("M 0 0 A 1 1 0 0"), "arc-flag": make("M 0 0 A 1 1 0 7 0 2 2"), "cubic-short": make("M 0 0 C 1 1 2 2"), "unended": make("M 0 0 L 1 1")[:-12], "attribute-unended": '<svg><path d="M 0 0 L 1 1'}
    return [(n, t.encode(), True) for n, t in texts.items()] + [("move-only", make("M 0 0").encode(), False), ("crossing", make("M 0 0 L 9 9 L 9 0 L 0 9 Z").encode(), False)]


def geojson():
    make = lambda g: json.dumps({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": g}]})
    line = {"type": "LineString", "coordinates": [[0, 0], [1, 1], [2, 0]]}
    sound = make(line)
    out = [(n, t.encode(), True) for n, t in {"empty": "", "no-features": '{"type": "FeatureCollection", "features": []}', "geometry-null": make(None), "type-unknown": make({"type": "Circle", "coordinates": [0, 0]}), "points-only": make({"type": "Point", "coordinates": [0, 0]}), "no-type": "{}"}.items()]
    return out + [(n, d, True) for n, d in cuts(sound.encode(), 6)]

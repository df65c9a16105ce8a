#!/usr/bin/python3
"""Error messages of the program, each produced by a command: its exit code, its words, and no output left.

  messages.py --program FILE

A row: the command, the exit code, a part of the message. Files are named as in FILES; words like NAME=value in front of
a command set its environment.
"""
import concurrent.futures
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import broken
import checks

ROOT = pathlib.Path(__file__).resolve().parents[2]


def grid(columns=12, rows=10, head="", value=lambda c, r: 100 + 7 * c + 3 * r + (c * r) % 5):
    lines = [f"ncols {columns}", f"nrows {rows}", "xllcorner 1000", "yllcorner 2000", "cellsize 10", "NODATA_value -9999"]
    return head + "\n".join(lines + [" ".join(str(value(c, r)) for c in range(columns)) for r in range(rows)]) + "\n"


CURVE = '{"kind": "bezier", "points": [[0,0],[1,2],[3,2],[4,0]]}'
PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n"


def curves(text):
    return f'{{"curves": [{text}]}}'


def patches(sides, more="", names=""):
    return f'{{"curves": [{{"kind": "bezier", "points": [[0,0],[1,0]]}}, {{"kind": "bezier", "points": [[1,0],[0,1]]}}, {{"kind": "bezier", "points": [[0,1],[0,0]]}}{names}], "patches": [{{"sides": {sides}{more}}}]}}'


FILES = {
    "g.asc": grid(), "void.asc": grid(value=lambda c, r: -9999), "p.xyz": "0 0 1\n10 0 2\n0 10 3\n10 11 5\n4 6 2\n", "two.xyz": "1 2\n",
    "comma.xyz": "1,5 2,5 3,5\n1,5 2,6 3,7\n", "zero.xyz": "1 2 3\n\0\0\0\n", "wide.xyz": "\xff\xfe1\x00 \x00", "header.xyz": "a b x y z\n1 2 3\n",
    "ragged.xyz": "1 2 3\n1 2 3\n1 2\n", "c.json": curves(CURVE), "folder/x": "", "text.retalho": "nothing of ours, but long enough to be read as a head",
    "p2.pgm": "P2\n3 2\n9\n1 2 3\n", "big.pgm": "P2\n3 2\n99999999999999999999\n", "many.pgm": "P2\n90000 90000\n9\n1 2 3\n", "none.pgm": "P2\n3\n",
    "flat.pgm": "P2\n0 2\n9\n", "sign.pgm": "P2\n3 2\n9\n1 2 -3 4 5 6\n", "more.pgm": "P2\n3 2\n9\n1 2 3 4 5 6 7\n", "good.pgm": "P2\n3 2\n9\n1 2 3 4 5 6\n",
    "no.ply": "plx\n", "noformat.ply": "ply\nelement vertex 3\nproperty float x\nend_header\n", "element.ply": "ply\nformat ascii 1.0\nelement vertex\n",
    "word.ply": "ply\nformat ascii 1.0\nflavour sweet\nend_header\n", "cut.ply": "ply\nformat ascii 1.0\nelement vertex 3\n",
    "early.ply": "ply\nformat ascii 1.0\nproperty float x\nend_header\n", "list.ply": "ply\nformat ascii 1.0\nelement face 1\nproperty list float int x\nend_header\n",
    "typed.ply": "ply\nformat ascii 1.0\nelement vertex 1\nproperty float\nend_header\n", "noz.ply": PLY.replace("property float z\n", "").replace(" 0\n", "\n"),
    "novertex.ply": "ply\nformat ascii 1.0\nelement face 0\nproperty list uchar int v\nend_header\n", "few.ply": PLY.replace("binary", "ascii").replace("vertex 3", "vertex 300000"),
    "no.las": "LASX" + "\0" * 400, "bad.svg": "<svg><path", "none.svg": "<svg xmlns='http://www.w3.org/2000/svg'></svg>",
    "letter.svg": "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0 K 3 4'/></svg>", "start.svg": "<svg xmlns='http://www.w3.org/2000/svg'><path d='L 3 4'/></svg>",
    "flag.svg": "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0 A 1 1 0 7 0 3 4'/></svg>",
    "nojson.json": "{", "nokind.json": curves("{}"), "kindless.json": curves("7"), "numbers.json": curves('{"kind": "polyline", "points": 3}'),
    "one.json": curves('{"kind": "polyline", "points": [[0,0]]}'), "weights.json": curves('{"kind": "bezier", "points": [[0,0],[1,2],[3,2],[4,0]], "weights": [1]}'),
    "degree.json": curves('{"kind": "bspline", "degree": 99, "points": [[0,0],[1,2]], "knots": [0,0,1,1]}'),
    "short.json": curves('{"kind": "bspline", "degree": 3, "points": [[0,0],[1,2]], "knots": [0,0,0,0,1,1,1,1]}'),
    "empty.json": curves('{"kind": "explicit", "f": "x", "from": 3, "to": 1}'), "two.json": curves('{"kind": "explicit", "f": "x+y", "from": 0, "to": 1}'),
    "nowhere.json": curves('{"kind": "explicit", "f": "sqrt(-1-x^2)", "from": 0, "to": 1}'), "box.json": curves('{"kind": "implicit", "f": "x*y", "box": [1,1,0,0]}'),
    "depth.json": curves('{"kind": "implicit", "f": "x*y", "box": [0,0,1,1], "depth": 99}'), "formula.json": curves('{"kind": "explicit", "f": "x+", "from": 0, "to": 1}'),
    "twice.json": curves('{"kind": "lagrange", "points": [[0,0],[1,2]], "nodes": [1,1]}'), "closed.json": curves('{"kind": "spline", "points": [[0,0],[1,2]], "closed": 3}'),
    "nosides.json": '{"curves": [], "patches": [{}]}', "nocurve.json": patches("[0, 1, 9]"), "noname.json": patches('[0, 1, "edge"]'),
    "nonumber.json": patches("[0, 1, true]"), "dive.json": patches("[0, 1, 2]", ', "divisions": "x"'), "divs.json": patches("[0, 1, 2]", ', "divisions": 0'),
    "gap.json": patches("[0, 1, 3]", "", ', {"kind": "bezier", "points": [[5,5],[0,0]]}'),
    "point.json": patches("[0, 1, 3]", "", ', {"kind": "bezier", "points": [[0,0],[0,0]]}'), "good.json": patches("[0, 1, 2]"),
    "q.json": "[]", "qkey.json": '{"vertices": 3}', "tetra.ply": "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n",
    "at.txt": "x y\n1 2\nthree 4\n", "same.ply": PLY.replace("1 0 0\n0 1 0\n", "0 0 0\n0 0 0\n"),
    "layers.geojson": '{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"h": 3, "name": "a"}, "geometry": {"type": "Point", "coordinates": [1, 2]}}]}',
    "turned.vrt": '<VRTDataset rasterXSize="4" rasterYSize="4"><GeoTransform>0,1,0.5,0,0.3,-1</GeoTransform><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>',
    "quarter.vrt": '<VRTDataset rasterXSize="4" rasterYSize="4"><GeoTransform>0,0,1,0,1,0</GeoTransform><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>',
    "thin.vrt": '<VRTDataset rasterXSize="4" rasterYSize="4"><GeoTransform>0,0,0,0,0,-1</GeoTransform><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>',
    "complex.vrt": '<VRTDataset rasterXSize="4" rasterYSize="4"><VRTRasterBand dataType="CFloat32" band="1"/></VRTDataset>',
    "scale.vrt": '<VRTDataset rasterXSize="4" rasterYSize="4"><VRTRasterBand dataType="Int16" band="1"><Scale>0</Scale></VRTRasterBand></VRTDataset>',
    "bandless.vrt": '<VRTDataset rasterXSize="4" rasterYSize="4"></VRTDataset>',
    "utm31.vrt": '<VRTDataset rasterXSize="4" rasterYSize="4"><SRS>EPSG:32631</SRS><GeoTransform>0,1,0,0,0,-1</GeoTransform><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>',
    "utm32.vrt": '<VRTDataset rasterXSize="4" rasterYSize="4"><SRS>EPSG:32632</SRS><GeoTransform>0,1,0,0,0,-1</GeoTransform><VRTRasterBand dataType="Float32" band="1"/></VRTDataset>',
    "million.vrt": '<VRTDataset rasterXSize="1100" rasterYSize="1000"><GeoTransform>0,1,0,0,0,-1</GeoTransform><VRTRasterBand dataType="Float32" band="1"><SimpleSource><SourceFilename relativeToVRT="1">g.asc</SourceFilename>'
    '<SrcRect xOff="0" yOff="0" xSize="12" ySize="10"/><DstRect xOff="0" yOff="0" xSize="1100" ySize="1000"/></SimpleSource></VRTRasterBand></VRTDataset>',
    "globe/layer.json": "{}", "corner.json": curves('{"kind": "polyline", "points": [[0,0],[1,2],[2,0]]}'),
    "back.json": curves('{"kind": "spline", "points": [[0,0],[2,2],[1,3]], "parameters": "x"}'),
    "interval.json": curves('{"kind": "power", "coefficients": [[0,0],[1,2]], "interval": [1, 0]}'),
}
# Made by the program itself.
MADE = [["fit", "g.asc", "-o", "m.retalho", "--max-error", "1", "--refine", "flat"], ["fit", "p.xyz", "-o", "points.retalho"],
        ["fit", "utm31.vrt", "-o", "utm.retalho", "--max-error", "1", "--refine", "flat"],
        ["patch", "good.json", "-o", "patch.retalho", "--divisions", "4"],
        ["reconstruct", str(ROOT / "examples/tetraquads/sphere.json"), "-o", "ball.retalho"],
        ["fit", "g.asc", "-o", "c.retalho", "--max-error", "1", "--format", "compact"], ["fit", "g.asc", "-o", "ps.retalho", "--max-error", "1", "--surface", "powell-sabin", "--refine", "flat"],
        ["fit", "g.asc", "-o", "tiled", "--tiles", "16", "--max-error", "1"],
        ["sample", "m.retalho", "-o", "s.tif"], ["contour", "g.asc", "-o", "s.shp", "--interval", "5"]]

ROWS = [
    # What any command says.
    ("inffo g.asc", 2, "there is no command 'inffo'"), ("info", 2, "See `retalho info --help`"), ("info g.asc --overwrit", 2, "has no option '--overwrit'"),
    ("info g.asc --timeout 0", 2, "is no number of seconds above 0"), ("info g.asc --memory-limit 3X", 2, "is no size: a number of bytes"),
    ("info g.asc --memory-limit 1M", 3, "raise it on a machine that has more"), ("fit g.asc -o x/y.retalho", 5, "does not exist: make it first"),
    ("fit g.asc -o folder", 2, "must end in .retalho"), ("mesh m.retalho -o g.asc", 2, "must end in"), ("render g.asc -o g.asc", 2, "must end in"),
    ("fit g.asc -o m.retalho", 5, "add --overwrite to replace it"), ("patch patch.retalho -o patch.retalho --overwrite", 2, "is also an input: give another name"),
    # fit
    ("fit g.asc -o o.retalho --vertices 9 --ratio 1%", 2, "say the same in two ways"), ("fit g.asc -o o.retalho --max-error -1", 2, "--max-error must be 0 or more, not"),
    ("fit g.asc -o o.retalho --vertices 2", 2, "--vertices must be 3 or more"), ("fit g.asc -o o.retalho --ratio 2", 2, "is not a share of the valid cells"),
    ("fit g.asc -o o.retalho --surface smoth", 2, "is one of linear, powell-sabin, clough-tocher; not 'smoth'"), ("fit p.xyz -o o.retalho --tiles 64", 2, "--tiles takes grids"),
    ("fit g.asc -o o.retalho --jobs 2", 2, "--jobs goes with --tiles"), ("fit g.asc -o o --tiles 64", 2, "--tiles takes one of --max-error E"), ("fit g.asc -o o --tiles 64 --max-error 1 --format compact", 2, "--tiles writes exact models: leave --format compact out"),
    ("fit g.asc -o o --tiles 64 --max-error 1 --gradients quadratic", 2, "--tiles takes --gradients normals and --cross-derivative perpendicular"),
    ("fit g.asc -o o --tiles 64 --max-error 1 --refine surface", 2, "--tiles takes --refine surface with --vertices or --ratio"), ("fit g.asc -o p.xyz --tiles 64 --max-error 1", 5, "is a file: with --tiles the output is a folder"),
    ("fit g.asc -o o.retalho --breaklines c.json", 2, "--breaklines goes with points"), ("fit p.xyz -o o.retalho --format compact", 2, "takes grids: its vertices are their cells"),
    ("fit g.asc -o o.retalho --format compact --gradients normals", 2, "fits the gradients: leave --gradients out"),
    ("fit g.asc -o o.retalho --format compact --cross-derivative cubic", 2, "takes --cross-derivative perpendicular"),
    ("fit g.asc -o o.retalho --format compact --surface powell-sabin", 2, "holds linear and clough-tocher surfaces"),
    ("fit g.asc -o o.retalho --format compact --surface linear --fit z-only", 2, "--fit z-only is for clough-tocher"),
    ("fit g.asc -o o.retalho --surface linear --refine surface --fit z-only --vertices 30", 2, "heights alone are fitted for a smooth surface"),
    ("fit g.asc -o o.retalho --refine surface --fit z-only --max-error 1", 2, "heights alone are refined to a number of vertices"),
    ("fit g.asc -o o.retalho --fit least-squares --gradients normals --refine flat", 2, "exclude each other: the fit sets the gradients"),
    ("fit p.xyz -o o.retalho --creases auto --vertices 4", 2, "--breaklines says where a surface of points folds"),
    ("fit g.asc -o o.retalho --creases a.geojson --vertices 9 --format compact", 2, "folds at vertices that it chooses"),
    ("fit g.asc -o o.retalho --creases auto --vertices 9 --format compact --surface linear", 2, "--creases auto is for --surface clough-tocher"),
    ("fit g.asc -o o.retalho --creases auto --max-error 2", 2, "give --vertices or --ratio, and no --max-error"), ("fit g.asc -o o.retalho --creases auto", 2, "goes with a budget"),
    ("fit g.asc -o o.retalho --creases auto --vertices 9 --surface linear", 2, "a flat one folds along every edge"),
    ("fit g.asc -o o.retalho --creases auto --vertices 9 --refine flat", 2, "--creases goes with --refine surface"),
    ("fit g.asc -o o.retalho --creases auto --vertices 9 --fit z-only --refine surface", 2, "leave --fit z-only out"),
    ("fit g.asc -o o.retalho --crease-layer a --vertices 9", 2, "--crease-layer goes with --creases FILE"), ("fit g.asc -o o --tiles 64 --max-error 1 --creases auto", 2, "--creases takes no --tiles"),
    ("fit g.asc -o o.retalho --creases none.geojson --vertices 9", 4, "none.geojson"),
    ("fit p.xyz -o o.retalho --crs nonsense", 3, "is not a CRS: give a code as EPSG:25832"),
    # compare
    ("compare g.asc", 2, "give models to compare with the grid"), ("compare g.asc m.retalho --vertices 5", 2, "models and a budget"),
    ("compare g.asc m.retalho --markdown --csv", 2, "--json, --markdown and --csv exclude each other"),
    ("compare g.asc m.retalho --tile-memory -5", 2, "--tile-memory must be 1 MB or more"), ("compare g.asc m.retalho --tile-memory 1e300", 2, "--tile-memory must be"),
    ("fit g.asc -o o.retalho --fit z-only --refine surface", 2, "--fit z-only --refine surface takes a number of vertices"),
    ("compare g.asc m.retalho --visibility-maps maps", 2, "needs --visibility RADIUS"), ("compare g.asc m.retalho --tile-memory 0", 2, "--tile-memory must be 1 MB or more"),
    ("compare g.asc patch.retalho", 3, "holds no terrain: this command works on models made by"), ("compare utm32.vrt utm.retalho", 3, "bring one into the other's (gdalwarp) first"),
    ("compare g.asc m.retalho --visibility 100 --visibility-maps g.asc/x", 5, "cannot make the folder"),
    # contour
    ("contour m.retalho -o o.gpkg --interval 5 --surface linear", 2, "a model has its surface already: --surface"), ("contour p.xyz -o o.gpkg --interval 5 --surface bicubic", 2, "needs a grid: points take the other three"),
    ("contour g.asc -o o.gpkg --interval 5 --vertices 9", 2, "--surface bicubic takes every cell"), ("contour g.asc --interval 5 --compare-surfaces o.png --vertices 9", 2, "--compare-surfaces draws every cell or point"),
    ("contour m.retalho -o o.gpkg --interval 5 --max-error 1", 2, "a model has its vertices already"), ("contour m.retalho --interval 5 --compare-surfaces o.png", 2, "--compare-surfaces is for grids and points"),
    ("contour void.asc --interval 5 --compare-surfaces o.png", 3, "the part that is shown has no data"), ("contour g.asc -o o.gpkg", 2, "say which levels"),
    ("contour g.asc --interval 5", 2, "name an output: -o FILE for lines"), ("contour g.asc -o o.gpkg --levels 5,x", 2, "is not a number (100,200,350)"),
    ("contour g.asc -o o.gpkg --interval 5 --title Hills", 2, "is for map sheets: name the output .svg or .pdf"),
    ("contour g.asc -o o.dxf --interval 5 --bands", 5, "DXF has no polygons"),
    # sample
    ("sample points.retalho -o o.tif", 2, "this model was made from points: say the cell size"),
    ("sample m.retalho -o o.tif --what height --what slope", 2, "a raster holds one quantity"), ("sample m.retalho -o o.tif --what normal", 2, "a normal has three numbers and a raster one"),
    ("sample m.retalho --points at.txt", 3, "expected x and y, found 'three 4'"), ("sample m.retalho --points none.txt", 4, "cannot open 'none.txt'"),
    ("sample m.retalho", 2, "give either -o FILE for a raster"), ("sample m.retalho --at 1,2 --like g.asc", 2, "are for rasters (-o FILE), not for points"),
    ("sample m.retalho -o o.tif --like g.asc --resolution 3", 2, "give --like or --resolution, not both"), ("sample m.retalho -o o.tif --resolution -1", 2, "--resolution must be above 0"),
    ("sample m.retalho --at 1;2", 2, "is not X,Y: two numbers with a comma and no space"), ("sample g.asc -o o.tif", 4, "is not a model file of retalho"),
    ("sample m.retalho -o o.tif --resolution 1e-9", 2, "a side: give a larger one"), ("sample m.retalho -o o.xyzzy", 5, "no raster format that GDAL writes has the ending"), ("sample text.retalho --at 1,2", 4, "text.retalho"),
    # viewshed
    ("viewshed g.asc -o o.tif --intervisibility --observer 1,2", 2, "looks from every cell: leave out"), ("viewshed m.retalho -o o.tif --intervisibility --exact", 2, "works on cells: leave out --exact"),
    ("viewshed g.asc -o o.tif --exact --observer 1030,2030", 2, "--exact asks for a model"), ("viewshed g.asc -o o.tif", 2, "give --observer X,Y (or --intervisibility)"),
    ("viewshed g.asc -o o.tif --stride 2 --observer 1030,2030", 2, "--stride thins the map of --intervisibility"), ("viewshed g.asc --observer 1030,2030", 2, "give the output with -o"),
    ("viewshed g.asc -o o.tif --observer 1030,2030,x", 2, "expected X,Y or X,Y,HEIGHT"), ("viewshed g.asc -o o.tif --intervisibility --stride 99", 2, "a stride of 99 cells: the grid has 12 x 10 cells"),
    # mesh, render
    ("mesh m.retalho -o o.ply --tolerance -1", 2, "--tolerance must be 0 or more"), ("mesh m.retalho -o o.ply --level 3", 2, "go with -o DIR/layer.json or"),
    ("mesh m.retalho -o d/tileset.json --level 3", 2, "are of quantized-mesh (-o DIR/layer.json)"), ("mesh m.retalho -o d/layer.json --tile-triangles 3", 2, "--tile-triangles is of 3D Tiles"),
    ("mesh m.retalho -o d/layer.json --level -3", 2, "--level must be 0 or more"),
    ("mesh m.retalho -o d/layer.json", 3, "a place on the globe needs a CRS"),
    ("render void.asc -o o.png", 3, "has no valid cell to draw"), ("render g.asc -o o.png --light 300,0", 2, "the altitude must be above 0"),
    ("render g.asc -o o.png --exaggeration 0", 2, "--exaggeration must be above 0"), ("render g.asc -o o.png --elevation 99", 2, "--elevation must be between 0 and 90 degrees"),
    ("render g.asc -o o.png --from nan", 2, "--from must be a number of degrees"), ("render patch.retalho m.retalho -o o.png", 2, "is a terrain: terrains are drawn among themselves"),
    ("render ball.retalho -o o.png --cut q", 2, "is not an axis, < or >, and a number"), ("render ball.retalho -o o.png --up w", 2, "--up is x, y or z"), ("render g.asc -o o.png --size 3x4", 2, "is not WxH in pixels"),
    # patch, reconstruct
    ("patch tetra.ply -o o.png --corners 1,2", 2, "--corners: expected three vertex numbers"), ("patch good.json -o o.png --divisions 1,2", 2, "expected one number, or three with commas"),
    ("patch m.retalho -o o.png", 3, "holds no patches"), ("patch good.json -o o.png --refine 0", 2, "--refine: 1 to 1000"), ("patch good.json -o o.png --elevation 100", 2, "--elevation: -90 to 90 degrees"),
    ("patch nojson.json", 3, "not JSON (line 1, column 2)"), ("patch nosides.json", 3, '"sides" is missing'), ("patch nocurve.json", 3, "there is no curve 9"), ("patch noname.json", 3, "there is no curve of the name"),
    ("patch nonumber.json", 3, "expected a curve's number or name, got"), ("patch dive.json", 3, "expected a whole number from 1 to 10000, or three, got"), ("patch divs.json", 3, "divisions"),
    ("patch gap.json", 3, "do not meet at corner"), ("patch point.json", 3, "has no length: all of it is at"), ("patch tetra.ply", 3, "the mesh is closed: a patch has a border"),
    ("reconstruct same.ply -o o.ply", 3, "lie at one place: that makes no surface"), ("reconstruct p.xyz -o o.ply --resolution 1", 2, "the resolution must be from 2 to 1000"),
    ("reconstruct p.xyz -o o.ply --tolerance -2", 2, "--tolerance must be 0 or more"), ("reconstruct p.xyz -o o.ply --adaptive 900 --resolution 9", 2, "chooses the sizes of tetrahedra itself"),
    ("reconstruct p.xyz -o o.ply --max-error 0", 2, "--max-error must be above 0"), ("reconstruct p.xyz -o o.ply --max-error 1 --quantile 2", 2, "the share of the points that must be within"),
    ("reconstruct p.xyz -o o.ply --parts 0", 2, "--parts must be 1 or more"), ("reconstruct p.xyz -o o.ply --resolution 4 --part-points 999999", 2, "no part of the surface has 999999 points near it"),
    ("reconstruct q.json -o o.ply --parts 1", 2, "are for surfaces that are fitted to points"),
    ("reconstruct q.json -o o.ply", 3, "is not a JSON object"), ("reconstruct qkey.json -o o.ply", 3, "is no key of"),
    # curve
    ("curve c.json -o o.svg --size 3x4", 2, "expected WIDTHxHEIGHT in pixels"), ("curve none.json", 4, "no such file"), ("curve nojson.json", 3, "not JSON (line 1, column 2)"), ("curve nokind.json", 3, '"kind" is missing'),
    ("curve kindless.json", 3, "expected an object, got"), ("curve numbers.json", 3, "expected an array of points, got"), ("curve one.json", 3, "a polyline needs at least 2 points"), ("curve weights.json", 3, "one a point is needed"),
    ("curve degree.json", 3, "expected a whole number from 1 to 63, got 99"), ("curve short.json", 3, "needs at least"), ("curve empty.json", 3, "is not above \"from\""), ("curve two.json", 3, "an explicit curve is a function of x alone"),
    ("curve nowhere.json", 3, "is defined nowhere between"), ("curve box.json", 3, "with xmin < xmax and ymin < ymax"), ("curve depth.json", 3, "has no such key; it has f, box"), ("curve formula.json", 3, "formula"),
    ("curve closed.json", 3, "expected true or false, got"), ("curve bad.svg", 4, "not an SVG file"), ("curve none.svg", 3, "no path, polyline, polygon or line in the SVG file"),
    ("curve letter.svg", 3, "is no path command"), ("curve start.svg", 3, "a path begins with M"), ("curve flag.svg", 3, "expected the flag 0 or 1"),
    ("curve c.json -o o.svg --window 3,3,1,1", 2, "xmin < xmax and ymin < ymax are needed"),
    ("contour g.asc -o o.gpkg --interval -5", 2, "--interval: '-5' is not a number above 0"), ("viewshed g.asc -o o.tif --radius -5", 2, "'-5' is not a number of 0 or more"), ("info g.asc --band 0", 2, "'0' is not a number above 0"),
    ("contour g.asc -o o.xyz --interval 5", 2, "must end in"), ("contour g.asc -o o.gpkg --interval 5 --conics", 2, "--conics writes curves"), ("contour g.asc -o o.json --interval 5 --conics --bands", 2, "--conics gives exact lines"),
    ("contour g.asc -o o.json --interval 5 --conics", 2, "--conics is for Powell-Sabin surfaces"),
    ("fit g.asc -o o.retalho --max-error 1 --refine flat --effort best", 2, "--effort moves the vertices of a surface"),
    ("fit g.asc -o o.retalho --max-error 0 --refine surface", 2, "takes a --max-error over 0"), ("fit g.asc -o o --tiles 3 --max-error 1", 2, "cells a side, not 3"), ("fit g.asc -o o --tiles 16 --vertices 3", 2, "the corners and outlines of the tiles alone are"),
    ("fit good.pgm -o o --tiles 16 --max-error 1", 3, "no part of an ASCII PGM can be read by itself"),
    ("viewshed void.asc -o o.tif --observer 1030,2030", 3, "holds no data: move the observer to a valid cell"), ("viewshed void.asc --observer 1030,2030 --to 1050,2050", 3, "holds no data"),
    ("viewshed g.asc -o o.tif --intervisibility --stride 0", 2, "'0' is not a number above 0"), ("viewshed m.retalho -o o.tif --exact --observer 1,2", 3, "the model has no data at the"),
    ("render g.asc g.asc g.asc -o o.png --size 16x16", 2, "pictures do not fit on"),
    ("reconstruct p.xyz -o o.ply --max-error 1 --quantile 0", 2, "the share of the points that must be within"), ("patch good.json -o o.png --divisions 0", 2, "divisions of a side: 1 to 10000 are possible"), ("patch good.json -o o.png --snap -1", 2, "the snapping distance must be 0 or more"),
    ("curve c.json -o o.svg --cut 1 0", 2, "the part from 1 to 0 is empty"), ("curve c.json -o o.xyz", 2, "must end in"),
    ("fit g.asc -o .. --max-error 1", 2, "must end in .retalho"), ("info", 2, "FILE is required"),
    ("contour utm.retalho -o o.gpkg --levels 5 --area 1,1,0,0", 2, "has no option"), ("compare g.asc utm.retalho", 3, "no valid cell of the grid lies on the model"),
    ("contour million.vrt --interval 50 --compare-surfaces o.png --zoom 0", 2, "compared on every cell, a million at most, not 1100000: show fewer (--zoom)"),
    ("contour g.asc -o o.svg --interval 5 --sheet 30x30", 2, "is no sheet: A0 to A6, or WIDTHxHEIGHT in mm, 80 to 5000 each (297x210)"),
    ("contour g.asc -o o.pdf --interval 5 --title \udcff", 5, "cannot draw the sheet: input string not valid UTF-8"), ("RETALHO_FONT=none.ttf render g.asc -o o.png", 4, "cannot read the font 'none.ttf': install fonts-dejavu-core"),
    ("GDAL_SKIP=DXF contour g.asc -o o.dxf --interval 5", 5, "this GDAL has no driver DXF"), ("GDAL_SKIP=DXF curve c.json -o o.dxf --flatten 0.1", 5, "this GDAL has no driver DXF"),
    ("mesh utm.retalho -o globe/layer.json", 5, "' exists: give another folder, or --overwrite"),
    ("curve corner.json -o o.json --convert hermite", 2, "the curve is not C1: it has no Hermite form with one tangent a point"), ("curve interval.json", 3, "expected two ascending numbers"), ("curve back.json", 3, "with the parameters \"x\" they must ascend"),
    ("fit g.asc -o o.retalho --fit z-only --gradients normals --refine flat", 2, "exclude each other: the fit sets the gradients"), ("render g.asc -o o.png --size 1200", 2, "is not WxH in pixels, such as 1200x800 (16 to 20000)"),
    ("contour t-void -o o.gpkg --interval 5", 4, "no tile of 't-void' holds any data"), ("mesh t-void -o o.ply", 4, "no tile of 't-void' holds any data"),
    # readers
    ("info folder", 4, "is a folder: give the name of a raster file"), ("info turned.vrt", 3, "the grid is rotated or sheared"), ("info quarter.vrt", 3, "the grid is rotated by a quarter turn"), ("info thin.vrt", 3, "the cells have no size"),
    ("info complex.vrt", 3, "holds complex numbers"), ("info scale.vrt", 3, "make no heights"), ("info bandless.vrt", 4, "bandless.vrt"), ("info g.asc --band 2", 3, "it has bands 1 to 1"), ("info good.pgm --band 2", 3, "a PGM has one band"),
    ("info p2.pgm", 4, "the file ends at sample 3 of 6"), ("info big.pgm", 4, "is larger than 2^53"), ("info many.pgm", 4, "samples do not fit into"), ("info none.pgm", 4, "the file ends before the height"),
    ("info flat.pgm", 4, "is 0; it should be 1 to"), ("info sign.pgm", 4, "should be a whole number of digits"), ("info more.pgm", 4, "something follows the last of the"),
    ("info two.xyz", 3, "two numbers; a point needs x, y and z"), ("info comma.xyz", 3, "has a decimal comma: write numbers with a point (1.5)"), ("info zero.xyz", 4, "is not text: it holds zero bytes"), ("info header.xyz", 4, "the header names x, y or z in column"),
    ("info ragged.xyz", 4, "where the first point has"), ("info no.ply", 4, "the first line is not 'ply'"), ("info noformat.ply", 4, "the header has no format line"), ("info element.ply", 4, "an element needs a name and a count"),
    ("info word.ply", 4, "unknown word 'flavour' in the header"), ("info cut.ply", 4, "the file ends inside the header"), ("info early.ply", 4, "a property before any element"), ("info list.ply", 4, "cannot count a list"),
    ("info typed.ply", 4, "a property needs a type and a name"), ("info noz.ply", 3, "its vertices have no property 'z'"), ("info novertex.ply", 3, "has no vertices"), ("info few.ply", 4, "the file is cut off or damaged"),
    ("info no.las", 4, "is no LAS file: it does not begin with LASF"), ("info layers.geojson --height-field q", 3, "has no attribute 'q'"),
    ("info layers.geojson --height-field name", 3, "is not a number; numeric ones"), ("info layers.geojson --height-field h --layer q", 3, "has no layer 'q'"), ("info text.retalho", 4, "text.retalho"), ("info nothing.tif", 4, "nothing.tif"),
]


def main():
    program = checks.program(__doc__)
    failures = []
    with tempfile.TemporaryDirectory(prefix="messages-") as home:
        stock = pathlib.Path(home)
        for name, text in FILES.items():
            (stock / name).parent.mkdir(exist_ok=True)
            (stock / name).write_bytes(text.encode("latin-1"))
        for words in MADE:
            subprocess.run([program, *words, "-q"], cwd=stock, check=True, stdout=subprocess.DEVNULL)
        rows = ROWS + broken.make(stock)
        before = sorted(p.name for p in stock.iterdir())

        def look(row):
            words, code, part = row
            command = words.split()
            first = next(k for k, word in enumerate(command) if not re.match("[A-Z_]+=", word))
            settings = dict(word.split("=", 1) for word in command[:first])
            done = subprocess.run([program, *command[first:], "-q"], cwd=stock, env={**os.environ, **settings}, capture_output=True, text=True, errors="replace", timeout=60)
            if done.returncode != code or part not in done.stderr or "retalho: " not in done.stderr:
                failures.append(f"{words}: exit {done.returncode}, not {code} with '{part}': {done.stderr.strip()[-300:]}")

        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(look, rows))
        left = sorted(set(p.name for p in stock.iterdir()) - set(before) - {"maps", "d"})
        if left:
            failures.append(f"left behind: {left}")
        shutil.rmtree(stock / "d", ignore_errors=True)
    return checks.verdict(f"{len(rows)} messages", failures)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
"""Grids at the ends of what there is, through every command: the whole output with exit 0, or a refusal with words and
exit 2 or 3 and no output; never a failure inside, a signal, or an output that holds no finite number.

  extremes.py --program FILE
"""
import array
import concurrent.futures
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import checks

COMMANDS = {
    "info": ["info", "g.flt"],
    "fit, every cell": ["fit", "g.flt", "-o", "o.retalho", "--max-error", "0"],
    "fit flat": ["fit", "g.flt", "-o", "o.retalho", "--refine", "flat"],
    "fit surface": ["fit", "g.flt", "-o", "o.retalho", "--vertices", "12", "--effort", "fast"],
    "fit least-squares": ["fit", "g.flt", "-o", "o.retalho", "--vertices", "12", "--fit", "least-squares", "--refine", "flat"],
    "fit network": ["fit", "g.flt", "-o", "o.retalho", "--max-error", "0", "--gradients", "network", "--surface", "powell-sabin"],
    "fit compact": ["fit", "g.flt", "-o", "o.retalho", "--format", "compact"],
    "compare": ["compare", "g.flt", "m.retalho"],
    "sample": ["sample", "m.retalho", "-o", "o.tif"],
    "contour": ["contour", "g.flt", "-o", "o.gpkg", "--levels", "{level}"],
    "contour bands": ["contour", "g.flt", "-o", "o.gpkg", "--levels", "{level}", "--bands"],
    "contour model": ["contour", "m.retalho", "-o", "o.gpkg", "--levels", "{level}"],
    "viewshed": ["viewshed", "g.flt", "-o", "o.tif", "--observer", "{x},{y},2"],
    "intervisibility": ["viewshed", "g.flt", "-o", "o.tif", "--intervisibility", "--directions", "8"],
    "mesh": ["mesh", "m.retalho", "-o", "o.ply"],
    "render": ["render", "g.flt", "-o", "o.png", "--size", "200x160"],
    "render model": ["render", "m.retalho", "-o", "o.png", "--size", "200x160"],
}


def hills(c, r):
    return 100 + 30 * math.sin(c * 0.7) * math.cos(r * 0.5)


# name: columns, rows, cell, corner, heights. As float32, or where a double is said as ASCII with many digits.
GRIDS = {
    "heights of 1e-300": (14, 12, 10, (0, 0), lambda c, r: 1e-300 * hills(c, r)),
    "heights of 1e-30": (14, 12, 10, (0, 0), lambda c, r: 1e-30 * hills(c, r)),
    "heights of 1e30": (14, 12, 10, (0, 0), lambda c, r: 1e30 * hills(c, r)),
    "heights of 1e300": (14, 12, 10, (0, 0), lambda c, r: 1e298 * hills(c, r)),
    "heights of both ends": (14, 12, 10, (0, 0), lambda c, r: 1e300 if (c + r) % 5 == 0 else 1e-300),
    "5e6 and cells of 1 cm": (14, 12, 0.01, (5000000.01, 5000000.02), hills),
    "flat": (14, 12, 10, (0, 0), lambda c, r: 7),
    "one cell": (1, 1, 10, (0, 0), lambda c, r: 7),
    "one row": (14, 1, 10, (0, 0), hills),
    "one column": (1, 12, 10, (0, 0), hills),
    "two by two": (2, 2, 10, (0, 0), hills),
    "all void": (14, 12, 10, (0, 0), lambda c, r: None),
    "one valid cell": (14, 12, 10, (0, 0), lambda c, r: 7 if (c, r) == (5, 5) else None),
    "a chequerboard of voids": (14, 12, 10, (0, 0), lambda c, r: hills(c, r) if (c + r) % 2 else None),
    "a step of 1 km": (14, 12, 1, (0, 0), lambda c, r: 1000 if c >= 7 else 0),
    "cells of 1e-9": (14, 12, 1e-9, (0, 0), hills),
    "cells of 1e9": (14, 12, 1e9, (0, 0), hills),
}


def write_grid(folder, columns, rows, cell, corner, height):
    """A raw grid of doubles through a VRT's raw band: every digit as it is."""
    values = array.array("d", (math.nan if height(c, r) is None else height(c, r) for r in range(rows) for c in range(columns)))
    (folder / "g.raw").write_bytes(values.tobytes())
    top = corner[1] + rows * cell
    (folder / "g.flt").write_text(
        f'<VRTDataset rasterXSize="{columns}" rasterYSize="{rows}"><GeoTransform>{corner[0]!r},{cell!r},0,{top!r},0,{-cell!r}</GeoTransform>'
        '<VRTRasterBand dataType="Float64" band="1" subClass="VRTRawRasterBand"><SourceFilename relativetoVRT="1">g.raw</SourceFilename>'
        f'<ImageOffset>0</ImageOffset><PixelOffset>8</PixelOffset><LineOffset>{8 * columns}</LineOffset><ByteOrder>LSB</ByteOrder>'
        '</VRTRasterBand></VRTDataset>')


def look(program, name, grid):
    columns, rows, cell, corner, height = grid
    failures, done_well, refused = [], 0, 0
    with tempfile.TemporaryDirectory(prefix="extremes-") as home:
        folder = pathlib.Path(home)
        write_grid(folder, *grid)

        def run(words):
            return subprocess.run([program, *words, "-q", "--json", "--overwrite"], cwd=folder, capture_output=True, text=True, errors="replace", timeout=300)

        run(["fit", "g.flt", "-o", "m.retalho", "--max-error", "0"])
        valid = [height(c, r) for r in range(rows) for c in range(columns) if height(c, r) is not None]
        level = min(valid) / 2 + max(valid) / 2 if valid else 0
        values = {"level": repr(float(level)), "x": repr(corner[0] + cell * (columns // 2 + 0.5)), "y": repr(corner[1] + cell * (rows // 2 + 0.5))}
        for command, words in COMMANDS.items():
            words = [w.format(**values) for w in words]
            if "m.retalho" in words and not (folder / "m.retalho").exists():
                continue
            done = run(words)
            output = folder / words[words.index("-o") + 1] if "-o" in words else None
            if done.returncode == 0:
                done_well += 1
                if output and not output.exists():
                    failures.append(f"{name}, {command}: exit 0 without its output")
                if not done.stdout.strip():
                    failures.append(f"{name}, {command}: exit 0 and nothing said")
                elif words[0] == "fit" and not math.isfinite(json.loads(done.stdout).get("max_error") or 0):
                    failures.append(f"{name}, {command}: the error is not finite")
            elif done.returncode in (2, 3) and re.search(r"retalho: .{12}", done.stderr):
                refused += 1
                if output and output.exists():
                    failures.append(f"{name}, {command}: refused, and left its output")
            else:
                failures.append(f"{name}, {command}: exit {done.returncode}: {done.stderr.strip()[-200:]}")
            if output:
                output.unlink(missing_ok=True)
            for file in folder.iterdir():
                if file.name.startswith("."):
                    failures.append(f"{name}, {command}: left {file.name}")
                    file.unlink()
    return failures, f"{name}: {done_well} done, {refused} refused"


def main():
    program = checks.program(__doc__)
    failures = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for found, words in pool.map(lambda item: look(program, *item), GRIDS.items()):
            failures += found
            print(words)
    return checks.verdict(f"{len(GRIDS)} grids, {len(COMMANDS)} commands", failures)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
"""--timeout and --memory-limit, and the memory formula of each command (docs/limits.md).

  limits.py limits    what the options refuse; that late and heavy work ends with its exit code and leaves nothing; that
                      each command says before the work what it needs, is refused below that, runs with it, and never
                      holds more than 1.2 times the limit
  limits.py value     only the last line: the most that a command held over its limit, as JSON
  limits.py table     the table of docs/limits.md: what each command said that it needs, and what it held at its peak

Options: --program, --size N (cells a side; 900). The grids are made here; nothing is read from outside.
"""
import argparse
import array
import json
import math
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRATCH = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
UNITS = {"bytes": 1, "kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12}
# Work whose need is known from its input. The rest (a tolerance's vertices, triangles, lines) is for the watch.
KNOWN = {
    "info": ["info", "grid.flt"],
    "fit --vertices": ["fit", "grid.flt", "-o", "o.retalho", "--vertices", "{many}", "--refine", "flat"],
    "fit --fit least-squares": ["fit", "grid.flt", "-o", "o.retalho", "--vertices", "{few}", "--fit", "least-squares", "--refine", "flat"],
    "fit, points": ["fit", "points.xyz", "-o", "o.retalho"],
    "compare": ["compare", "grid.flt", "model.retalho"],
    "sample": ["sample", "model.retalho", "-o", "o.tif"],
    "sample --what slope": ["sample", "model.retalho", "-o", "o.tif", "--what", "slope"],
    "contour": ["contour", "grid.flt", "-o", "o.gpkg", "--levels", "40"],
    "contour, model": ["contour", "model.retalho", "-o", "o.gpkg", "--levels", "40"],
    "viewshed": ["viewshed", "grid.flt", "-o", "o.tif", "--observer", "1500,2500,30"],
    "viewshed, model": ["viewshed", "model.retalho", "-o", "o.tif", "--observer", "1500,2500,30"],
    "viewshed --intervisibility": ["viewshed", "grid.flt", "-o", "o.tif", "--intervisibility", "--directions", "4"],
    "render": ["render", "grid.flt", "-o", "o.png"],
    "render, model": ["render", "model.retalho", "-o", "o.png"],
    "mesh": ["mesh", "model.retalho", "-o", "o.ply", "--tolerance", "30"],
    "fit --tiles": ["fit", "grid.flt", "-o", "o.tiles", "--tiles", "512", "--max-error", "30", "--jobs", "2"],
    "patch": ["patch", "octant.json", "-o", "o.retalho", "--divisions", "{side}"],
    "patch, picture": ["patch", "octant.json", "-o", "o.png", "--divisions", "{side}", "--recovery", "spr", "--size", "3000x3000"],
    "patch of a mesh": ["patch", "disk.ply", "-o", "o.retalho"],
    "mesh, patches": ["mesh", "patch.retalho", "-o", "o.ply", "--tolerance", "30"],
    "render, patches": ["render", "patch.retalho", "-o", "o.png", "--size", "2000x2000"],
    "reconstruct": ["reconstruct", "ball.xyz", "-o", "o.retalho", "--resolution", "20"],
    "reconstruct --fit cg": ["reconstruct", "ball.xyz", "-o", "o.retalho", "--resolution", "20", "--fit", "cg"],
    "reconstruct --fit local": ["reconstruct", "ball.xyz", "-o", "o.retalho", "--resolution", "20", "--fit", "local"],
    "reconstruct --adaptive": ["reconstruct", "ball.xyz", "-o", "o.retalho", "--adaptive", "15000"],
    "mesh, TetraQuad": ["mesh", "ball.retalho", "-o", "o.ply"],
    "render, TetraQuad": ["render", "ball.retalho", "-o", "o.png", "--size", "400x400"],
    "curve": ["curve", "line.json"],
}
# Commands that do not end by themselves: only what they say.
SHOWN = {
    "view": ["view", "--no-browser", "grid.flt"],
    "view, model": ["view", "--no-browser", "model.retalho"],
    "view, points": ["view", "--no-browser", "points.xyz"],
}
UNKNOWN = {
    "fit --max-error": ["fit", "grid.flt", "-o", "o.retalho", "--max-error", "0.001", "--refine", "flat"],
    "mesh --tolerance": ["mesh", "model.retalho", "-o", "o.ply", "--tolerance", "0.02"],
}


def write_grid(folder, size):
    """Hills with a rough skin, as raw floats: made in one go, read by GDAL."""
    heights = array.array("f")
    for r in range(size):
        row = [100 + 60 * math.sin(c * 0.04) * math.cos(r * 0.03) + ((c * 7919 + r * 104729) % 97) * 0.02 for c in range(size)]
        heights.extend(row)
    (folder / "grid.flt").write_bytes(heights.tobytes())
    (folder / "grid.hdr").write_text(f"ncols {size}\nnrows {size}\nxllcorner 1000\nyllcorner 2000\ncellsize 10\n"
                                     f"NODATA_value -9999\nbyteorder LSBFIRST\n")


def write_points(folder, count):
    lines = [f"{1000 + (i * 7919) % 100003 * 0.1:.1f} {2000 + (i * 104729) % 99991 * 0.1:.1f} {(i % 97) * 0.5:.1f}" for i in range(count)]
    (folder / "points.xyz").write_text("\n".join(lines) + "\n")


def write_ball(folder, count):
    """Points of a sphere with their normals, on a spiral."""
    lines = []
    for i in range(count):
        z, a = 1 - (2 * i + 1) / count, i * 2.399963229728653
        r = math.sqrt(1 - z * z)
        lines.append(f"{r * math.cos(a):.5f} {r * math.sin(a):.5f} {z:.5f} " * 2)
    (folder / "ball.xyz").write_text("\n".join(lines) + "\n")


class Stage:
    def __init__(self, options, folder):
        self.program, self.folder, self.size = options.program, folder, options.size
        self.failures = []
        write_grid(folder, self.size)
        write_points(folder, self.size * self.size // 8)
        write_ball(folder, 20 * self.size)
        shutil.copy(ROOT / "examples/patches/octant.json", folder)
        points = [[k, round(math.sin(k), 6)] for k in range(20 * self.size)]
        (folder / "line.json").write_text(json.dumps({"curves": [{"kind": "polyline", "points": points}]}))
        for words in [["fit", "grid.flt", "-o", "model.retalho", "--vertices", str(self.size * self.size // 12), "--refine", "flat"],
                      ["patch", "octant.json", "-o", "patch.retalho", "--divisions", "{side}"],
                      ["mesh", "patch.retalho", "-o", "disk.ply", "--tolerance", "30"],
                      ["reconstruct", "ball.xyz", "-o", "ball.retalho", "--fit", "local", "--resolution", "40"]]:
            code, said, _ = self.run(words)
            if code != 0:
                raise SystemExit(f"{words}: exit {code}: {said}")

    def words(self, words):
        cells = self.size * self.size
        return [w.format(many=cells // 4, few=cells // 30, side=self.size // 3) for w in words]

    def run(self, words, *more):
        """Exit code, what it said, and the most that it held, in bytes."""
        with tempfile.TemporaryFile() as said:
            with subprocess.Popen([self.program, *self.words(words), *more, "--overwrite"], cwd=self.folder, stdout=subprocess.DEVNULL,
                                  stderr=said, env=dict(os.environ, GDAL_CACHEMAX="64")) as child:
                _, status, usage = os.wait4(child.pid, 0)
                child.returncode = os.waitstatus_to_exitcode(status)
            said.seek(0)
            return child.returncode, said.read().decode(errors="replace"), usage.ru_maxrss * 1024

    def fail(self, name, why):
        self.failures.append(f"{name}: {why}")

    def clean(self, name):
        left = [f.name for f in self.folder.iterdir() if f.name.startswith((".", "o."))]
        if left:
            self.fail(name, f"left {left}")
        self.remove()

    def remove(self):
        for f in [f for f in self.folder.iterdir() if f.name.startswith((".", "o."))]:
            shutil.rmtree(f) if f.is_dir() else f.unlink()

    def need_of(self, name, words):
        """What the command says that it needs, when it is given next to nothing."""
        started = time.monotonic()
        code, said, _ = self.run(words, "--memory-limit", "100M")
        found = re.search(r"needs about ([\d.]+) (\w+) of memory, and the limit is 100 MB", said)
        if code != 3 or not found:
            self.fail(name, f"under a limit of 100 MB: exit {code}: {said[-200:]}")
            return None
        if time.monotonic() - started > 5:
            self.fail(name, "the refusal took more than 5 s: was the work done before?")
        self.clean(name)
        return float(found[1]) * UNITS[found[2]]

    def last_need(self, name, words):
        """A command may check twice (the model's file, then its vertices): the last and largest word."""
        need = self.need_of(name, words)
        for _ in range(3):
            if need is None:
                return None
            code, said, _ = self.run(words, "--memory-limit", str(int(need * 1.01)))
            found = re.search(r"needs about ([\d.]+) (\w+) of memory", said)
            if code != 3 or not found:
                return need
            self.clean(name)
            need = float(found[1]) * UNITS[found[2]]
        self.fail(name, "never content")
        return None

    def known(self, name, words):
        need = self.last_need(name, words)
        if need is None:
            return None
        limit = int(1.01 * need)
        code, said, peak = self.run(words, "--memory-limit", str(limit))
        if code != 0:
            self.fail(name, f"with the {need / 1e6:.0f} MB that it asks for: exit {code}: {said[-200:]}")
        if peak > 1.2 * limit:
            self.fail(name, f"held {peak / 1e6:.0f} MB under a limit of {limit / 1e6:.0f} MB")
        self.remove()
        return need, peak

    def unknown(self, name, words):
        """Stopped on the way, within 1.2 times the limit."""
        code, said, peak = self.run(words)
        self.remove()
        if code != 0:
            self.fail(name, f"exit {code}: {said[-200:]}")
        limit = int(0.75 * peak)
        code, said, held = self.run(words, "--memory-limit", str(limit))
        if code != 3 or "--memory-limit" not in said:
            self.fail(name, f"held {peak / 1e6:.0f} MB; under {limit / 1e6:.0f} MB: exit {code}: {said[-200:]}")
        if held > 1.2 * limit:
            self.fail(name, f"held {held / 1e6:.0f} MB under a limit of {limit / 1e6:.0f} MB")
        self.clean(name)
        return limit, held

    def options(self):
        for option, value in [("--timeout", "0"), ("--timeout", "soon"), ("--timeout", "-1"), ("--timeout", "1s"), ("--memory-limit", "much"),
                              ("--memory-limit", "12Q"), ("--memory-limit", "0"), ("--memory-limit", "-5M"), ("--memory-limit", "5BB")]:
            code, said, _ = self.run(["info", "grid.flt"], option, value)
            if code != 2 or option not in said:
                self.fail(f"{option} {value}", f"exit {code}: {said[-200:]}")
        for size in ["2000000000", "2000M", "2G", "2GB", "1.9GiB", "2e9B"]:
            if self.run(["info", "grid.flt"], "--memory-limit", size)[0] != 0:
                self.fail(f"--memory-limit {size}", "refused")
        # A virtual grid of 40,000 x 40,000 cells: nothing on disk vouches for it, and nothing is read.
        source = self.folder / "grid.flt"
        (self.folder / "huge.vrt").write_text(
            '<VRTDataset rasterXSize="40000" rasterYSize="40000"><GeoTransform>0,1,0,0,0,-1</GeoTransform>'
            '<VRTRasterBand dataType="Float32" band="1"><SimpleSource>'
            f'<SourceFilename relativeToVRT="0">{source}</SourceFilename><SourceBand>1</SourceBand>'
            f'<SrcRect xOff="0" yOff="0" xSize="{self.size}" ySize="{self.size}"/><DstRect xOff="0" yOff="0" xSize="40000" ySize="40000"/>'
            '</SimpleSource></VRTRasterBand></VRTDataset>')
        for words in [["info", "huge.vrt"], ["fit", "huge.vrt", "-o", "o.retalho", "--max-error", "1"],
                      ["contour", "huge.vrt", "-o", "o.gpkg", "--interval", "10"], ["render", "huge.vrt", "-o", "o.png"],
                      ["viewshed", "huge.vrt", "-o", "o.tif", "--observer", "20,-20"], ["compare", "huge.vrt", "--vertices", "100"]]:
            started = time.monotonic()
            code, said, peak = self.run(words, "--memory-limit", "4GB")
            if code != 3 or "40000 x 40000 cells needs about" not in said or peak > 256e6 or time.monotonic() - started > 5:
                self.fail(" ".join(words), f"exit {code}, {peak / 1e6:.0f} MB: {said[-200:]}")
            self.clean(words[0])

    def late(self):
        for name, words in {**UNKNOWN, "a pipe that never speaks": ["info", "pipe"]}.items():
            if "pipe" in words:
                os.mkfifo(self.folder / "pipe")
            started = time.monotonic()
            code, said, _ = self.run(words, "--timeout", "0.3")
            took = time.monotonic() - started
            print(f"{name}: --timeout 0.3 ended after {took:.2f} s")
            if code != 124 or "--timeout" not in said or took > 5:
                self.fail(name, f"--timeout 0.3: exit {code} after {took:.1f} s: {said[-200:]}")
            self.clean(name)
        code, said, _ = self.run(["info", "grid.flt"], "--timeout", "600")
        if code != 0:
            self.fail("--timeout 600", f"exit {code}: {said[-200:]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["limits", "table", "value"])
    parser.add_argument("--program", required=True)
    parser.add_argument("--size", type=int, default=900)
    options = parser.parse_args()
    options.program = os.path.abspath(options.program)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory(prefix="limits-", dir=SCRATCH) as folder:
        stage = Stage(options, pathlib.Path(folder))
        if options.kind == "limits":
            stage.options()
            stage.late()
        print(f"{options.size} x {options.size} cells")
        worst = 0.0
        for name, words in KNOWN.items():
            found = stage.known(name, words)
            if found:
                worst = max(worst, found[1] / found[0])
                print(f"{name}: says {found[0] / 1e6:.0f} MB, held {found[1] / 1e6:.0f} MB ({found[1] / found[0]:.2f})")
        for name, words in SHOWN.items():
            need = stage.need_of(name, words)
            print(f"{name}: says {(need or 0) / 1e6:.0f} MB")
        for name, words in UNKNOWN.items():
            limit, held = stage.unknown(name, words)
            worst = max(worst, held / limit)
            print(f"{name}: stopped at {held / 1e6:.0f} MB by a limit of {limit / 1e6:.0f} MB ({held / limit:.2f})")
    for failure in stage.failures:
        print("FAILED", failure)
    print(f"{len(KNOWN) + len(SHOWN) + len(UNKNOWN)} commands; {len(stage.failures)} failures")
    if options.kind == "value":
        print(json.dumps({"value": round(worst, 2)}))
    return 1 if stage.failures else 0


if __name__ == "__main__":
    sys.exit(main())

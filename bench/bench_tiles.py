#!/usr/bin/python3
"""Tiled models: tiles a second, what a tile costs beside one model of the whole grid, how that grows with the number of
tiles, two jobs and two Dask workers against one, and peak memory.

  bench/bench_tiles.py [--build build/release]              the whole table
  bench/bench_tiles.py --value jobs|dask|overhead|growth|memory|reading|rate    one figure, as {"value": ...}

The grid is N48W125 (3601 x 3601, two thirds of it land) of $RETALHO_DATA as a tiled GeoTIFF, tolerance
2 m. Times are wall time, the better of two runs.
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIZES = {16: 900, 64: 450, 256: 225}


class Bench:
    def __init__(self, build, folder):
        self.build, self.folder = pathlib.Path(build).resolve(), pathlib.Path(folder)
        data = os.environ.get("RETALHO_DATA") or ROOT.parent / "shared" / "data"
        self.dem = pathlib.Path(data).resolve() / "dem" / "N48W125.hgt.zip"
        if not self.dem.exists():
            sys.exit(f"real data missing: {self.dem} (set RETALHO_DATA)")
        # Windows of a zipped grid are read by unpacking all before them: what large grids come as is a tiled GeoTIFF.
        plain = self.folder / "grid.tif"
        subprocess.run(["gdal_translate", "-q", "-co", "TILED=YES", "-co", "COMPRESS=DEFLATE", str(self.dem), str(plain)],
                       check=True)
        self.dem = plain
        self.environment = {**os.environ, "PYTHONPATH": str(self.build / "python")}

    def run(self, command, runs=2):
        """Seconds and peak megabytes of the process; its output folder is made anew each time."""
        best, peak = float("inf"), 0.0
        for _ in range(runs):
            out = self.folder / "out"
            shutil.rmtree(out, ignore_errors=True)
            start = time.monotonic()
            done = subprocess.run(["/usr/bin/time", "-f", "%M", *map(str, command)], capture_output=True, text=True,
                                  env=self.environment)
            best = min(best, time.monotonic() - start)
            if done.returncode:
                sys.exit(done.stderr)
            peak = int(done.stderr.strip().splitlines()[-1]) / 1024
        return best, peak

    def check_count(self, count):
        """The figures are of so many tiles, or of nothing."""
        made = len(json.loads((self.folder / "out" / "index.json").read_text())["tiles"])
        if made != count:
            sys.exit(f"{made} tiles were made, not {count}: is {self.dem} another grid?")

    def fit(self, *options, output="out"):
        return [self.build / "retalho", "fit", self.dem, "-o", self.folder / output, "--max-error", 2, "-q", *options]

    def tiles(self, count, jobs, threads=1):
        figures = self.run(self.fit("--tiles", SIZES[count], "--jobs", jobs, "--threads", threads))
        self.check_count(count)
        return figures

    def dask(self, workers):
        """Without the start of the cluster: seconds of make_tiles itself."""
        code = f"""
import shutil, sys, time, retalho, retalho.dask as d
if __name__ == "__main__":
    client = d.connect(None, {workers})
    client.wait_for_workers({workers})
    plan = retalho.TilePlan({str(self.dem)!r}, size={SIZES[64]}, max_error=2)
    best = 1e9
    for _ in range(2):
        shutil.rmtree({str(self.folder / "dask")!r}, ignore_errors=True)
        start = time.monotonic()
        d.make_tiles(plan, {str(self.folder / "dask")!r}, client)
        best = min(best, time.monotonic() - start)
    cluster = client.cluster
    client.close()
    cluster.close()
    print(best)
"""
        script = self.folder / "bench_dask.py"
        script.write_text(code)
        done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, env=self.environment)
        if done.returncode:
            sys.exit(done.stderr)
        return float(done.stdout)

    def part(self, cells):
        """The south-eastern part of the grid, land, as a VRT."""
        path = self.folder / f"part{cells}.vrt"
        subprocess.run(["gdal_translate", "-q", "-of", "VRT", "-srcwin", str(3601 - cells),
                        str(3601 - cells), str(cells), str(cells),
                        str(self.dem), str(path)], check=True)
        return path

    def figure(self, name):
        if name == "rate":
            return 64 / self.tiles(64, 1)[0]
        if name == "jobs":
            return self.tiles(64, 1)[0] / self.tiles(64, 2, 2)[0]
        if name == "dask":
            return self.dask(1) / self.dask(2)
        if name == "overhead":  # seconds a tile beside one model on one thread
            whole = self.run(self.fit("--threads", 1, output="one.retalho", *["--overwrite"]))[0]
            return (self.tiles(64, 1)[0] - whole) / 64
        if name == "growth":  # time of 256 tiles over that of 16, the same grid
            return self.tiles(256, 1)[0] / self.tiles(16, 1)[0]
        if name == "memory":  # peak of 64 tiles over that of 4 tiles of the same size
            small = [self.build / "retalho", "fit", self.part(901), "-o", self.folder / "out", "--max-error", 2, "-q",
                     "--tiles", SIZES[64], "--jobs", 1, "--threads", 1]
            return self.tiles(64, 1)[1] / self.run(small)[1]
        if name == "reading":  # peak of sampling 64 tiles over that of 4 tiles of the same size, 8 MB of tiles kept
            peaks = []
            for source, count in ((self.dem, 64), (self.part(901), 4)):
                self.run([self.build / "retalho", "fit", source, "-o", self.folder / "out", "--max-error", 2, "-q", "--tiles",
                          SIZES[64]], runs=1)
                self.check_count(count)
                (self.folder / "out").rename(self.folder / f"read{count}")
                peaks.append(self.run([self.build / "retalho", "sample", self.folder / f"read{count}", "-o",
                                       self.folder / "s.tif", "--tile-memory", 8, "--overwrite", "-q", "--threads", 1],
                                      runs=1)[1])
            return peaks[0] / peaks[1]
        sys.exit(f"no figure '{name}'")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=ROOT / "build" / "release")
    parser.add_argument("--value")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options.build, folder)
        if options.value:
            print(json.dumps({"value": bench.figure(options.value)}))
            return
        print(f"{'tiles':>6} {'jobs':>5} {'seconds':>8} {'tiles/s':>8} {'MB':>6}")
        for count, jobs in ((16, 1), (64, 1), (256, 1), (64, 2)):
            seconds, peak = bench.tiles(count, jobs, jobs)
            print(f"{count:6} {jobs:5} {seconds:8.2f} {count / seconds:8.1f} {peak:6.0f}")
        for name in ("overhead", "growth", "jobs", "dask", "memory", "reading"):
            print(f"{name:>9} {bench.figure(name):.3f}")


if __name__ == "__main__":
    main()

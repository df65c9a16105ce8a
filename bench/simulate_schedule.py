#!/usr/bin/python3
"""A country on a cluster: the schedule of retalho.dask simulated from measured tile times (docs/scale.md).

  bench/simulate_schedule.py --measure [-o bench/tile_times.json]   times each task of tiles of real grids, one by one
  bench/simulate_schedule.py                                        the table, from bench/tile_times.json
  bench/simulate_schedule.py --picture docs/images/scale.svg        and the picture
  bench/simulate_schedule.py --workers 100 --storage 10e9 --seed 3  one run

What is simulated: three rounds with a barrier after each (look at heights, triangulate, surface), as retalho.dask has
them. A scheduler hands out one task after another; a worker reads through a stream of its own, within what the storage
gives to all of them (first come, first served), then computes. Some tasks straggle; workers die, their task starts anew
on another one, and they come back. Nothing of this is fitted to an outcome: what was measured and what is assumed stands
in ASSUMED and in the file of times.
"""
import argparse
import heapq
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
TIMES = ROOT / "bench" / "tile_times.json"

ASSUMED = {
    "cells": 1e11,  # 316 km x 316 km at 1 m
    "tile": 2048,  # cells from seam to seam
    "bytes_a_cell": 2.0,  # of the grid in object storage: deflated floats
    "stream": 80e6,  # bytes a second of one worker from object storage
    "latency": 0.05,  # seconds to the first byte, and to put an object
    "straggle_share": 0.01,  # of the tasks
    "straggle_factor": 5.0,
    "days_to_failure": 4.0,  # of a worker: mean, exponential (preempted machines)
    "seconds_back": 120.0,  # until its place is taken
    "seconds_noticed": 30.0,  # until the scheduler knows that a worker is gone
}
ROUNDS = ("look", "tin", "tile")


# Measuring

GRIDS = (("N48W125.hgt.zip", 450, 2.0), ("N44W072.hgt", 240, 2.0), ("dom1_32_356_5699_1_nw_2020.tif", 250, 0.5),
         ("bigtujunga.tif", 250, 2.0))


def measure(path):
    """Seconds and bytes a cell of each task of each tile, by the module in build/release."""
    sys.path.insert(0, os.environ.get("RETALHO_MODULE", str(ROOT / "build" / "release" / "python")))
    import retalho
    data = pathlib.Path(os.environ.get("RETALHO_DATA") or ROOT.parent / "shared" / "data") / "dem"
    result = {"rounds": {name: [] for name in ROUNDS}, "tin_bytes": [], "tile_bytes": [], "grids": [],
              "scheduler": measure_scheduler()}
    for name, size, tolerance in GRIDS:
        source = data / name
        if not source.exists():
            print(f"real data missing: {source}", file=sys.stderr)
            continue
        plan = retalho.TilePlan(source, size=size, max_error=tolerance)
        rows, columns = plan.tiles
        places = [(r, c) for r in range(rows) for c in range(columns)]
        result["grids"].append({"grid": name, "tile": size, "tolerance": tolerance, "tiles": len(places)})
        with tempfile.TemporaryDirectory() as folder:
            tins = []
            cells = (size + 1) ** 2
            for r, c in places:
                start = time.perf_counter()
                tins.append(plan.tin_name(r, c))
                result["rounds"]["look"].append((time.perf_counter() - start) / cells)
            for (r, c), tin in zip(places, tins):
                if not tin:
                    continue
                start = time.perf_counter()
                plan.make_tin(r, c, tin, folder)
                result["rounds"]["tin"].append((time.perf_counter() - start) / cells)
                result["tin_bytes"].append((pathlib.Path(folder) / tin).stat().st_size / cells)
            for (r, c), tin in zip(places, tins):
                if not tin:
                    continue
                start = time.perf_counter()
                entry = plan.make_tile(r, c, plan.around(tins, r, c), folder)
                result["rounds"]["tile"].append((time.perf_counter() - start) / cells)
                result["tile_bytes"].append(entry.bytes / cells)
    for key in ROUNDS:
        result["rounds"][key] = [float(f"{v:.4g}") for v in result["rounds"][key]]
    for key in ("tin_bytes", "tile_bytes"):
        result[key] = [float(f"{v:.4g}") for v in result[key]]
    path.write_text(json.dumps(result) + "\n")
    print(f"{path}: {sum(g['tiles'] for g in result['grids'])} tiles, scheduler {1e3 * result['scheduler']:.2f} ms a task")


def measure_scheduler(tasks=2000):
    """Seconds a task of Dask's scheduler and driver: empty tasks with a plan's worth of arguments."""
    code = f"""
import time, distributed
def nothing(*arguments):
    return None
if __name__ == "__main__":
    cluster = distributed.LocalCluster(n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=None)
    client = distributed.Client(cluster)
    client.gather(client.map(nothing, range(50), pure=False))
    start = time.monotonic()
    client.gather(client.map(nothing, range({tasks}), ["x" * 600] * {tasks}, pure=False, retries=3))
    print((time.monotonic() - start) / {tasks})
    client.close()
    cluster.close()
"""
    with tempfile.TemporaryDirectory() as folder:
        script = pathlib.Path(folder) / "empty.py"
        script.write_text(code)
        done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    return float(f"{float(done.stdout):.3g}")


# Simulating

class Storage:
    """What all workers share: bytes a second, first come, first served."""

    def __init__(self, rate, assumed):
        self.rate, self.stream, self.latency, self.free = rate, assumed["stream"], assumed["latency"], 0.0

    def move(self, now, size, objects=1):
        """When a transfer that begins now ends."""
        self.free = max(self.free, now) + size / self.rate
        return max(now + objects * self.latency + size / self.stream, self.free)


def run_round(name, now, tiles, workers, storage, times, assumed, random_):
    """When the last of `tiles` tasks is done, and how many seconds of work were lost."""
    cells = assumed["tile"] ** 2
    grid_bytes = cells * assumed["bytes_a_cell"]
    tin_bytes = cells * sum(times["tin_bytes"]) / len(times["tin_bytes"])
    tile_bytes = cells * sum(times["tile_bytes"]) / len(times["tile_bytes"])
    reads = {"look": (grid_bytes, 1), "tin": (grid_bytes, 1), "tile": (9 * tin_bytes, 9)}[name]
    writes = {"look": 0.0, "tin": tin_bytes, "tile": tile_bytes}[name]
    rate = 1 / (assumed["days_to_failure"] * 86400)
    free = [(now, w) for w in range(workers)]
    heapq.heapify(free)
    left, again = tiles, []  # again: tasks of lost workers, by when that is noticed
    scheduler, end, lost = now, now, 0.0
    while left > 0 or again:
        at, worker = heapq.heappop(free)
        if again and (left == 0 or again[0] <= at):
            at = max(at, heapq.heappop(again))
        else:
            left -= 1
        # The scheduler and the driver have one thread, and each task passes through it.
        scheduler = max(scheduler, at) + times["scheduler"]
        begun = scheduler
        seconds = random_.choice(times["rounds"][name]) * cells
        if random_.random() < assumed["straggle_share"]:
            seconds *= assumed["straggle_factor"]
        ready = storage.move(begun, *reads)
        done = ready + seconds
        if writes:
            done = max(done + assumed["latency"] + writes / assumed["stream"], done)
        dies = begun + random_.expovariate(rate)
        if dies < done:
            lost += dies - begun
            heapq.heappush(again, dies + assumed["seconds_noticed"])
            heapq.heappush(free, (dies + assumed["seconds_back"], worker))
            continue
        end = max(end, done)
        heapq.heappush(free, (done, worker))
    return end, lost


def simulate(workers, rate, times, assumed=ASSUMED, seed=1):
    random_ = random.Random(seed)
    tiles = math.ceil(assumed["cells"] / assumed["tile"] ** 2)
    storage = Storage(rate, assumed)
    now, lost, rounds = 0.0, 0.0, {}
    for name in ROUNDS:
        start = now
        now, gone = run_round(name, now, tiles, workers, storage, times, assumed, random_)
        rounds[name] = now - start
        lost += gone
    return {"seconds": now, "lost": lost, "rounds": rounds, "tiles": tiles}


def work(times, assumed=ASSUMED):
    """Seconds that one worker computes."""
    tiles = math.ceil(assumed["cells"] / assumed["tile"] ** 2)
    return tiles * assumed["tile"] ** 2 * sum(sum(v) / len(v) for v in times["rounds"].values())


COUNTS = (10, 30, 100, 300, 1000, 3000, 10000)
RATES = (1e9, 10e9, 100e9)


def table(times, runs):
    total = work(times)
    print(f"computing: {total / 3600:.1f} core-hours; tiles: {simulate(10000, 1e12, times)['tiles']}")
    print(f"{'workers':>8} " + " ".join(f"{r / 1e9:>6.0f} GB/s {'busy':>5}" for r in RATES))
    points = {}
    for n in COUNTS:
        line = f"{n:8} "
        for r in RATES:
            seconds = sorted(simulate(n, r, times, seed=s)["seconds"] for s in range(runs))
            middle = seconds[len(seconds) // 2]
            points[n, r] = middle
            line += f" {middle:9.0f} s {100 * total / (n * middle):4.0f} %"
        print(line, flush=True)
    return points


def why(times):
    """Each limit taken away in turn, at the count of workers where it hurts."""
    base = ASSUMED
    for n in (300, 1000, 10000):
        whole = simulate(n, 10e9, times)["seconds"]
        parts = [("storage of 1 TB/s", simulate(n, 1e12, times)["seconds"]),
                 ("scheduler of 0.01 ms", simulate(n, 10e9, {**times, "scheduler": 1e-5})["seconds"]),
                 ("no stragglers", simulate(n, 10e9, times, {**base, "straggle_share": 0})["seconds"]),
                 ("no failures", simulate(n, 10e9, times, {**base, "days_to_failure": 1e6})["seconds"]),
                 ("tiles of 1024", simulate(n, 10e9, times, {**base, "tile": 1024})["seconds"]),
                 ("tiles of 4096", simulate(n, 10e9, times, {**base, "tile": 4096})["seconds"])]
        print(f"{n} workers, 10 GB/s: {whole:.0f} s; " + ", ".join(f"{name} {s:.0f}" for name, s in parts))


def picture(points, times, path):
    """Seconds by workers, both by powers of ten, with what perfect scaling would be."""
    width, height, left, bottom = 640, 420, 70, 50
    total = work(times)
    xs, low, high = (1, 4), 1, 4.5

    def at(n, s):
        x = left + (math.log10(n) - xs[0]) / (xs[1] - xs[0]) * (width - left - 130)
        y = height - bottom - (math.log10(s) - low) / (high - low) * (height - bottom - 20)
        return f"{x:.1f},{y:.1f}"

    colours = {1e9: "#b3432b", 10e9: "#2b5fb3", 100e9: "#2b8a4b"}
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
             'font-size="12">', '<rect width="100%" height="100%" fill="white"/>']
    for k in range(int(low), int(high) + 1):
        x, y = at(10, 10 ** k).split(",")
        lines.append(f'<line x1="{left}" y1="{y}" x2="{width - 130}" y2="{y}" stroke="#ddd"/>'
                     f'<text x="{left - 6}" y="{y}" text-anchor="end" dy="4">{10 ** k} s</text>')
    for k in (1, 2, 3, 4):
        x, _ = at(10 ** k, 10).split(",")
        lines.append(f'<line x1="{x}" y1="20" x2="{x}" y2="{height - bottom}" stroke="#ddd"/>'
                     f'<text x="{x}" y="{height - bottom + 18}" text-anchor="middle">{10 ** k}</text>')
    lines.append(f'<text x="{(width - 60) / 2}" y="{height - 10}" text-anchor="middle">workers</text>')
    perfect = [n for n in COUNTS if total / n >= 10 ** low]
    lines.append('<polyline fill="none" stroke="#999" stroke-dasharray="5 4" points="'
                 + " ".join(at(n, total / n) for n in perfect) + '"/>')
    x, y = at(perfect[-1], total / perfect[-1]).split(",")
    lines.append(f'<text x="{float(x) + 6}" y="{y}" fill="#777">computing alone</text>')
    for r, colour in colours.items():
        lines.append(f'<polyline fill="none" stroke="{colour}" stroke-width="2" points="'
                     + " ".join(at(n, points[n, r]) for n in COUNTS) + '"/>')
        x, y = at(COUNTS[-1], points[COUNTS[-1], r]).split(",")
        lines.append(f'<text x="{float(x) + 6}" y="{y}" dy="4" fill="{colour}">{r / 1e9:.0f} GB/s</text>')
    lines.append("</svg>")
    path.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=TIMES)
    parser.add_argument("--times", type=pathlib.Path, default=TIMES)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--storage", type=float, default=10e9, help="bytes a second for all workers")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--runs", type=int, default=3, help="of each place in the table; the middle one counts")
    parser.add_argument("--picture", type=pathlib.Path)
    parser.add_argument("--value", choices=["core-hours", "efficiency"], help="one figure, as {\"value\": ...}")
    options = parser.parse_args()
    if options.measure:
        return measure(options.output)
    times = json.loads(options.times.read_text())
    if options.value == "core-hours":
        return print(json.dumps({"value": work(times) / 3600}))
    if options.value == "efficiency":  # of 300 workers on 10 GB/s
        return print(json.dumps({"value": work(times) / 300 / simulate(300, 10e9, times)["seconds"]}))
    if options.workers:
        return print(json.dumps(simulate(options.workers, options.storage, times, seed=options.seed)))
    points = table(times, options.runs)
    why(times)
    if options.picture:
        picture(points, times, options.picture)


if __name__ == "__main__":
    main()

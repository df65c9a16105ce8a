#!/usr/bin/python3
"""Does to every writer of the program what disks and users do, and looks at what is left.

  faults.py disk      the n-th open, write, fsync and rename fails, for every n: non-zero exit, a message, the old output
                      intact, no temporary left. An interrupted or short write may also be overcome: exit 0 and the
                      whole output. The n-th large allocation fails: the same.
  faults.py kills     kill -9 in front of the n-th of these operations, for every n, and at random moments: the output is
                      the old one or the whole new one, and the next run leaves no temporary of the killed one.
  faults.py signals   SIGINT in front of the n-th of these, SIGINT and SIGTERM in the middle of long work: 130, the old
                      output intact, nothing left; or, where it came too late, 0 and the whole output.
  faults.py cancel    of these, the long work alone; the last line is the longest time to the end, as JSON, in seconds.
  faults.py streams   standard output full, closed, and a pipe that nobody reads: non-zero exit.

Options: --program and --library (the preload library), --only WRITER, --every (every n even where there are hundreds;
else the first, the last, and one in eleven between), --random N (kills at random moments a writer; 4, times
RETALHO_SOAK: RETALHO_SOAK=125 makes 500), --seed N (which moments).
"""
import argparse
import concurrent.futures
import itertools
import json
import math
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
OPERATIONS = ["open", "write", "sync", "rename"]
# In memory where there is such a place: thousands of runs, each with its fsync.
SCRATCH = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
# The GeoPackage's time of day is in its bytes; this keeps two runs the same.
ENVIRONMENT = dict(os.environ, OGR_CURRENT_DATE="2000-01-01T00:00:00.000Z")
ENVIRONMENT.pop("LD_PRELOAD", None)


def grid_text(columns, rows):
    lines = [f"ncols {columns}", f"nrows {rows}", "xllcorner 1000", "yllcorner 2000", "cellsize 10", "NODATA_value -9999"]
    for r in range(rows):
        lines.append(" ".join(f"{100 + 60 * math.sin(c * 0.4) * math.cos(r * 0.3) + c:.2f}" for c in range(columns)))
    return "\n".join(lines) + "\n"


def ball_text(count):
    """Points of a bumpy ball with their rough normals, on a spiral."""
    lines = []
    for i in range(count):
        z = 1 - (2 * i + 1) / count
        a, r = i * 2.399963229728653, math.sqrt(1 - z * z)
        s = 1 + 0.1 * math.sin(9 * z + 5 * a)
        n = (r * math.cos(a), r * math.sin(a), z)
        lines.append(" ".join(f"{v:.5f}" for v in (*(s * x for x in n), *n)))
    return "\n".join(lines) + "\n"


def inputs(program, folder):
    """What the writers start from, made once."""
    (folder / "grid.asc").write_text(grid_text(12, 10))
    (folder / "large.asc").write_text(grid_text(700, 600))
    for name in ["patches/octant.json", "tetraquads/sphere.json", "curves/bspline.json"]:
        shutil.copy(ROOT / "examples" / name, folder)
    (folder / "ball.xyz").write_text(ball_text(20000))
    (folder / "survey.xyz").write_text("".join(f"{(k * 7919) % 100003 / 10} {(k * 104729) % 99991 / 10} {k % 97 / 2}\n" for k in range(400000)))
    (folder / "wide.vrt").write_text(
        '<VRTDataset rasterXSize="9000" rasterYSize="9000"><GeoTransform>0,1,0,0,0,-1</GeoTransform><VRTRasterBand dataType="Float32" band="1">'
        f'<SimpleSource><SourceFilename>{folder / "large.asc"}</SourceFilename><SrcRect xOff="0" yOff="0" xSize="700" ySize="600"/>'
        '<DstRect xOff="0" yOff="0" xSize="9000" ySize="9000"/></SimpleSource></VRTRasterBand></VRTDataset>')
    for words in [["fit", "grid.asc", "-o", "terrain.retalho", "--max-error", "0"],
                  ["fit", "large.asc", "-o", "large.retalho", "--max-error", "0.01", "--refine", "flat"],
                  ["patch", "octant.json", "-o", "octant.retalho", "--divisions", "200"],
                  ["reconstruct", "ball.xyz", "-o", "ball.retalho", "--resolution", "24", "--fit", "local"]]:
        subprocess.run([program, *words, "-q"], cwd=folder, check=True, stdout=subprocess.DEVNULL)


# A writer: its command, and its outputs. The first is the file itself; the others are parts that belong to it.
WRITERS = {
    "fit": (["fit", "grid.asc", "--max-error", "1"], ["o.retalho"]),
    "sample-tif": (["sample", "terrain.retalho"], ["o.tif"]),
    "sample-asc": (["sample", "terrain.retalho"], ["o.asc"]),
    "contour-gpkg": (["contour", "grid.asc", "--interval", "40"], ["o.gpkg"]),
    "contour-geojson": (["contour", "grid.asc", "--interval", "40"], ["o.geojson"]),
    "contour-shp": (["contour", "grid.asc", "--interval", "40"], ["o.shp", "o.dbf", "o.shx"]),
    "contour-dxf": (["contour", "grid.asc", "--interval", "40"], ["o.dxf"]),
    "bands-gpkg": (["contour", "grid.asc", "--interval", "90", "--bands"], ["o.gpkg"]),
    "mesh-ply": (["mesh", "terrain.retalho"], ["o.ply"]),
    "mesh-obj": (["mesh", "terrain.retalho"], ["o.obj"]),
    "mesh-stl": (["mesh", "terrain.retalho"], ["o.stl"]),
    "mesh-glb": (["mesh", "terrain.retalho"], ["o.glb"]),
    "render": (["render", "grid.asc", "--size", "90x80"], ["o.png"]),
    "viewshed": (["viewshed", "grid.asc", "--observer", "1050,2050,10"], ["o.tif"]),
    "intervisibility": (["viewshed", "grid.asc", "--intervisibility", "--directions", "8"], ["o.tif"]),
    "curve-svg": (["curve", "bspline.json"], ["o.svg"]),
    "curve-pdf": (["curve", "bspline.json"], ["o.pdf"]),
    "curve-png": (["curve", "bspline.json"], ["o.png"]),
    "curve-json": (["curve", "bspline.json", "--convert", "bezier"], ["o.json"]),
    "curve-gpkg": (["curve", "bspline.json", "--flatten", "0.1"], ["o.gpkg"]),
    "curve-geojson": (["curve", "bspline.json", "--flatten", "0.1"], ["o.geojson"]),
    "curve-shp": (["curve", "bspline.json", "--flatten", "0.1"], ["o.shp", "o.dbf", "o.shx"]),
    "curve-dxf": (["curve", "bspline.json", "--flatten", "0.1"], ["o.dxf"]),
    "patch-retalho": (["patch", "octant.json", "--divisions", "6"], ["o.retalho"]),
    "patch-png": (["patch", "octant.json", "--divisions", "6", "--size", "80x60"], ["o.png"]),
    "reconstruct": (["reconstruct", "sphere.json"], ["o.retalho"]),
}


class Check:
    """One writer in a folder of its own."""

    def __init__(self, options, stock, name):
        self.options, self.name = options, name
        self.words, self.outputs = WRITERS[name]
        self.home = pathlib.Path(tempfile.mkdtemp(prefix=f"faults-{name}-", dir=SCRATCH)).resolve()
        self.out = self.home / "out"
        self.out.mkdir()
        for file in stock.iterdir():
            (self.home / file.name).symlink_to(file)
        self.failures, self.runs, self.overcome = [], 0, 0
        self.reset(old=False)
        done = self.run()
        if done.returncode != 0:
            raise SystemExit(f"{name}: the plain run fails: {done.stderr}")
        self.new = self.files()
        if sorted(self.new) != sorted(self.outputs):
            raise SystemExit(f"{name}: the plain run makes {sorted(self.new)}, not {self.outputs}")
        self.counts = self.logged()

    def close(self):
        shutil.rmtree(self.home, ignore_errors=True)

    def command(self):
        return [self.options.program, *self.words, "-o", str(self.out / self.outputs[0]), "--overwrite", "--threads", "1"]

    def environment(self, fault=None):
        log = self.home / "log"
        log.unlink(missing_ok=True)
        added = {"LD_PRELOAD": self.options.library, "RETALHO_FAULT_FOLDER": str(self.out), "RETALHO_FAULT_LOG": str(log)}
        if fault:
            added["RETALHO_FAULT"] = fault
        return {**ENVIRONMENT, **added}

    def run(self, fault=None, preload=True):
        self.runs += 1
        return subprocess.run(self.command(), cwd=self.home, env=self.environment(fault) if preload else ENVIRONMENT,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace", timeout=120)

    def logged(self):
        log = self.home / "log"
        lines = log.read_text().split("\n") if log.exists() else []
        return {k: int(v) for k, v in (line.split() for line in lines if line)}

    def reset(self, old):
        for file in self.out.iterdir():
            file.unlink()
        self.old = {name: b"the old " + name.encode() for name in self.outputs} if old else {}
        for name, content in self.old.items():
            (self.out / name).write_bytes(content)

    def files(self):
        found = {}
        for file in sorted(self.out.iterdir()):
            content = file.read_bytes()
            # A .dbf has the day of its making in it.
            found[file.name] = content[:1] + content[4:] if file.suffix == ".dbf" and content[:4] != b"the " else content
        return found

    def fail(self, fault, why):
        left = {name: len(content) for name, content in self.files().items()}
        self.failures.append(f"{self.name}, {fault}: {why}; in the folder: {left}")

    def numbers(self, operation, first=20):
        """All of 1..count, or a sample of a long list that keeps both ends."""
        count = self.counts[operation]
        every = range(1, count + 1)
        if self.options.every:
            return list(every)
        return [n for n in every if n <= first or n % 11 == 0 or n > count - 3]

    def look(self, fault, done, may_succeed):
        """A failed run must leave the old; a run that succeeds in spite of a fault must leave the new."""
        if "fault" not in self.logged():
            return self.fail(fault, "the fault did not happen")
        if done.returncode == 0:
            self.overcome += 1
            if not may_succeed:
                return self.fail(fault, "exit 0")
            if self.files() != self.new:
                return self.fail(fault, "exit 0 without the whole output")
            return None
        if done.returncode < 0:
            return self.fail(fault, f"ended by signal {-done.returncode}: {done.stderr[-200:]}")
        if "retalho: " not in done.stderr:
            return self.fail(fault, f"exit {done.returncode} without a message")
        if self.files() != self.old:
            return self.fail(fault, f"exit {done.returncode}, and the old output is not as it was")
        return None

    def disk(self):
        plans = [("open", "ENOSPC", "on"), ("write", "ENOSPC", "on"), ("write", "EIO", "once"), ("write", "SHORT", "once"),
                 ("write", "EINTR", "once"), ("sync", "EIO", "once"), ("sync", "EINTR", "once"), ("rename", "EIO", "once")]
        for (operation, error, how), old in itertools.product(plans, [True, False]):
            if not old and (operation != "rename" or error != "EIO"):
                continue
            for n in self.numbers(operation, 20 if error == "ENOSPC" else 4):
                fault = f"{operation}:{n}:{error}:{how}"
                self.reset(old)
                self.look(fault, self.run(fault), error in ("EINTR", "SHORT"))
        self.allocations()

    def allocations(self):
        """Of 64 KB and more, each once: those are the ones that a full memory refuses."""
        self.reset(old=True)
        self.run("alloc:1000000000:ENOSPC:once")
        count = self.logged().get("alloc", 0)
        for n in range(1, min(count, 1000 if self.options.every else 12) + 1):
            fault = f"alloc:{n}:ENOSPC:once"
            self.reset(old=True)
            self.look(fault, self.run(fault), True)

    def look_killed(self, fault):
        """The old set, the new set, or no file of that name: never a mixture."""
        found = {name: content for name, content in self.files().items() if not name.startswith(".")}
        whole = found in (self.old, self.new)
        if not whole and (len(self.outputs) == 1 or self.outputs[0] in found):
            self.fail(fault, "torn")
        done = self.run(preload=False)
        if done.returncode != 0 or self.files() != self.new:
            self.fail(fault, f"the next run: exit {done.returncode}")

    def kills(self):
        for operation in OPERATIONS:
            for n in self.numbers(operation, 6):
                fault = f"{operation}:{n}:KILL:once"
                self.reset(old=True)
                if self.run(fault).returncode != -signal.SIGKILL:
                    self.fail(fault, "not killed")
                self.look_killed(fault)
        self.random_kills()

    def random_kills(self):
        started = time.monotonic()
        self.run(preload=False)
        usual = time.monotonic() - started
        draw = random.Random(f"{self.options.seed} {self.name}")
        for k in range(self.options.random):
            self.reset(old=True)
            self.runs += 1
            with subprocess.Popen(self.command(), cwd=self.home, env=ENVIRONMENT, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL) as child:
                time.sleep(draw.uniform(0, 1.1 * usual))
                child.kill()
            self.look_killed(f"random kill {k}")

    def signals(self):
        for operation in OPERATIONS:
            numbers = self.numbers(operation)
            for n in numbers if self.options.every else {*numbers[:2], *numbers[-1:]}:
                fault = f"{operation}:{n}:INT:once"
                self.reset(old=True)
                done = self.run(fault)
                if done.returncode == 0:
                    self.overcome += 1
                    if self.files() != self.new:
                        self.fail(fault, "exit 0 without the whole output")
                elif done.returncode != 130 or self.files() != self.old:
                    self.fail(fault, f"exit {done.returncode}: {done.stderr[-200:]}")


def report(failures, words):
    for failure in failures[:400]:
        print("FAILED", failure)
    print(f"{words}; {len(failures)} failures")
    return 1 if failures else 0


def said(options, stock):
    """What is said where memory ends while a file is being read, whatever allocation that happens at."""
    failures = []
    for file in ["large.asc", "survey.xyz"]:
        words = []
        for n in range(1, 12):
            done = subprocess.run([options.program, "info", file], cwd=stock, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace",
                                  env={**ENVIRONMENT, "LD_PRELOAD": options.library, "RETALHO_FAULT_FOLDER": str(stock), "RETALHO_FAULT": f"alloc:{n}:ENOSPC:once"})
            words.append(f"{done.returncode} {done.stderr}")
        if not any(w.startswith("3 ") and f"'{file}' does not fit into memory" in w for w in words):
            failures.append(f"info {file} without memory: {words}")
    return failures


def per_writer(options, stock):
    """disk, kills, signals: one thread a writer, as many at a time as there are cores."""

    def work(name):
        check = Check(options, stock, name)
        try:
            getattr(check, options.kind)()
        finally:
            check.close()
        return check

    names = [name for name in WRITERS if not options.only or name in options.only]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        checks = list(pool.map(work, names))
    failures = [failure for check in checks for failure in check.failures]
    if options.kind == "disk" and not options.only:
        failures += said(options, stock)
    if options.kind == "signals" and not options.only:
        failures += long_work(options, stock)[0]
    runs, overcome = sum(check.runs for check in checks), sum(check.overcome for check in checks)
    return report(failures, f"{len(checks)} writers, {runs} runs, {overcome} went through in spite of it")


# Work of seconds, in loops that are not each other's.
LONG_WORK = {
    "info": ["info", "wide.vrt"],
    "fit": ["fit", "large.asc", "-o", "o.retalho", "--max-error", "0.0001", "--refine", "flat"],
    "fit --refine surface": ["fit", "large.asc", "-o", "o.retalho", "--refine", "surface", "--max-error", "0.001"],
    "fit --fit least-squares": ["fit", "large.asc", "-o", "o.retalho", "--fit", "least-squares", "--max-error", "0.01", "--refine", "flat"],
    "fit --format compact": ["fit", "large.asc", "-o", "o.retalho", "--format", "compact", "--max-error", "0.01"],
    "fit, points": ["fit", "survey.xyz", "-o", "o.retalho"],
    "fit --tiles": ["fit", "large.asc", "-o", "tiles", "--tiles", "100", "--max-error", "0.0001"],
    "compare": ["compare", "large.asc", "--max-error", "0.01"],
    "compare --visibility": ["compare", "large.asc", "large.retalho", "--visibility", "0"],
    "contour": ["contour", "large.asc", "-o", "o.gpkg", "--interval", "0.02"],
    "contour, model": ["contour", "large.retalho", "-o", "o.gpkg", "--interval", "0.02"],
    "contour, sheet": ["contour", "large.asc", "-o", "o.pdf", "--interval", "0.1", "--bands", "--curves"],
    "viewshed": ["viewshed", "large.asc", "-o", "o.tif", "--intervisibility"],
    "viewshed --exact": ["viewshed", "large.retalho", "-o", "o.tif", "--exact", "--observer", "4000,5000,30"],
    "sample": ["sample", "large.retalho", "-o", "o.tif", "--resolution", "0.5"],
    "mesh": ["mesh", "large.retalho", "-o", "o.ply", "--tolerance", "0.000001"],
    "mesh, patches": ["mesh", "octant.retalho", "-o", "o.ply", "--tolerance", "1e-9"],
    "mesh, TetraQuad": ["mesh", "ball.retalho", "-o", "o.ply", "--tolerance", "1e-9"],
    "render": ["render", "large.retalho", "-o", "o.png", "--size", "20000x16000"],
    "render --view perspective": ["render", "large.retalho", "-o", "o.png", "--view", "perspective", "--size", "20000x20000"],
    "render, TetraQuad": ["render", "ball.retalho", "-o", "o.png", "--size", "8000x8000"],
    "render, patches": ["render", "octant.retalho", "-o", "o.png", "--size", "8000x8000"],
    "patch": ["patch", "octant.json", "-o", "o.retalho", "--divisions", "900"],
    "curve": ["curve", "bspline.json", "-o", "o.gpkg", "--flatten", "1e-13"],
    "reconstruct": ["reconstruct", "ball.xyz", "-o", "o.retalho", "--resolution", "40"],
    "reconstruct --fit cg": ["reconstruct", "ball.xyz", "-o", "o.retalho", "--resolution", "60", "--fit", "cg"],
    "reconstruct --adaptive": ["reconstruct", "ball.xyz", "-o", "o.retalho", "--adaptive", "200000"],
}


def until_it_listens(pid):
    """Until the process catches SIGINT: on a busy machine the loader alone may take longer than the wait."""
    for _ in range(1000):
        try:
            caught = re.search(r"SigCgt:\t([0-9a-f]+)", pathlib.Path(f"/proc/{pid}/status").read_text())
        except OSError:
            return
        if caught and int(caught[1], 16) >> (signal.SIGINT - 1) & 1:
            return
        time.sleep(0.005)


def long_work(options, stock):
    """SIGINT and SIGTERM in the middle of work that takes seconds."""
    failures, longest = [], 0.0
    for name, words in LONG_WORK.items():
        for number in (signal.SIGINT, signal.SIGTERM):
            for wait in (0.35,) if number == signal.SIGTERM else (0.35, 0.9):
                with tempfile.TemporaryDirectory(prefix="faults-long-", dir=SCRATCH) as folder:
                    words = [str(stock / w) if (stock / w).exists() else w for w in words]
                    started = time.monotonic()
                    with subprocess.Popen([options.program, *words, "-q"], cwd=folder, env=ENVIRONMENT,
                                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as child:
                        until_it_listens(child.pid)
                        time.sleep(wait)
                        if child.poll() is not None:
                            if wait < 0.5:
                                failures.append(f"{name}: done after {wait} s (exit {child.returncode}); the test wants longer work")
                            continue
                        asked = time.monotonic()
                        child.send_signal(number)
                        words_said = child.stderr.read()
                        code = child.wait(timeout=60)
                    late, left = time.monotonic() - asked, sorted(os.listdir(folder))
                    longest = max(longest, late)
                    print(f"{name}, {number.name} after {asked - started:.2f} s: ended {1000 * late:.0f} ms later")
                    if "--tiles" in words:  # what is done is kept: the next run goes on
                        left = [file for file in left if file != "tiles"]
                    if code != 130 or left or "interrupted" not in words_said:
                        failures.append(f"{name}, {number.name}: exit {code}, left {left}: {words_said[-200:]}")
                    if late > 2:  # 0.2 s on a machine with nothing else to do
                        failures.append(f"{name}, {number.name}: stopped only after {late:.1f} s")
    print(f"longest: {1000 * longest:.0f} ms")
    return failures, longest


def streams(options, stock):
    commands = [["--help"], ["--version"], ["info", "grid.asc"], ["fit", "grid.asc", "-o", "{o}.retalho"],
                ["compare", "grid.asc", "terrain.retalho"], ["sample", "terrain.retalho", "--at", "1050,2050"],
                ["contour", "grid.asc", "-o", "{o}.gpkg", "--interval", "40"], ["mesh", "terrain.retalho", "-o", "{o}.ply"],
                ["render", "grid.asc", "-o", "{o}.png", "--size", "90x80"],
                ["viewshed", "grid.asc", "-o", "{o}.tif", "--observer", "1050,2050,10"],
                ["viewshed", "grid.asc", "--observer", "1050,2050,10", "--to", "1020,2020"],
                ["curve", "bspline.json"], ["patch", "octant.json", "--divisions", "6"], ["reconstruct", "sphere.json", "-o", "{o}.retalho"]]
    failures, runs = [], 0
    with tempfile.TemporaryDirectory(prefix="faults-streams-", dir=SCRATCH) as folder:
        for words, as_json in itertools.product(commands, [False, True]):
            words = [w.replace("{o}", f"{folder}/o") for w in words] + (["--json"] if as_json and len(words) > 1 else [])
            for how in ["full", "closed", "pipe"]:
                for file in pathlib.Path(folder).iterdir():
                    file.unlink()
                runs += 1
                plain = subprocess.run([options.program, *words], cwd=stock, env=ENVIRONMENT, capture_output=True, check=False)
                if not plain.stdout:
                    continue  # only words on standard error: nothing to lose
                for file in pathlib.Path(folder).iterdir():
                    file.unlink()
                if how == "full":
                    with open("/dev/full", "wb") as out:
                        done = subprocess.run([options.program, *words], cwd=stock, env=ENVIRONMENT, stdout=out, stderr=subprocess.PIPE)
                elif how == "closed":
                    done = subprocess.run(["/bin/sh", "-c", 'exec "$0" "$@" >&-', options.program, *words], cwd=stock,
                                          env=ENVIRONMENT, stderr=subprocess.PIPE)
                else:
                    read_end, write_end = os.pipe()
                    os.close(read_end)
                    done = subprocess.run([options.program, *words], cwd=stock, env=ENVIRONMENT, stdout=write_end, stderr=subprocess.PIPE)
                    os.close(write_end)
                if done.returncode != 5 or b"cannot write to standard output: " not in done.stderr:
                    failures.append(f"{' '.join(words)}, {how}: exit {done.returncode}: {done.stderr[-200:]}")
    return report(failures, f"{runs} runs")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=["disk", "kills", "signals", "cancel", "streams"])
    parser.add_argument("--program", required=True)
    parser.add_argument("--library", required=True)
    parser.add_argument("--only", action="append")
    parser.add_argument("--every", action="store_true")
    parser.add_argument("--random", type=int, default=4 * int(os.environ.get("RETALHO_SOAK", "1")))
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    options.program, options.library = os.path.abspath(options.program), os.path.abspath(options.library)
    with tempfile.TemporaryDirectory(prefix="faults-stock-", dir=SCRATCH) as folder:
        stock = pathlib.Path(folder).resolve()
        inputs(options.program, stock)
        if options.kind == "cancel":
            failures, longest = long_work(options, stock)
            code = report(failures, f"{len(LONG_WORK)} commands")
            print(json.dumps({"value": round(longest, 3)}))
            return code
        return streams(options, stock) if options.kind == "streams" else per_writer(options, stock)


if __name__ == "__main__":
    sys.exit(main())

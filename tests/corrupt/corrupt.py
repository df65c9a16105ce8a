#!/usr/bin/python3
"""Bad files for every reader, each put through the program.

A file that must be refused: exit 3 or 4, a message that names the file and (in --json) a place where the format has
places, no output, less than a second of processor time, less than 256 MB. A file whose fault may leave it sound (a
flipped digit): the same, or exit 0 with the output there.

  corrupt.py --program PATH [--only READER] [--keep FOLDER]
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile

import corpus

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRATCH = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
SECONDS, BYTES = 1.0, 256 << 20
ADDRESSES = 8 << 30  # so that an allocation of what a header claims fails, and shows as exit 1


def readers(stock):
    """Reader: (ending, commands of the program, files)."""
    terrain, surface, quads = ((stock / n).read_bytes() for n in ("terrain.retalho", "surface.retalho", "quads.retalho"))
    fit = [["fit", "{}", "-o", "out.retalho"]]
    return {
        "pgm": (".pgm", fit, corpus.pgm()),
        "asc": (".asc", fit, corpus.asc()),
        "tif": (".tif", [["fit", "{}", "-o", "out.retalho"]], corpus.tif()),
        "vrt": (".vrt", [["contour", "{}", "-o", "out.gpkg", "--interval", "5"]], corpus.vrt()),
        "xyz": (".xyz", fit, corpus.xyz()),
        "ply-points": (".ply", [["reconstruct", "{}", "-o", "out.retalho", "--resolution", "8"]], corpus.ply_points()),
        "ply-mesh": (".ply", [["patch", "{}", "-o", "out.retalho"]], corpus.ply_mesh()),
        "obj": (".obj", [["patch", "{}", "-o", "out.retalho"]], corpus.obj()),
        "curve-json": (".json", [["curve", "{}", "-o", "out.svg"]], corpus.curve_json()),
        "patch-json": (".json", [["patch", "{}", "-o", "out.retalho"]], corpus.patch_json()),
        "quadric-json": (".json", [["reconstruct", "{}", "-o", "out.retalho"]], corpus.quadric_json((ROOT / "examples/tetraquads/jump.json").read_bytes())),
        "terrain-model": (".retalho", [["sample", "{}", "-o", "out.tif"]], corpus.model(terrain)),
        "patch-model": (".retalho", [["mesh", "{}", "-o", "out.ply"]], corpus.model(surface)),
        "tetraquad-model": (".retalho", [["mesh", "{}", "-o", "out.ply"]], corpus.model(quads)),
        "svg": (".svg", [["curve", "{}", "-o", "out.pdf"]], corpus.svg()),
        "geojson": (".geojson", [["curve", "{}", "-o", "out.svg"]], corpus.geojson()),
    }


def make_stock(program, folder):
    grid = "ncols 6\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 10\n" + "".join(" ".join(str(100 + c * r) for c in range(6)) + "\n" for r in range(5))
    (folder / "grid.asc").write_text(grid)
    for words in (["fit", "grid.asc", "-o", "terrain.retalho", "--max-error", "0"],
                  ["patch", str(ROOT / "examples/patches/octant.json"), "-o", "surface.retalho", "--divisions", "4"],
                  ["reconstruct", str(ROOT / "examples/tetraquads/sphere.json"), "-o", "quads.retalho"]):
        subprocess.run([program, *words, "-q"], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def limit():
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
    resource.setrlimit(resource.RLIMIT_CPU, (20, 20))


def run(program, command, folder):
    """Exit code, the two outputs, processor seconds and peak bytes of one run."""
    with open(folder / ".stdout", "wb+") as out, open(folder / ".stderr", "wb+") as err:
        child = subprocess.Popen([program, *command, "--json", "--threads", "1"], cwd=folder, stdout=out, stderr=err, preexec_fn=limit)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        return child.returncode, out.read().decode(errors="replace"), err.read().decode(errors="replace"), usage.ru_utime + usage.ru_stime, usage.ru_maxrss << 10


def judge(file, must_refuse, code, out, err, seconds, peak, made):
    """What is wrong with this run; nothing where it is as promised."""
    if seconds > SECONDS:
        return f"{seconds:.1f} s"
    if peak > BYTES:
        return f"{peak / 1e6:.0f} MB"
    if code == 0 and not must_refuse:
        return "" if made else "exit 0 without the output"
    if code not in (3, 4):
        return f"exit {code}"
    if made:
        return f"exit {code}, and {made} is left"
    try:
        error = json.loads(out)["error"]
    except (ValueError, KeyError):
        return "no JSON error object"
    if file not in err or error.get("file") != file:
        return f"the message does not name the file (file: {error.get('file')})"
    if len(error["message"]) < 25:
        return "hardly a message"
    return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--only")
    parser.add_argument("--keep", help="leave the files in this folder")
    parser.add_argument("-v", action="store_true", help="print every message")
    options = parser.parse_args()
    program = os.path.abspath(options.program)
    failures, refused, sound, placed, slowest, largest = [], 0, 0, 0, 0.0, 0
    with tempfile.TemporaryDirectory(prefix="corrupt-", dir=SCRATCH) as scratch:
        stock = pathlib.Path(scratch) / "stock"
        stock.mkdir()
        make_stock(program, stock)
        jobs = []
        for reader, (ending, commands, files) in readers(stock).items():
            if options.only and reader != options.only:
                continue
            for name, data, must_refuse in files:
                for k, command in enumerate(commands):
                    jobs.append((reader, f"{name}{ending}", data, must_refuse, command, pathlib.Path(scratch) / f"{reader}-{name}-{k}"))

        def work(job):
            reader, file, data, must_refuse, command, folder = job
            folder.mkdir()
            shutil.copy(stock / "grid.asc", folder)
            (folder / file).write_bytes(data)
            before = set(os.listdir(folder))
            code, out, err, seconds, peak = run(program, [w.replace("{}", file) for w in command], folder)
            made = sorted(set(os.listdir(folder)) - before - {".stdout", ".stderr"})
            if options.keep:
                target = pathlib.Path(options.keep) / reader
                target.mkdir(parents=True, exist_ok=True)
                (target / file).write_bytes(data)
            shutil.rmtree(folder)
            return reader, file, code, out, err, seconds, peak, judge(file, must_refuse, code, out, err, seconds, peak, made)

        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            for reader, file, code, out, err, seconds, peak, wrong in pool.map(work, jobs):
                refused += code in (3, 4)
                sound += code == 0
                placed += '"where"' in out
                slowest, largest = max(slowest, seconds), max(largest, peak)
                if options.v or wrong:
                    place = "" if code == 0 or '"where"' in out else " (no place)"
                    line = err.strip().split("\n")[-1][:230] if err.strip() else "no words"
                    print(f"{'FAILED ' if wrong else ''}{reader} {file}: {wrong or code} | {line}{place}")
                if wrong:
                    failures.append(file)
    print(f"{len(jobs)} files: {refused} refused, {placed} of them with a place, {sound} were sound; at most {slowest:.2f} s and {largest / 1e6:.0f} MB; {len(failures)} failures")
    if not options.only and refused < 300:
        print("FAILED: fewer than 300 files were refused")
        return 1
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())

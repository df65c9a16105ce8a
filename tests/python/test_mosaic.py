"""64 tiles of a real mosaic: the same bytes by one process, two jobs, two Dask workers, two machines; seams; deaths; memory."""
from __future__ import annotations

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from test_tiles import Cluster, clusters, die_half_way, digest, finish, lose_a_worker, sweep

import retalho

Find = Callable[[str], pathlib.Path]
SIZE, ERROR = 150, 0.6
OPTIONS = ["--tiles", str(SIZE), "--max-error", str(ERROR), "--surface", "powell-sabin", "--fit", "least-squares"]
__all__ = ["clusters"]  # the fixture, used below by its name


@pytest.fixture
def mosaic(tmp_path: pathlib.Path, data: Find) -> pathlib.Path:
    """1201 x 1201 cells across the meridian that two SRTM grids share, as a VRT of both."""
    path = tmp_path / "mosaic.vrt"
    both = tmp_path / "both.vrt"
    subprocess.run(["gdalbuildvrt", "-q", both, data("dem/N53E027.hgt.zip"), data("dem/N53E028.hgt.zip")], check=True)
    subprocess.run(["gdal_translate", "-q", "-of", "VRT", "-srcwin", "600", "0", "1201", "1201", both, path], check=True)
    return path


def plan_of(mosaic: pathlib.Path) -> retalho.TilePlan:
    return retalho.TilePlan(mosaic, size=SIZE, max_error=ERROR, surface="powell-sabin", fit="least-squares")


def drive(mosaic: pathlib.Path, folder: pathlib.Path, address: str, *before: str) -> subprocess.Popen[str]:
    return subprocess.Popen([*before, sys.executable, "-m", "retalho.dask", str(mosaic), "-o", str(folder), *OPTIONS,
                             "--scheduler", address], stderr=subprocess.PIPE, text=True)


def peak_megabytes(process: subprocess.Popen[bytes]) -> float:
    """The most memory that a running process has had."""
    for line in pathlib.Path(f"/proc/{process.pid}/status").read_text().splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1024
    raise AssertionError("no VmHWM")


def check_seams(folder: pathlib.Path) -> None:
    """Heights and gradients of all vertices that tiles share, tile by tile, to the last bit."""
    names = sorted(folder.glob("tile-*.retalho"))
    assert len(names) == 64
    seen: dict[tuple[int, int], bytes] = {}
    shared = 0
    for name in names:
        row, column = (int(k) for k in name.name.split("-")[1:3])
        tile = retalho.load(name)
        assert isinstance(tile, retalho.Terrain)
        assert tile.shape is not None and tile.transform is not None
        rows, columns = tile.shape
        width, height = tile.transform[0], -tile.transform[4]
        x = (tile.vertices[:, 0] - tile.transform[2]) / width - 0.5
        y = (tile.transform[5] - tile.vertices[:, 1]) / height - 0.5
        c, r = np.rint(x).astype(int), np.rint(y).astype(int)
        assert np.abs(x - c).max() < 1e-3 and np.abs(y - r).max() < 1e-3
        border = (c == 0) | (r == 0) | (c == columns - 1) | (r == rows - 1)
        for k in np.flatnonzero(border):
            place = (row * SIZE + int(r[k]), column * SIZE + int(c[k]))
            words = tile.vertices[k, 2].tobytes() + tile.vertex_gradients[k].tobytes()
            shared += place in seen
            assert seen.setdefault(place, words) == words, place
    assert shared > 2000


def test_the_same_bytes_by_anyone(
        mosaic: pathlib.Path, tmp_path: pathlib.Path, program: pathlib.Path,
        clusters: Callable[[int], Cluster]) -> None:
    plan = plan_of(mosaic)
    assert plan.tiles == (8, 8)
    plan.make(tmp_path / "one", jobs=1, threads=1)
    expected = digest(tmp_path / "one")
    check_seams(tmp_path / "one")
    joined = retalho.load(tmp_path / "one")
    assert isinstance(joined, retalho.Terrain) and joined.gradients == "fitted"
    report = joined.compare(retalho.read_grid(mosaic))
    assert report.uncovered == 0 and report.rmse < ERROR
    subprocess.run([program, "fit", mosaic, "-o", tmp_path / "jobs", *OPTIONS, "--jobs", "2", "-q"], check=True,
                   capture_output=True)
    assert digest(tmp_path / "jobs") == expected

    # Two workers, and how much memory they took: their own of Python and Dask, and a tile's.
    cluster = clusters(2)
    finish(drive(mosaic, tmp_path / "idle", cluster.address))
    peaks = [peak_megabytes(worker) for worker in cluster.workers]
    assert digest(tmp_path / "idle") == expected
    limit = 200 + 9 * 400 * (SIZE + 1) ** 2 / 2**20  # docs/tiles.md: nine triangulations; a fitted tile's 2 kB a vertex
    print(f"peak memory of the workers: {peaks[0]:.0f} and {peaks[1]:.0f} MB, limit {limit:.0f} MB")
    assert max(peaks) < limit

    lose_a_worker(cluster, drive(mosaic, tmp_path / "lost", cluster.address), tmp_path / "lost", 120)
    assert digest(tmp_path / "lost") == expected
    cluster.stop()

    doomed = clusters(2)
    die_half_way(doomed, drive(mosaic, tmp_path / "doomed", doomed.address), tmp_path / "doomed")
    # The program does the rest.
    subprocess.run([program, "fit", mosaic, "-o", tmp_path / "doomed", *OPTIONS, "--jobs", "2", "-q"], check=True,
                   capture_output=True)
    sweep(tmp_path / "doomed")
    assert digest(tmp_path / "doomed") == expected


@pytest.fixture
def machines() -> Iterator[tuple[list[str], list[str]]]:
    """Two network namespaces with a wire between them: the words to put before a command, on each."""
    if shutil.which("ip") is None or os.geteuid() != 0:
        pytest.skip("two network namespaces need root and ip (iproute2)")
    a, b = f"retalho-a{os.getpid()}", f"retalho-b{os.getpid()}"
    wire = [f"rta{os.getpid() % 100000}", f"rtb{os.getpid() % 100000}"]

    def ip(*arguments: str) -> None:
        done = subprocess.run(["ip", *arguments], capture_output=True, text=True)
        if done.returncode:
            pytest.skip(f"two network namespaces cannot be made here: {done.stderr.strip()}")

    try:
        for name in (a, b):
            ip("netns", "add", name)
        ip("link", "add", wire[0], "netns", a, "type", "veth", "peer", "name", wire[1], "netns", b)
        for name, end, address in ((a, wire[0], "10.77.0.1/24"), (b, wire[1], "10.77.0.2/24")):
            ip("-n", name, "addr", "add", address, "dev", end)
            ip("-n", name, "link", "set", end, "up")
            ip("-n", name, "link", "set", "lo", "up")
        yield ["ip", "netns", "exec", a], ["ip", "netns", "exec", b]
    finally:
        for name in (a, b):
            subprocess.run(["ip", "netns", "del", name], capture_output=True)


def test_two_machines(
        mosaic: pathlib.Path, tmp_path: pathlib.Path, machines: tuple[list[str], list[str]]) -> None:
    pytest.importorskip("distributed", reason="python3-distributed is not installed")
    first, second = machines
    running: list[subprocess.Popen[bytes]] = []

    def start(where: list[str], *arguments: str) -> None:
        running.append(subprocess.Popen([*where, sys.executable, "-m", *arguments], cwd=tmp_path,
                                        env={**os.environ, "OMP_NUM_THREADS": "1"}, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL))

    address = "tcp://10.77.0.1:8786"
    try:
        start(first, "distributed.cli.dask_scheduler", "--host", "10.77.0.1", "--port", "8786", "--no-dashboard")
        for where, host in ((first, "10.77.0.1"), (second, "10.77.0.2")):
            start(where, "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard",
                  "--host", host, "--local-directory", str(tmp_path))
        workers = """
import sys
import distributed
with distributed.Client(sys.argv[1], timeout=60) as client:
    client.wait_for_workers(2, timeout=60)
    print(sorted(w["host"] for w in client.scheduler_info()["workers"].values()))
"""
        seen = subprocess.run([*first, sys.executable, "-c", workers, address], capture_output=True, text=True, timeout=120)
        assert seen.stdout.strip() == "['10.77.0.1', '10.77.0.2']", seen.stderr
        begun = time.monotonic()
        driver = drive(mosaic, tmp_path / "two", address, *first)
        words = driver.communicate(timeout=300)[1]
        assert driver.returncode == 0, words
        print(f"two machines: {time.monotonic() - begun:.1f} s")
    finally:
        for process in running:
            process.kill()
            process.wait()
    plan_of(mosaic).make(tmp_path / "one")
    assert digest(tmp_path / "two") == digest(tmp_path / "one")

"""Tiled models: the same bytes from one process, several jobs and Dask workers, also when some of those are killed."""
from __future__ import annotations

import hashlib
import os
import pathlib
import pickle
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator

import hypothesis
import numpy as np
import pytest
from conftest import hills
from hypothesis import strategies as st

import retalho

Find = Callable[[str], pathlib.Path]


def digest(folder: pathlib.Path) -> str:
    whole = hashlib.sha256()
    for path in sorted(folder.iterdir()):
        whole.update(path.name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return whole.hexdigest()


@pytest.fixture
def dem(tmp_path: pathlib.Path) -> pathlib.Path:
    z = hills(98, 131)
    z[20:50, 30:60] = np.nan
    path = tmp_path / "dem.tif"
    retalho.Grid(z, transform=(30, 0, 500000, 0, -30, 4200000), crs="EPSG:32611").write(path)
    return path


def test_a_tiled_model_is_a_model(dem: pathlib.Path, tmp_path: pathlib.Path) -> None:
    plan = retalho.TilePlan(dem, size=40, max_error=1.0)
    assert plan.tiles == (3, 4) and plan.shape == (98, 131)
    assert repr(plan) == ("<retalho.TilePlan 98 x 131 cells in 3 x 4 tiles of 40, clough-tocher, tolerance 1, "
                          "WGS 84 / UTM zone 11N>")
    stages = set()
    plan.make(tmp_path / "t", jobs=2, progress=lambda stage, fraction: stages.add(stage))
    assert stages == {"look", "triangulation", "surface"}
    model = retalho.load(tmp_path / "t")
    assert isinstance(model, retalho.Terrain)
    grid = retalho.read_grid(dem)
    assert model.shape == grid.shape and model.transform == grid.transform
    report = model.compare(grid)
    assert report.uncovered == 0 and report.valid_cells == np.isfinite(grid.heights).sum()
    flat = retalho.TilePlan(dem, size=40, max_error=1.0, surface="linear")
    flat.make(tmp_path / "flat")
    linear = retalho.load(tmp_path / "flat")
    assert isinstance(linear, retalho.Terrain) and linear.compare(grid).violations == 0


def test_tasks_and_jobs_and_the_program_make_the_same_bytes(
        dem: pathlib.Path, tmp_path: pathlib.Path, program: pathlib.Path) -> None:
    plan: retalho.TilePlan = pickle.loads(pickle.dumps(retalho.TilePlan(dem, size=40, max_error=1.0)))
    folder = tmp_path / "tasks"
    folder.mkdir()
    places = [(r, c) for r in range(3) for c in range(4)]
    tins = [plan.tin_name(r, c) for r, c in places]
    flat, tiles = plan.missing(tins, folder)
    assert flat == tiles == list(range(12))
    for k in reversed(flat):
        plan.make_tin(*places[k], tins[k], folder)
    assert plan.missing(tins, folder) == ([], tiles)
    entries = [plan.make_tile(r, c, plan.around(tins, r, c), folder) for r, c in places]
    plan.finish(pickle.loads(pickle.dumps(entries[::-1])), tins, folder)
    assert len(list(folder.iterdir())) == 13
    plan.make(tmp_path / "jobs", jobs=3)
    assert digest(tmp_path / "jobs") == digest(folder)
    subprocess.run([program, "fit", dem, "-o", tmp_path / "cli", "--tiles", "40", "--max-error", "1", "--jobs", "2",
                    "-q"], check=True, capture_output=True)
    assert digest(tmp_path / "cli") == digest(folder)


def test_budgets_and_fits_by_tasks_and_jobs(dem: pathlib.Path, tmp_path: pathlib.Path) -> None:
    places = [(r, c) for r in range(3) for c in range(4)]
    for surface in ("powell-sabin", "clough-tocher"):
        plan = retalho.TilePlan(dem, size=40, ratio=0.08, surface=surface, fit="least-squares")  # type: ignore[arg-type]
        assert not plan.settled and plan.max_error is None and "0.08 of the cells" in repr(plan)
        with pytest.raises(ValueError, match="settle"):
            plan.tin_name(0, 0)
        plan = pickle.loads(pickle.dumps(plan))
        looks = [plan.look(r, c) for r, c in places]
        assert sum(look[1] for look in looks) == np.isfinite(retalho.read_grid(dem).heights).sum()
        asked: list[float] = []

        def count(max_error: float) -> int:
            asked.append(max_error)
            return sum(plan.count(r, c, max_error, plan.areas(looks, r, c)) for r, c in places)

        settled = plan.settle(looks, count)
        assert settled.settled and settled.max_error in asked and len(asked) <= 25
        settled.make(tmp_path / surface)
        plan.make(tmp_path / (surface + "2"), jobs=2)
        assert digest(tmp_path / surface) == digest(tmp_path / (surface + "2"))
        model = retalho.load(tmp_path / surface)
        assert isinstance(model, retalho.Terrain) and model.surface == surface and model.gradients == "fitted"
        budget = round(0.08 * sum(look[1] for look in looks))
        assert 0.95 * budget <= len(model.vertices) <= budget
        assert count(settled.max_error or 0) == len(model.vertices)


@hypothesis.settings(max_examples=12)
@hypothesis.given(rows=st.integers(18, 70), columns=st.integers(18, 70), size=st.integers(16, 40),
                  hole=st.tuples(st.integers(0, 70), st.integers(0, 70), st.integers(0, 25)),
                  surface=st.sampled_from(["linear", "powell-sabin", "clough-tocher"]),
                  fit=st.sampled_from(["interpolate", "least-squares"]))
def test_any_grid_is_whole_in_tiles(
        rows: int, columns: int, size: int, hole: tuple[int, int, int], surface: str, fit: str) -> None:
    """Nothing is uncovered, seams agree (load says so if they do not), and two jobs make what one does."""
    z = hills(rows, columns)
    z[hole[0]:hole[0] + hole[2], hole[1]:hole[1] + hole[2]] = np.nan
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        retalho.Grid(z, transform=(3, 0, 100, 0, -3, 700)).write(folder / "z.tif")
        plan = retalho.TilePlan(folder / "z.tif", size=size, max_error=2.0, surface=surface,  # type: ignore[arg-type]
                                fit=fit)  # type: ignore[arg-type]
        plan.make(folder / "a", jobs=1)
        plan.make(folder / "b", jobs=2)
        assert digest(folder / "a") == digest(folder / "b")
        model = retalho.load(folder / "a")
        assert isinstance(model, retalho.Terrain)
        report = model.compare(z, transform=(3, 0, 100, 0, -3, 700))
        in_tiles = plan.tiles[0] * plan.tiles[1] == len(list((folder / "a").glob("tile-*.retalho")))
        assert report.uncovered == 0 or not in_tiles
        if surface == "linear" and fit == "interpolate":
            assert report.violations == 0
        assert model.mesh(tolerance=1.0).check()["nonmanifold_edges"] == 0


def test_what_is_refused(dem: pathlib.Path, tmp_path: pathlib.Path) -> None:
    with pytest.raises(ValueError, match="16 to 16384, not 5|16 to 16,384|not 5"):
        retalho.TilePlan(dem, size=5, max_error=1)
    with pytest.raises(ValueError, match="surface"):
        retalho.TilePlan(dem, max_error=1, surface="cubic")  # type: ignore[arg-type]
    for wrong in ({}, {"max_error": 1.0, "vertices": 50}, {"vertices": 0}, {"ratio": 1.5}, {"max_error": -1.0}):
        with pytest.raises(ValueError):
            retalho.TilePlan(dem, size=40, **wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="fit"):
        retalho.TilePlan(dem, max_error=1, fit="z-only")  # type: ignore[arg-type]
    with pytest.raises(OSError):
        retalho.TilePlan(tmp_path / "nothing.tif", max_error=1)
    plan = retalho.TilePlan(dem, size=40, max_error=1)
    with pytest.raises(ValueError, match="no tile"):
        plan.tin_name(3, 0)
    with pytest.raises(ValueError, match="nine"):
        plan.make_tile(0, 0, ["a"], tmp_path)
    with pytest.raises(ValueError, match="12"):
        plan.missing(["a"], tmp_path)
    with pytest.raises(OSError, match="index.json"):
        retalho.load(tmp_path)


def free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


class Cluster:
    """A scheduler and workers as processes of their own, on loopback, without nannies that would start them again."""

    def __init__(self, folder: pathlib.Path, workers: int) -> None:
        self.address = f"tcp://127.0.0.1:{free_port()}"
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}

        def start(*arguments: str) -> subprocess.Popen[bytes]:
            return subprocess.Popen([sys.executable, "-m", *arguments], cwd=folder, env=environment,
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

        self.scheduler = start("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port",
                               self.address.rsplit(":", 1)[1], "--no-dashboard")
        self.workers = [start("distributed.cli.dask_worker", self.address, "--nthreads", "1", "--no-nanny",
                              "--no-dashboard", "--host", "127.0.0.1", "--local-directory", str(folder))
                        for _ in range(workers)]

    def stop(self) -> None:
        for process in [*self.workers, self.scheduler]:
            process.kill()
            process.wait()


@pytest.fixture
def clusters(tmp_path: pathlib.Path) -> Iterator[Callable[[int], Cluster]]:
    pytest.importorskip("distributed", reason="python3-distributed is not installed")
    running: list[Cluster] = []

    def start(workers: int) -> Cluster:
        running.append(Cluster(tmp_path, workers))
        return running[-1]

    yield start
    for cluster in running:
        cluster.stop()


def drive(dem: pathlib.Path, folder: pathlib.Path, address: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "retalho.dask", str(dem), "-o", str(folder), "--tiles", "140", "--max-error", "0.02",
         "--scheduler", address], stderr=subprocess.PIPE, text=True)


def sweep(folder: pathlib.Path) -> None:
    """Removes what the killed were writing, under hidden names of their own (docs/tiles.md)."""
    for path in folder.glob(".*"):
        path.unlink()


def wait_for(folder: pathlib.Path, count: int, driver: subprocess.Popen[str]) -> int:
    """Until so many files are made; how many there are."""
    for _ in range(12000):
        made = len(list(folder.glob("*.retalho"))) if folder.exists() else 0
        if made >= count:
            return made
        assert driver.poll() is None, driver.communicate()[1]
        time.sleep(0.005)
    raise AssertionError("nothing is made")


def finish(driver: subprocess.Popen[str]) -> None:
    words = driver.communicate(timeout=300)[1]
    assert driver.returncode == 0, words


def lose_a_worker(cluster: Cluster, driver: subprocess.Popen[str], folder: pathlib.Path, late: int) -> None:
    """One of two workers dies when a fifth of the 128 files is there: the other one does its tasks."""
    made = wait_for(folder, 26, driver)
    cluster.workers[0].send_signal(signal.SIGKILL)
    assert made < late, "it was too late to be a test"
    finish(driver)
    sweep(folder)


def die_half_way(doomed: Cluster, driver: subprocess.Popen[str], folder: pathlib.Path) -> None:
    """Scheduler, workers and driver die when half of the 128 files are there."""
    made = wait_for(folder, 64, driver)
    doomed.stop()
    driver.kill()
    driver.communicate()
    assert not (folder / "index.json").exists() and made < 128
    for path in folder.glob("*.retalho"):
        retalho.load(path)  # nothing torn under a final name


@pytest.fixture
def large(tmp_path: pathlib.Path) -> pathlib.Path:
    """64 tiles that take some time."""
    rng = np.random.default_rng(1)
    z = hills(1121, 1121) + 0.3 * rng.normal(size=(1121, 1121))
    path = tmp_path / "large.tif"
    retalho.Grid(z, transform=(1, 0, 0, 0, -1, 0)).write(path)
    return path


def test_dask_workers_and_their_deaths(
        large: pathlib.Path, tmp_path: pathlib.Path, clusters: Callable[[int], Cluster]) -> None:
    plan = retalho.TilePlan(large, size=140, max_error=0.02)
    assert plan.tiles == (8, 8)
    plan.make(tmp_path / "one", jobs=1)
    expected = digest(tmp_path / "one")

    calm = clusters(2)
    finish(drive(large, tmp_path / "calm", calm.address))
    assert digest(tmp_path / "calm") == expected
    lose_a_worker(calm, drive(large, tmp_path / "lost", calm.address), tmp_path / "lost", 64)
    assert digest(tmp_path / "lost") == expected
    calm.stop()

    doomed = clusters(2)
    folder = tmp_path / "doomed"
    die_half_way(doomed, drive(large, folder, doomed.address), folder)
    assert len(list(folder.glob("tin-*.retalho"))) >= 60
    second = clusters(2)  # another run with another cluster does the rest
    finish(drive(large, folder, second.address))
    sweep(folder)
    assert digest(folder) == expected


def test_dask_on_this_machine(dem: pathlib.Path, tmp_path: pathlib.Path) -> None:
    pytest.importorskip("distributed", reason="python3-distributed is not installed")
    command = [sys.executable, "-m", "retalho.dask", str(dem), "-o", str(tmp_path / "d"), "--tiles", "40",
               "--max-error", "1", "--workers", "1"]
    subprocess.run(command, check=True, capture_output=True)
    retalho.TilePlan(dem, size=40, max_error=1.0).make(tmp_path / "m")
    assert digest(tmp_path / "d") == digest(tmp_path / "m")
    budget = [*command[:4], "-o", str(tmp_path / "b"), "--tiles", "40", "--vertices", "700", "--workers", "2", "--fit",
              "least-squares", "--surface", "powell-sabin"]
    subprocess.run(budget, check=True, capture_output=True)
    retalho.TilePlan(dem, size=40, vertices=700, fit="least-squares", surface="powell-sabin").make(tmp_path / "n")
    assert digest(tmp_path / "b") == digest(tmp_path / "n")
    again = subprocess.run(command, capture_output=True)
    assert again.returncode == 0, "nothing is left to do"
    command[command.index("1")] = "2"  # another tolerance
    refused = subprocess.run(command, capture_output=True, text=True)
    assert refused.returncode == 5 and "tiled model" in refused.stderr
    missing = subprocess.run([sys.executable, "-m", "retalho.dask", "no.tif", "-o", "x", "--max-error", "1"],
                             capture_output=True, text=True, cwd=tmp_path)
    assert missing.returncode == 4 and "no.tif" in missing.stderr

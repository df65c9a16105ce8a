"""Progress, Ctrl-C, the interpreter lock, threads."""
from __future__ import annotations

import os
import signal
import threading
import time
from typing import Literal

import numpy as np
import pytest
from conftest import hills

import retalho


def rough(size: int) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.random.default_rng(0).normal(size=(size, size))


@pytest.mark.parametrize("refine", ["flat", "surface"])
def test_progress_runs_to_the_end_of_every_stage(refine: Literal["flat", "surface"]) -> None:
    events: list[tuple[str, float]] = []
    here = threading.current_thread()
    threads = set()

    def note(stage: str, fraction: float) -> None:
        events.append((stage, fraction))
        threads.add(threading.current_thread())

    retalho.fit(rough(900) if refine == "flat" else hills(90, 110), max_error=0.5, refine=refine, progress=note)
    assert events and threads == {here}
    assert all(0 <= fraction <= 1 for _, fraction in events)
    by_stage: dict[str, list[float]] = {}
    for stage, fraction in events:
        by_stage.setdefault(stage, []).append(fraction)
    assert all(fractions == sorted(fractions) for fractions in by_stage.values())
    assert events[-1][1] == 1


def test_what_progress_raises_stops_the_work() -> None:
    def refuse(stage: str, fraction: float) -> None:
        raise LookupError(stage)

    start = time.monotonic()
    with pytest.raises(LookupError):
        retalho.intervisibility(rough(1200), progress=refuse)
    assert time.monotonic() - start < 10, "the whole map takes longer"


def test_ctrl_c_stops_the_work() -> None:
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        retalho.intervisibility(rough(1200))
    assert 0.2 < time.monotonic() - start < 10, "the whole map takes longer"
    timer.join()


def test_other_threads_run_meanwhile() -> None:
    ticks, done = 0, threading.Event()

    def tick() -> None:
        nonlocal ticks
        while not done.wait(0.01):
            ticks += 1

    ticker = threading.Thread(target=tick)
    ticker.start()
    start = time.monotonic()
    retalho.intervisibility(rough(400), threads=1)
    took = time.monotonic() - start
    done.set()
    ticker.join()
    assert took > 0.2, "not degenerate"
    assert ticks > 10 * took, "the interpreter was held"


def test_a_model_may_be_asked_from_several_threads() -> None:
    model = retalho.fit(rough(300), max_error=0.5, refine="flat")
    x, y = np.random.default_rng(1).uniform(0, 299, (2, 20000))
    answers: list[np.ndarray[tuple[int, ...], np.dtype[np.float64]]] = []
    workers = [threading.Thread(target=lambda: answers.append(model(x, -y))) for _ in range(6)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(answers) == 6
    assert all(np.array_equal(a, answers[0]) for a in answers)


def test_the_same_from_any_number_of_threads() -> None:
    z = hills(150, 170)
    one, three = (retalho.fit(z, max_error=0.5, fit="least-squares", threads=n).to_bytes() for n in (1, 3))
    assert one == three
    lines = [retalho.contours(z, interval=7, threads=n).points for n in (1, 3)]
    assert np.array_equal(lines[0], lines[1])
    maps = [retalho.intervisibility(z, directions=16, threads=n) for n in (1, 3)]
    assert np.array_equal(maps[0], maps[1])

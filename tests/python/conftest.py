"""What the tests share: terrain made up by formulas, the program, real data where there is some."""
from __future__ import annotations

import os
import pathlib
from collections.abc import Callable

import hypothesis
import numpy as np
import pytest
from numpy.typing import NDArray

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Times of examples vary on a busy machine; what is drawn does not, unless RETALHO_SEED says so.
hypothesis.settings.register_profile(
    "retalho", deadline=None, database=None, derandomize="RETALHO_SEED" not in os.environ,
    max_examples=25 * int(os.environ.get("RETALHO_SOAK", "1")))
hypothesis.settings.load_profile("retalho")


def hills(rows: int = 60, columns: int = 80) -> NDArray[np.float64]:
    """Heights between -100 and 100 with slopes in all directions."""
    y, x = np.mgrid[0:rows, 0:columns]
    return np.asarray(60 * np.sin(x / 9) * np.cos(y / 7) + 40 * np.sin((x + 2 * y) / 13), dtype=np.float64)


@pytest.fixture
def data() -> Callable[[str], pathlib.Path]:
    """The path of a file of real data, or a skipped test."""
    folder = pathlib.Path(os.environ.get("RETALHO_DATA") or ROOT.parent / "shared" / "data")

    def find(name: str) -> pathlib.Path:
        if not (folder / name).exists():
            pytest.skip(f"real data missing: {name} (set RETALHO_DATA to the folder that holds it)")
        return folder / name

    return find


@pytest.fixture
def program() -> pathlib.Path:
    """The program that was built beside the module."""
    path = pathlib.Path(os.environ["RETALHO_BUILD"]) / "retalho"
    if not path.exists():
        pytest.skip("the program is not built")
    return path

"""Runs the Python tests: run.py BUILD_FOLDER [pytest's options]. GTEST_OUTPUT=xml:FOLDER/ gets their report."""
import os
import pathlib
import sys

import pytest

BUILD = pathlib.Path(sys.argv[1]).resolve()
HERE = pathlib.Path(__file__).resolve().parent


def main() -> int:
    sys.path.insert(0, str(BUILD / "python"))
    os.environ["PYTHONPATH"] = str(BUILD / "python")  # for the tests that start an interpreter
    os.environ["RETALHO_BUILD"] = str(BUILD)
    arguments = [str(HERE), "-q", "-p", "no:cacheprovider", *sys.argv[2:]]
    kind, _, folder = os.environ.get("GTEST_OUTPUT", "").partition(":")
    if kind == "xml" and folder.endswith("/"):
        arguments.append(f"--junitxml={folder}test_python.xml")
    return int(pytest.main(arguments))


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
"""Adds up what a run of ctest left in a folder and ends with one line: N passed, N failed[, N skipped].

  scripts/count_tests.py FOLDER [NAME=passed|failed ...]

FOLDER holds ctest.xml (ctest --output-junit) and a GoogleTest (or pytest) report test_<room>*.xml for each test program. Counted
are GoogleTest's cases; a ctest test without a report, and each NAME, is one case. A program that ended badly although
its report shows no failure (a crash, a time limit, a sanitizer at exit) is one failed case. No test at all is a failure.
The exit code is 1 if anything failed.
"""
import collections
import pathlib
import sys
import xml.etree.ElementTree as xml


def main():
    folder = pathlib.Path(sys.argv[1])
    passed, failed, skipped = 0, [], collections.Counter()
    junit = folder / "ctest.xml"
    programs = list(xml.parse(junit).getroot().iter("testcase")) if junit.exists() else []
    if not programs:
        failed.append("ctest ran no test")
    for program in programs:
        name, status = program.get("name"), program.get("status")
        reports = [folder / f"test_{name}.xml", *folder.glob(f"test_{name}_[0-9]*.xml")]
        failures_before = len(failed)
        counted = False
        for report in reports:
            try:
                content = xml.parse(report).getroot()
            except (OSError, xml.ParseError):
                continue  # not there, or cut off: the program ended while it wrote
            counted = True
            for case in content.iter("testcase"):
                reason = case.find("skipped")
                if case.find("failure") is not None or case.find("error") is not None:
                    failed.append(f"{name}: {case.get('classname')}.{case.get('name')}")
                elif reason is not None:
                    skipped[reason.get("message", "").strip().split("\n")[-1] or "without a reason"] += 1
                elif case.get("status", "run") == "run":  # pytest's have none
                    passed += 1
        if status == "run" and not counted:
            passed += 1
        elif status == "notrun" or program.find("skipped") is not None and not counted:
            skipped[f"{name}: not run"] += 1
        elif status != "run" and len(failed) == failures_before:
            failed.append(f"{name}: the program ended badly")
    for argument in sys.argv[2:]:
        name, _, verdict = argument.partition("=")
        if verdict == "passed":
            passed += 1
        else:
            failed.append(name)

    total_skipped = sum(skipped.values())
    for words, count in sorted(skipped.items())[:40]:
        print(f"skipped {count}: {words}")
    for name in failed:
        print(f"FAILED {name}")
    print(f"{passed} passed, {len(failed)} failed" + (f", {total_skipped} skipped" if total_skipped else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

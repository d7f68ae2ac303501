"""Counts the test cases of one run of CTest.

    scripts/count_tests.py build/PRESET

In: tests.xml (what `ctest --output-junit` wrote) and gtest/*.xml in that folder. A CTest entry that
is a GoogleTest program, or a shard of one, has left a report of its cases there, named after the
entry with "/" as "_". Reports must be of this run: delete gtest/ before it.

Out: a line "PASSED FAILED SKIPPED", then one line for each that failed. The cases of a report count
one by one; an entry without a report counts as one case. A program that fails though all its cases
passed, or that left no report (it crashed, or ran out of time), is one failure more.
"""

import pathlib
import sys
import xml.etree.ElementTree
from typing import List, Optional, Tuple

Cases = List[Tuple[str, str]]  # name, and one of the outcomes:
PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"


def report_cases(report: pathlib.Path, entry: str) -> Optional[Cases]:
    """What GoogleTest wrote about each case; None when it wrote nothing, or not to the end."""
    try:
        root = xml.etree.ElementTree.parse(report).getroot()
    except (OSError, xml.etree.ElementTree.ParseError):
        return None
    cases = []
    for case in root.iter("testcase"):
        name = f"{entry}: {case.get('classname')}.{case.get('name')}"
        if case.find("failure") is not None:
            cases.append((name, FAILED))
        elif case.find("skipped") is not None or case.get("result") in ("skipped", "suppressed"):
            cases.append((name, SKIPPED))
        else:
            cases.append((name, PASSED))
    return cases


def entry_outcome(entry: xml.etree.ElementTree.Element) -> str:
    """What CTest says of an entry; "notrun" with a reason is a skip, without one a program amiss."""
    status = entry.get("status")
    if status == "run":
        return PASSED
    if status == "disabled":
        return SKIPPED
    skipped = entry.find("skipped")
    if status == "notrun" and skipped is not None and "SKIP_" in skipped.get("message", ""):
        return SKIPPED
    return FAILED


def count(build: pathlib.Path) -> Cases:
    cases: Cases = []
    for entry in xml.etree.ElementTree.parse(build / "tests.xml").getroot().iter("testcase"):
        name = entry.get("name", "")
        outcome = entry_outcome(entry)
        of_entry = report_cases(build / "gtest" / f"{name.replace('/', '_')}.xml", name)
        if of_entry is None:
            of_entry = [(name, outcome)]
        elif outcome == FAILED and all(case[1] != FAILED for case in of_entry):
            of_entry.append((f"{name}: the program, after its cases", FAILED))
        cases += of_entry
    return cases


def main() -> None:
    cases = count(pathlib.Path(sys.argv[1]))
    outcomes = [outcome for _, outcome in cases]
    print(outcomes.count(PASSED), outcomes.count(FAILED), outcomes.count(SKIPPED))
    for name, outcome in cases:
        if outcome == FAILED:
            print(name)


if __name__ == "__main__":
    main()

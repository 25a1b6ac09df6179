# SPDX-License-Identifier: MIT
"""Runs pytest on what the arguments name; exit code 77, skipped, where pytest is not installed or every test was
skipped."""
import sys

try:
    import pytest
except ImportError:
    print("skipped: pytest is not installed (Debian package python3-pytest)")
    sys.exit(77)


class Outcomes:
    """Of the tests that ran."""

    def __init__(self):
        self.seen = set()

    def pytest_runtest_logreport(self, report):
        if report.when == "call" or report.skipped:
            self.seen.add(report.outcome)


outcomes = Outcomes()
code = pytest.main(["-q", "-rs", "-p", "no:cacheprovider", *sys.argv[1:]], plugins=[outcomes])
sys.exit(77 if code == 0 and outcomes.seen == {"skipped"} else code)

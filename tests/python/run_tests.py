# SPDX-License-Identifier: MIT
"""Runs pytest on what the arguments name; exit code 77, skipped, where pytest is not installed."""
import sys

try:
    import pytest
except ImportError:
    print("skipped: pytest is not installed (Debian package python3-pytest)")
    sys.exit(77)
sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", *sys.argv[1:]]))

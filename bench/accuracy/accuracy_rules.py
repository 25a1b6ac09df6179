# SPDX-License-Identifier: MIT
"""What is read out of the rows of bench/accuracy/run: orders, fronts, who is best at whose cost, what is out of order.

A row has problem, complete and, where complete, error and ms (CPU ms per simulated second); flotilla's rows have preset and rate (steps a
second), other engines' have engine, solver, iterations and rate.
"""
import math

PRESETS = ("preview", "paper", "balanced", "accurate", "reference")
OTHER_LAW = "paper"  # of friction: no preset is to be compared with it
RATES = (24, 120, 480)
SAME_ERROR = 1.25  # ratios of errors below it say nothing
SAME_COST = 1.1  # and of costs
WORTH = 0.1  # of a problem's bound: smaller errors are none that anyone needs to look at
STEPS = 1e-3  # of it: errors below are tolerances' or rounding, not the step's
ROUNDING = 1e-12  # errors below it have no order
WRONG = 1e300  # what a motion that blew up is given


def order(coarse, fine, bound):
    """Of convergence between two rows, None where a row is missing and where both errors are too small for the step to be their cause."""
    if not (coarse and fine and coarse["complete"] and fine["complete"]):
        return None
    errors = coarse["error"], fine["error"]
    if min(errors) < ROUNDING or max(errors) < STEPS * bound or max(errors) >= WRONG:
        return None
    return math.log(errors[0] / errors[1]) / math.log(fine["rate"] / coarse["rate"])


def front(rows):
    """The complete rows that no other beats in both cost and error, cheapest first."""
    best = []
    for row in sorted((r for r in rows if r["complete"] and r["error"] < WRONG), key=lambda r: (r["ms"], r["error"])):
        if not best or row["error"] < best[-1]["error"]:
            best.append(row)
    return best


def at_cost(rows, ms):
    """The row of least error that costs at most `ms`, or None."""
    affordable = [row for row in front(rows) if row["ms"] <= ms]
    return affordable[-1] if affordable else None


def by_problem(rows):
    out = {}
    for row in rows:
        out.setdefault(row["problem"], []).append(row)
    return out


def worse(row, other, floor):
    return row["error"] > floor and row["error"] > SAME_ERROR * other["error"]


def out_of_order(problems, rows):
    """Dear rows that are less right than a cheaper preset at the same step, and small steps less right than a larger one of the same
    preset: (problem, row, other, why), the largest errors in bounds first. Errors that the sides of a round body's mesh explain are none."""
    found = []
    for problem in problems:
        mine = [r for r in rows if r["problem"] == problem["name"] and r["complete"] and r["preset"] != OTHER_LAW]
        floor = max(WORTH * problem["bound"], problem["sides"])
        for row in mine:
            cheaper = [r for r in mine if r["rate"] == row["rate"] and row["ms"] > SAME_COST * r["ms"]]
            larger = [r for r in mine if r["preset"] == row["preset"] and r["rate"] < row["rate"]]
            for others, why in ((cheaper, "preset"), (larger, "step")):
                other = min(others, key=lambda r: r["error"], default=None)
                if other and worse(row, other, floor):
                    found.append((problem, row, other, why))
    return sorted(found, key=lambda f: -f[1]["error"] / f[0]["bound"])


def incomplete(rows):
    """Cells that were begun and given up."""
    return [row for row in rows if not row["complete"]]

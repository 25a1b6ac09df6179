# SPDX-License-Identifier: MIT
"""Pictures of the page of bench/accuracy/run."""
import math
import os
import sys

import accuracy_rules as rules

COLOURS = {"flotilla": "C3", "Bullet": "C0", "ODE": "C2"}
MARKS = dict(zip(rules.PRESETS, "v^oDs"))
LEAST = 1e-13  # smaller errors are drawn there


def pyplot():
    try:
        import matplotlib
    except ImportError:
        sys.exit(f"{sys.executable} has no matplotlib (Debian package python3-matplotlib, for /usr/bin/python3)")
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    plt.rcParams.update({"font.size": 7, "axes.grid": True, "grid.alpha": 0.3, "legend.fontsize": 7, "svg.hashsalt": "flotilla"})
    return plt


def grid(plt, count, columns=4):
    lines = math.ceil(count / columns)
    figure, axes = plt.subplots(lines, columns, figsize=(2.6 * columns, 2.1 * lines), squeeze=False)
    cells = list(axes.flat)
    for cell in cells[count:]:
        cell.axis("off")
    return figure, cells


def save(figure, folder, name):
    figure.tight_layout()
    figure.savefig(os.path.join(folder, name + ".png"), dpi=80, metadata={"Software": None})


def draw_engines(plt, results, folder):
    """Error against cost, a front for each engine."""
    ours, others = rules.by_problem(results["ours"]), rules.by_problem(results["engines"])
    names = [p for p in results["problems"] if p["name"] in others]
    figure, cells = grid(plt, len(names))
    for cell, problem in zip(cells, names):
        groups = {"flotilla": ours.get(problem["name"], [])}
        for row in others[problem["name"]]:
            groups.setdefault(row["engine"], []).append(row)
        for engine, rows in groups.items():
            points = [(r["ms"], max(r["error"], LEAST)) for r in rows if r["complete"] and r["error"] < rules.WRONG]
            cell.loglog(*zip(*points) if points else ([], []), ".", color=COLOURS[engine], markersize=3, alpha=0.4)
            best = [(r["ms"], max(r["error"], LEAST)) for r in rules.front(rows)]
            cell.loglog(*zip(*best) if best else ([], []), "-", color=COLOURS[engine], label=engine, linewidth=1)
        cell.axhline(problem["bound"], color="k", linestyle=":", linewidth=0.8)
        cell.set_title(problem["name"], fontsize=8)
        cell.set_xlabel("CPU ms per s")
    cells[0].legend()
    save(figure, folder, "accuracy-engines")
    plt.close(figure)


def draw_presets(plt, results, folder):
    figure, cells = grid(plt, len(results["fronts"]), 3)
    for cell, scene in zip(cells, results["fronts"]):
        for point in scene["points"]:
            if point["error"] is None or point["preset"] == scene["reference"]:
                continue
            error = max(abs(point["error"]), LEAST)
            cell.loglog([point["cpu"]], [error], MARKS[point["preset"]], label=point["preset"])
            if point["uncertainty"]:
                cell.errorbar([point["cpu"]], [error], yerr=[[0], [point["uncertainty"]]], color="k", linewidth=0.7)
        truth = [p["cpu"] for p in scene["points"] if p["preset"] == scene["reference"]]
        if truth:
            cell.axvline(truth[0], color="k", linestyle=":", linewidth=0.8, label=scene["reference"])
        cell.set_title(scene["name"], fontsize=8)
        cell.set_xlabel("CPU s")
        cell.set_ylabel(f"{scene['metric']}, {scene['unit'] or 'of weight'}")
        cell.legend()
    save(figure, folder, "accuracy-presets")
    plt.close(figure)


def draw(results, folder):
    plt = pyplot()
    if results["engines"]:
        draw_engines(plt, results, folder)
    if results["fronts"]:
        draw_presets(plt, results, folder)

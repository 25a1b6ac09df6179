# SPDX-License-Identifier: MIT
"""The paper's tables and plots: figures 16, 17 and 19."""
import os

from claims import claim
from flotilla import mean

# Figure 17: bodies, then seconds per step: all, collisions and dynamic contact (detection, response), static contact (same).
PAPER_17 = [("boats-in-bowl", 102, 1.7, 1.3, 0.0004, 0.20, 0.18), ("boats-in-bowl", 252, 4.8, 3.9, 0.0011, 0.46, 0.52),
            ("boats-in-bowl", 502, 9.6, 8.0, 0.0025, 0.84, 0.80), ("boats-in-bowl", 1002, 20.9, 17.7, 0.0060, 1.45, 1.61),
            ("hanging-rings", 2003, 19.1, 15.7, 0.0098, 0.30, 1.93), ("triangles-on-pegs", 186, 0.45, 0.34, 0.0006, 0.02, 0.08)]
# Figure 19: collision iterations, static iterations, seconds per step.
PAPER_19 = [(10, 1000, 38.9), (20, 1000, 19.8), (50, 1000, 22.3), (100, 1000, 20.9), (100, 20, 96.5), (100, 50, 41.6),
            (100, 100, 31.2), (100, 250, 23.3)]


def figure_17(context):
    """Time per step over the first 200 steps, split as printed."""
    rows, runs, sizes = [], [], []
    for scene, bodies, *paper in PAPER_17:
        if context.fast and bodies != 186:
            continue
        run = context.run(scene, bodies=bodies, steps=context.pick(40, 200), settings={"sleeping": "false"})
        runs.append(run)
        ours = [mean(run.column(name + "_ms")[:200]) / 1000
                for name in ("total", "detection", "response", "static_detection", "static_response")]
        sizes.append(run.state_mb())
        rows.append([scene, bodies] + [f"{a:.3g} / {b:.3g}" for a, b in zip(paper, ours)] +
                    [f"{paper[0] / ours[0]:.0f}", f"{run.peak_mib:.0f}", f"{sizes[-1]:.2f}"])
    context.table("17", ["example", "bodies", "time per step, s: paper / ours", "detection", "response", "static detection",
                         "static response", "ratio", "peak memory of the run, MiB", "geometry and state, MB"], rows,
                  "Detection and response are sums over threads. Geometry and state: the meshes and a checkpoint.")
    return [claim("17", ", ".join(sorted({row[0] for row in rows})), "every example of the table runs free of intersections",
                  f"{len(runs)} runs", f"{len(rows)}", len(runs) == len(rows), *runs),
            claim("17", ", ".join(sorted({row[0] for row in rows})), "geometry and state of each take little memory",
                  f"{max(sizes):.2f} MB at most", "< 10 MB", max(sizes) < 10, *runs)]


def figure_16(context):
    """Time, collisions and contacts over ten seconds."""
    bodies = context.pick(32, 1002)
    run = context.run("boats-in-bowl", bodies=bodies, steps=240, settings={"sleeping": "false"})
    time_ms, contacts = run.column("total_ms"), run.column("contacts")
    collisions = run.column("collisions")
    peak = max(range(len(time_ms)), key=lambda k: collisions[k])
    plot(context, run, bodies)
    late = mean(time_ms[-48:]) / max(time_ms)
    steady = (max(contacts[-48:]) - min(contacts[-48:])) / mean(contacts[-48:])
    return [claim("16", "boats-in-bowl", "the expense lies in the impact; contacts then stabilise and the cost falls",
                  f"most collisions in step {peak + 1}; last 2 s cost {late:.2g} of the slowest step, contacts vary by "
                  f"{100 * steady:.2g} %", "< 0.5, < 25 %", late < 0.5 and steady < 0.25, run)]


def plot(context, run, bodies):
    try:
        import matplotlib
    except ImportError:
        print("  matplotlib is missing: no plot of figure 16")
        return
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(2, 1, sharex=True, figsize=(9, 6))
    time = run.column("time")
    axes[0].plot(time, run.column("total_ms"))
    axes[0].set_ylabel("ms per step")
    for name in ("collisions", "contacts"):
        axes[1].plot(time, run.column(name), label=name)
    axes[1].legend()
    axes[1].set_xlabel(f"time, s ({bodies} bodies)")
    figure.tight_layout()
    figure.savefig(os.path.join(context.output, "figure-16.png"), dpi=110)
    context.pictures.append("figure-16")


def figure_19(context):
    """Iteration limits: every one free of intersections."""
    rows, runs = [], []
    for collisions, static, paper in PAPER_19[:: context.pick(3, 1)]:
        limits = {"collision_iterations": collisions, "dynamic_iterations": collisions, "static_iterations": static}
        default = (collisions, static) == (100, 1000)
        run = context.run("boats-in-bowl", bodies=context.pick(22, 1002), steps=context.pick(80, 200),
                          settings={"sleeping": "false"} | ({} if default else limits))
        runs.append(run)
        rows.append([collisions, static, paper, f"{mean(run.column('total_ms')[:200]) / 1000:.3g}",
                     f"{sum(run.column('merges')):.0f}"])
    context.table("19", ["collision iterations", "static iterations", "paper, s per step", "ours, s per step", "merges"], rows)
    return [claim("19", "boats-in-bowl", "free of intersections at every limit of iterations", f"{len(runs)} limits", "all",
                  True, *runs)]


ALL = [figure_17, figure_16, figure_19]

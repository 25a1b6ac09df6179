# SPDX-License-Identifier: MIT
"""The page of bench/accuracy/run: accuracy.md from what accuracy.json holds."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "paper"))
import accuracy_rules as rules
import page

# What users of an engine get who set nothing but the step: its solver's default at 1/240 s.
DEFAULTS = {"Bullet": ("impulses", 10, 240), "ODE": ("sweeps", 20, 240)}
OURS = ("balanced", 24)


def number(value):
    if value is None:
        return ""
    return "wrong" if value >= rules.WRONG else "0" if value == 0 else f"{value:.1e}" if value < 1e-3 else f"{value:.3g}"


def cell(row):
    """Error and cost of one of flotilla's rows."""
    if row is None:
        return ""
    return f"{number(row['error'])} ({number(row['ms'])})" if row["complete"] else "given up"


def found(rows, **keys):
    return next((r for r in rows if all(r[k] == v for k, v in keys.items())), None)


def name_of(row):
    if "engine" not in row:
        return f"{row['preset']} 1/{row['rate']}"
    iterations = f" {row['iterations']}" if row["iterations"] else ""
    return f"{row['solver']}{iterations} 1/{row['rate']}"


def what(row):
    return f"{number(row['error'])} ({name_of(row)})" if row else "none as cheap"


def preset_section(results):
    ours = rules.by_problem(results["ours"])
    lines = [f"Errors by preset and step, in brackets CPU ms per simulated second; orders between 1/24 and 1/120 s and between 1/120 and 1/480 s, "
             "none where both are below a thousandth of the bound. Accurate and reference take four and eight inner steps in each step; paper has the pyramids of random direction that the paper prints, another law of friction. The "
             "bound is what the tests of physics grant, or what tells right from wrong."]
    for problem in results["problems"]:
        rows = ours.get(problem["name"], [])
        lines.append(f"**{problem['name']}**: {problem['about']}. Error: {problem['error']}; bound {number(problem['bound'])}" +
                     (f"; the flat sides of the mesh alone may give {number(problem['sides'])}." if problem["sides"] else "."))
        table = []
        for preset in rules.PRESETS:
            by_rate = [found(rows, preset=preset, rate=rate) for rate in rules.RATES]
            if any(by_rate):
                orders = [rules.order(a, b, problem["bound"]) for a, b in zip(by_rate, by_rate[1:])]
                table.append([preset, *map(cell, by_rate), *("" if o is None else f"{o:.1f}" for o in orders)])
        lines.append(page.table(["preset", *(f"1/{rate} s" for rate in rules.RATES), "order", "order"], table))
    return lines


def engine_table(results):
    """For each problem: our default and the others at its cost, then each engine's default and we at its cost, then the best of all."""
    ours, others = rules.by_problem(results["ours"]), rules.by_problem(results["engines"])
    engines = [e for e in DEFAULTS if any(r["engine"] == e for r in results["engines"])]
    at_ours, at_theirs, best = [], [], []
    for problem in results["problems"]:
        name = problem["name"]
        if name not in others:
            continue
        mine, theirs = ours.get(name, []), {e: [r for r in others[name] if r["engine"] == e] for e in engines}
        own = found(mine, preset=OURS[0], rate=OURS[1])
        if own and own["complete"]:
            at_ours.append([name, number(own["ms"]), number(own["error"]),
                            *(what(rules.at_cost(theirs[e], own["ms"])) for e in engines)])
        line = [name]
        for e in engines:
            solver, iterations, rate = DEFAULTS[e]
            default = found(theirs[e], solver=solver, iterations=iterations, rate=rate)
            if default and default["complete"]:
                line += [number(default["ms"]), number(default["error"]), what(rules.at_cost(mine, default["ms"]))]
            else:
                line += ["", "given up", ""]
        at_theirs.append(line)
        rows = [mine, *theirs.values()]
        ends = [rules.front(r)[-1] if rules.front(r) else None for r in rows]
        best.append([name, number(problem["bound"]), *(f"{what(r)}, {number(r['ms'])} ms" if r else "none" for r in ends)])
    return engines, at_ours, at_theirs, best


def tally(results):
    """By engine: (of problems, at our default's cost it is better, we are better, neither by more than SAME_ERROR; none as cheap)."""
    ours, others = rules.by_problem(results["ours"]), rules.by_problem(results["engines"])
    out = {}
    for problem in results["problems"]:
        own = found(ours.get(problem["name"], []), preset=OURS[0], rate=OURS[1])
        if not own or not own["complete"]:
            continue
        for engine in DEFAULTS:
            rows = [r for r in others.get(problem["name"], []) if r["engine"] == engine]
            if not rows:
                continue
            their, count = rules.at_cost(rows, own["ms"]), out.setdefault(engine, {"theirs": [], "ours": [], "same": [], "none": []})
            floor = max(own["error"], rules.ROUNDING)
            if their is None:
                count["none"].append(problem["name"])
            elif max(their["error"], rules.ROUNDING) * rules.SAME_ERROR < floor:
                count["theirs"].append(problem["name"])
            elif max(their["error"], rules.ROUNDING) > rules.SAME_ERROR * floor:
                count["ours"].append(problem["name"])
            else:
                count["same"].append(problem["name"])
    return out


def engine_section(results):
    if not results["engines"]:
        return ["Not run: the engines' packages (scope baseline in scripts/packages.txt) or their drivers are missing."]
    engines, at_ours, at_theirs, best = engine_table(results)
    listed = lambda names: f"{len(names)}" + (f" ({', '.join(names)})" if names else "")
    lines = ["The same problems in Bullet (single precision, as Debian builds it) and ODE (double), one thread, same machine, same run. They get what "
             "the meshes stand for: boxes, balls, cylinders and planes, convex hulls for the stones of the arch and the cut cards, boxes as thick as our "
             "rest distance for the cards of the house. A body on a point is a hull in Bullet and a convex solid in ODE. What stands begins "
             "in contact, sunk by 1e-6 of our rest distance: at our rest, but for that, while theirs is some way into each other, so that what they "
             "settle by is in their error. Their fronts are over steps of 1/60, 1/240, 1/960 and 1/3840 s, Bullet's impulses with "
             "one or two (-2) friction directions and 10, 50 and 200 iterations and its Dantzig solver, ODE's quick step with 20 and 100 iterations and its "
             "exact one (pivots), friction as a pyramid or against the sliding (-sliding). All else are their defaults, but that Bullet's threshold of "
             "restitution is zero and ODE turns bodies by finite rotations. Ours are the five presets at 1/24, 1/120 and 1/480 s. "
             "They prove nothing about intersections; what we spend on that is in our cost. Rolling is ours on meshes of 512 sides (the ball: 1,280 "
             "triangles), theirs on round bodies: there they are cheaper and more accurate by orders of magnitude.",
             "![error against cost](accuracy-engines.png)",
             "Dots are all runs, lines the fronts, the dotted line the bound."]
    for engine, count in tally(results).items():
        lines.append(f"**{engine} at the cost of balanced, 1/24 s**: more accurate in {listed(count['theirs'])}; less accurate in {listed(count['ours'])}; "
                     f"the same in {listed(count['same'])}; no run as cheap in {listed(count['none'])}.")
    lines += ["What the others reach at the cost of balanced at 1/24 s:",
              page.table(["problem", "CPU ms per s", "flotilla", *engines], at_ours)]
    header = ["problem"]
    for engine in engines:
        solver, iterations, rate = DEFAULTS[engine]
        header += [f"{engine} ({solver} {iterations}, 1/{rate} s), ms per s", "its error", "flotilla at that cost"]
    lines += ["What we reach at the cost of the others' defaults:", page.table(header, at_theirs),
              "The least error of each, whatever it costs:", page.table(["problem", "bound", "flotilla", *engines], best)]
    return lines


def front_section(results):
    if not results["fronts"]:
        return ["Not run."]
    lines = ["`flotilla sweep` with the five presets at the scene's step, 1/24 s; the error is the distance from the most exact one that was run, so that it has none of its "
             "own. CPU s of the whole process, its files and proofs included. The spread over seeds is that of the error's mean.",
             "![presets](accuracy-presets.png)"]
    for scene in results["fronts"]:
        rows = []
        for p in scene["points"]:
            truth = p["preset"] == scene["reference"]
            error = "truth" if truth else number(abs(p["error"])) if p["error"] is not None else p["note"] or "none"
            spread = f" ± {number(p['uncertainty'])}" if p["uncertainty"] and not truth else ""
            rows.append([p["preset"], number(p["cpu"]), error + spread, *(number(p["values"].get(m)) for m in scene["shown"])])
        note = f" {scene['note']}" if scene.get("note") else ""
        lines += [f"**{scene['name']}**: {scene['about']}.{note}",
                  page.table(["preset", "CPU s", f"{scene['metric']}, {scene['unit']}", *scene["shown"]], rows)]
    return lines


def order_section(results):
    listed = rules.out_of_order(results["problems"], results["ours"])
    if not listed:
        return ["None."]
    rows = [[p["name"], why, name_of(row), number(row["error"]), name_of(other), number(other["error"]),
             f"{row['error'] / p['bound']:.2g}"] for p, row, other, why in listed]
    return [f"{len(listed)} rows: a preset that is less right than a cheaper one at the same step, or a smaller step than a larger one of the same preset, "
            f"by more than a factor of {rules.SAME_ERROR:g} and with an error above {rules.WORTH:g} of the bound and above what the sides of a round body's mesh explain; the largest errors first. Paper is left out: its friction is another law.",
            page.table(["problem", "what", "row", "error", "beside", "error", "error in bounds"], rows)]


def left_section(results):
    ours = [f"{r['problem']} {name_of(r)}" for r in rules.incomplete(results["ours"])]
    others = {}
    for r in rules.incomplete(results["engines"]):
        others[f"{r['problem']} {r['engine']} {name_of(r)}"] = True
    text = [f"Runs are given up after {results['limit']:g} CPU s, and then smaller steps of the same settings are not begun."]
    text.append("flotilla: " + (", ".join(ours) or "none") + ".")
    text.append("Others: " + (", ".join(others) or "none") + ".")
    return text


def text_of(results):
    parts = ["# Accuracy", f"How far motions are from what is known of them, and what they cost. `{results['command']}` writes this page; "
             f"{results['machine']}, commit {results['commit']}, {results['date']}. Times are CPU times of the process on one thread "
             "(CLOCK_PROCESS_CPUTIME_ID, of the steps alone; the least of up to five runs for flotilla's rows below 0.1 s), for other work goes on on this machine.",
             "Problems and errors are those of `tests/physics/problems`."]
    for title, section in (("Presets and steps", preset_section), ("Out of order", order_section), ("Bullet and ODE", engine_section),
                           ("Presets as points of a front", front_section), ("What was not run to its end", left_section)):
        parts += [f"## {title}", *section(results)]
    return "\n\n".join(parts) + "\n"

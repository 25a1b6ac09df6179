#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the paper's examples, verifies every frame and the motion between them, and checks each figure's claim.

usage: run.py --flotilla COMMAND --output DIR [--baseline COMMAND] [--fast] [--only NAME]... [--threads T] [--keep] [--list]
  --baseline  flotilla_baseline, which runs reference [15] beside ours in figures 2 and 14; without it those claims are left out
  --fast      small versions, within minutes
  --only      one example, by the name of its function in claims.py (--list prints them); what DIR/paper.json holds of the others stays
  --keep      keep the run folders, in DIR/runs
exit code: 0 every claim holds, 1 one fails or a command failed, 2 usage
"""
import argparse
import difflib
import os
import shutil
import sys
import tempfile
import time

import claims
import page
import tables
from flotilla import BaselineRun, Failed, Flotilla


class Context:
    """What an example may do: runs, pictures, tables."""

    def __init__(self, flotilla, output, fast, baseline=None):
        self.flotilla, self.output, self.fast, self.baseline = flotilla, output, fast, baseline
        self.pictures, self.tables = [], {}  # of the present example
        self.runs, self.known = 0, {}

    def pick(self, fast, full):
        return fast if self.fast else full

    def run(self, name, steps, bodies=0, edit=None, **options):
        """A run of a library scene; the same one again where it was asked for before, with at least as many steps."""
        if edit:
            return self._run(name, steps, bodies, edit, **options)
        key = repr((name, bodies, sorted(options.items())))
        if key not in self.known or len(self.known[key].steps) < steps:
            self.known[key] = self._run(name, steps, bodies, None, **options)
        return self.known[key]

    def _run(self, name, steps, bodies, edit, **options):
        self.runs += 1
        scene = self.flotilla.scene(name, bodies, edit=edit)
        return self.flotilla.run(scene, steps, f"{name}-{self.runs}", **options)

    def run_both(self, name, steps, bodies=0, edit=None, options=(), beside=True):
        """(ours, reference [15]'s) of one scene; ours is None unless `beside`."""
        self.runs += 1
        scene, label = self.flotilla.scene(name, bodies, edit=edit), f"{name}-{self.runs}"
        return (self.flotilla.run(scene, steps, label) if beside else None,
                BaselineRun(self.flotilla, self.baseline, scene, steps, label + "-baseline", *options))

    def picture(self, run, name, frame=None):
        run.picture(os.path.join(self.output, name + ".png"), frame)
        self.pictures.append(name)

    def table(self, figure, header, rows, note=""):
        self.tables[figure] = {"header": header, "rows": rows, "note": note}


def run_example(context, example):
    """page.Results"""
    start = time.monotonic()
    context.pictures, context.tables = [], {}
    try:
        found = example(context)
    except Failed as error:
        print(f"{example.__name__}: {error}", file=sys.stderr)
        found = [claims.claim("?", example.__name__, "runs", "a command failed", "none fails", False)]
    if not context.baseline and example in claims.WITH_BASELINE:
        print(f"{example.__name__}: the claims about reference [15] are left out: no --baseline", flush=True)
    rows = [c.row() for c in found]
    for row in rows:
        print(f"figure {row['figure']}, {row['scene']}: {row['claim']}: {row['measured']} (wanted {row['bound']}); "
              f"{row['frames_verified']} frames verified, {row['intersections']} intersections: {row['verdict']}", flush=True)
    seconds = time.monotonic() - start
    print(f"  {seconds:.1f} s", flush=True)
    return page.Results(rows, context.tables, context.pictures, context.flotilla.commit or "unknown",
                        context.flotilla.threads, seconds)


def unknown_example(name, known):
    """What to say of it, with the nearest name that there is."""
    near = difflib.get_close_matches(name, known, 1) or [other for other in known if name in other]
    return f"unknown example {name}" + (f"; did you mean {near[0]}?" if near else " (--list prints them)")


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n", 1)[1])
    parser.add_argument("--flotilla")
    parser.add_argument("--output")
    parser.add_argument("--baseline")
    parser.add_argument("--fast", action="store_true")
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--keep", action="store_true")
    parser.add_argument("--list", action="store_true")
    arguments = parser.parse_args()
    examples = {example.__name__: example for example in claims.ALL + tables.ALL + claims.LONG}
    if arguments.list:
        print("\n".join(examples))
        return 0
    unknown = [name for name in arguments.only if name not in examples]
    if unknown or not arguments.flotilla or not arguments.output:
        parser.error(unknown_example(unknown[0], examples) if unknown else "--flotilla and --output are needed")
    os.makedirs(arguments.output, exist_ok=True)
    runs = os.path.join(arguments.output, "runs") if arguments.keep else tempfile.mkdtemp(prefix="flotilla-paper-")
    about = {"machine": page.machine(), "mode": "fast" if arguments.fast else "full",
             "note": "" if arguments.baseline else claims.NO_BASELINE}
    try:
        flotilla = Flotilla(arguments.flotilla, runs, arguments.threads)
        context = Context(flotilla, arguments.output, arguments.fast, arguments.baseline)
        kept, found = page.earlier(arguments.output, about) if arguments.only else {}, {}
        for name in arguments.only or examples:
            found[name] = run_example(context, examples[name])
            results = kept | found
            page.write(arguments.output, about, {name: results[name] for name in examples if name in results})
    finally:
        if not arguments.keep:
            shutil.rmtree(runs, ignore_errors=True)
    verdicts = [row["verdict"] for r in found.values() for row in r.rows]
    failed = sum(verdict != "holds" for verdict in verdicts)
    print(f"{len(verdicts) - failed} claims hold, {failed} fail")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

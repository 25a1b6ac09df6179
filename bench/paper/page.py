# SPDX-License-Identifier: MIT
"""The results of the paper's examples as one Markdown page and one JSON file."""
import dataclasses
import json
import os
import platform

COLUMNS = ["figure", "scene", "steps", "frames_verified", "intersections", "claim", "measured", "bound", "verdict"]


def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} cores"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(str(cell).replace("|", "/") for cell in row) + " |" for row in rows])


@dataclasses.dataclass
class Results:
    """What one example gave. rows: a dict of COLUMNS per claim; tables: by figure; pictures: names of PNG files."""

    rows: list
    tables: dict
    pictures: list
    commit: str
    threads: int
    seconds: float


def path_of(folder):
    return os.path.join(folder, "paper.json")


def earlier(folder, about):
    """{example: Results} of the page that is there, if it is of the same mode and machine."""
    if not os.path.exists(path_of(folder)):
        return {}
    with open(path_of(folder), encoding="utf-8") as file:
        found = json.load(file)
    if any(found.get(key) != about[key] for key in ("mode", "machine")) or "examples" not in found:
        return {}
    rows = lambda name: [{key: row[key] for key in COLUMNS} for row in found["rows"] if row["example"] == name]
    return {name: Results(rows(name), **rest) for name, rest in found["examples"].items()}


def write(folder, about, results):
    """paper.json (one object per claim) and paper.md. `about`: machine, mode, and a note or ""; results: by example."""
    rows = [{"example": name} | {key: row[key] for key in COLUMNS} for name, r in results.items() for row in r.rows]
    examples = {name: {key: value for key, value in dataclasses.asdict(r).items() if key != "rows"} for name, r in results.items()}
    with open(path_of(folder), "w", encoding="utf-8") as file:
        json.dump({**about, "rows": rows, "examples": examples}, file, indent=1)
        file.write("\n")
    made_by = {}
    for name, r in results.items():
        made_by.setdefault(f"commit {r.commit}, {r.threads} threads", []).append(name)
    made = "; ".join(f"{how} ({', '.join(names)})" if len(made_by) > 1 else how for how, names in made_by.items())
    parts = ["# The paper's examples", f"{about['mode']} versions, {about['machine']}; "
             f"{sum(r.seconds for r in results.values()):.0f} s in all; {made}. The paper does not state its hardware, so times beside "
             "each other say little. `scripts/paper` writes this page.", about["note"],
             table(COLUMNS, [[row[key] for key in COLUMNS] for r in results.values() for row in r.rows])]
    for r in results.values():
        for name, t in r.tables.items():
            parts += [f"## Figure {name}", table(t["header"], t["rows"]), t["note"]]
    for r in results.values():
        for name in r.pictures:
            parts += [f"## {name.replace('-', ' ').capitalize()}", f"![{name}]({name}.png)"]
    with open(os.path.join(folder, "paper.md"), "w", encoding="utf-8") as file:
        file.write("\n\n".join(part for part in parts if part) + "\n")

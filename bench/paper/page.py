# SPDX-License-Identifier: MIT
"""The results of the paper's examples as one Markdown page and one JSON file."""
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


def write(folder, claims, tables, pictures, about):
    """paper.json (one object per claim) and paper.md. `about`: commit, mode, seconds, and a note or ""."""
    rows = [{key: c.row()[key] for key in COLUMNS} for c in claims]
    with open(os.path.join(folder, "paper.json"), "w", encoding="utf-8") as file:
        json.dump({"machine": machine(), **about, "rows": rows, "tables": tables}, file, indent=1)
        file.write("\n")
    parts = ["# The paper's examples", f"{about['mode']} versions, commit {about['commit']}, {machine()}, "
             f"{about['threads']} threads, {about['seconds']:.0f} s in all. The paper does not state its hardware, so times beside "
             "each other say little. `scripts/paper` writes this page.", about["note"], table(COLUMNS, [row.values() for row in rows])]
    for name, t in tables.items():
        parts += [f"## Figure {name}", table(t["header"], t["rows"]), t["note"]]
    for name in pictures:
        parts += [f"## {name.replace('-', ' ').capitalize()}", f"![{name}]({name}.png)"]
    with open(os.path.join(folder, "paper.md"), "w", encoding="utf-8") as file:
        file.write("\n\n".join(part for part in parts if part) + "\n")

#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
"""docs/papers.md from docs/papers/page.md and the kept results of engram-eval beside it.

  scripts/papers.py keep NAME RESULT.json 'COMMAND'   keeps what --json of an experiment has as docs/papers/NAME.json
  scripts/papers.py                                   writes docs/papers.md
  scripts/papers.py --check                           fails when docs/papers.md is not what that would write

In the page `{{expression}}` is Python over the kept results: `row(memory.results, method='fsh').mean_error`, `pct(x)`.
"""
import json
import math
import re
import sys
from pathlib import Path
from types import SimpleNamespace

ROOT = Path(__file__).resolve().parent.parent
KEPT = ROOT / "docs" / "papers"
PAGE = ROOT / "docs" / "papers.md"
BULKY = 24  # numbers of a list that no table shows


def reduced(value):
    """Without long lists of bare numbers, and with figures of five digits."""
    if isinstance(value, dict):
        return {k: reduced(v) for k, v in value.items() if not is_bulky(v)}
    if isinstance(value, list):
        return [reduced(v) for v in value]
    if isinstance(value, float) and math.isfinite(value):  # neither infinite nor unknown
        return float(f"{value:.5g}")
    return value


def is_bulky(value):
    return isinstance(value, list) and len(value) > BULKY and not isinstance(value[0], dict)


def of_the_ends(rows):
    """Of the experiment `memory`: the first and the last update, and what the page shows of them."""
    last = max(r["update"] for r in rows)
    shown = ("method", "condition", "update", "global_success", "local_success", "mean_error", "bytes_per_place")
    return [
        {k: v for k, v in r.items() if k.removesuffix("_95") in shown} for r in rows if r["update"] in (1, last)
    ]


def keep(name, result, command):
    figures = json.loads(Path(result).read_text())
    if "sweeps" in figures:
        figures["results"] = of_the_ends(figures["results"])
        figures["sweeps"] = of_the_ends(figures["sweeps"]) if figures["sweeps"] else []
        figures.pop("advantages", None)
    figures = reduced(figures)
    text = json.dumps({"command": command, "figures": figures}, indent=1, sort_keys=True)
    (KEPT / f"{name}.json").write_text(text + "\n")


def kept(path):
    text = json.loads(path.read_text())
    figures = json.loads(json.dumps(text["figures"]), object_hook=lambda d: SimpleNamespace(**d))
    figures.command = text["command"]
    return figures


def row(rows, **asked):
    """The only row with these values."""
    found = [r for r in rows if all(getattr(r, k) == v for k, v in asked.items())]
    if len(found) != 1:
        raise SystemExit(f"scripts/papers.py: {len(found)} rows have {asked}")
    return found[0]


def number(value, decimals=1, factor=1):
    return f"{factor * value:.{decimals}f}"


def pct(value, decimals=1):
    return number(value, decimals, 100)


def ranged(of, key, decimals=1, factor=1):
    """A figure with its 95 % interval, as the JSON has both."""
    low, high = getattr(of, key + "_95")
    ends = f"{number(low, decimals, factor)} to {number(high, decimals, factor)}"
    return f"{number(getattr(of, key), decimals, factor)} ({ends})"


def share(of, key, decimals=1):
    return ranged(of, key, decimals, 100)


def lines(rows, *cells):
    """Lines of a table: each cell is a function of the row."""
    return "\n".join("| " + " | ".join(str(cell(r)) for cell in cells) + " |" for r in rows)


def page():
    names = {path.stem: kept(path) for path in KEPT.glob("*.json")}
    names.update(lines=lines, number=number, pct=pct, ranged=ranged, row=row, share=share)
    names["__builtins__"] = {"len": len, "max": max, "min": min, "sum": sum}

    def filled(match):
        return str(eval(match.group(1), names))

    return re.sub(r"\{\{(.+?)\}\}", filled, (KEPT / "page.md").read_text())


def main(arguments):
    if arguments[:1] == ["keep"] and len(arguments) == 4:
        keep(*arguments[1:])
    elif arguments == ["--check"]:
        if PAGE.read_text() != page():
            raise SystemExit("docs/papers.md is not what docs/papers/ says; run scripts/papers.py")
    elif not arguments:
        PAGE.write_text(page())
    else:
        raise SystemExit(__doc__)


main(sys.argv[1:])

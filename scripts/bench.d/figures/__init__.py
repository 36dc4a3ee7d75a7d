"""Figures of scripts/bench: dicts with the keys that `touchtrace-verify --json` prints."""

import json
import math
import sys


def row(name, value, unit, goal="reported", holds=True, seconds=0.0, picture=None):
    """One figure. A value that is not finite never passes. `picture`: as in tests/verify/support/figure.h."""
    extra = {} if picture is None else dict(picture=picture)
    return dict(name=name, value=float(value), unit=unit, goal=goal, holds=bool(holds and math.isfinite(value)),
                seconds=seconds, **extra)


def at_most(name, value, unit, goal, **rest):
    return row(name, value, unit, f"<= {goal:g}", value <= goal, **rest)


def within(name, value, unit, low, high, **rest):
    return row(name, value, unit, f"in [{low:g}, {high:g}]", low <= value <= high, **rest)


def emit(figures, name_width, as_json):
    """Prints each figure as soon as it is known, on stderr if `as_json`; then stdout gets one JSON object.

    Returns the exit code: 3 if a figure fails."""
    rows = []
    for figure in figures:
        rows.append(figure)
        print(f"{figure['name']:<{name_width}} {figure['value']:>12.6g} {figure['unit']:<6} {figure['goal']:<10} "
              f"{'PASS' if figure['holds'] else 'FAIL'}", flush=True, file=sys.stderr if as_json else sys.stdout)
    if as_json:
        print(json.dumps(dict(figures=rows)))
    return 0 if all(row["holds"] for row in rows) else 3

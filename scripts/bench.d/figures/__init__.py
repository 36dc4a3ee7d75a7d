"""How an area of scripts/bench gives its figures: dicts of name, value, unit, goal and holds."""

import json
import sys


def emit(figures, name_width, as_json):
    """Prints figures as they come, on stderr if all of them go to stdout as one JSON object in the end.

    Returns the exit code: 3 if one falls short."""
    rows = []
    for figure in figures:
        rows.append(figure)
        print(f"{figure['name']:<{name_width}} {figure['value']:>12.6g} {figure['unit']:<6} {figure['goal']:<10} "
              f"{'holds' if figure['holds'] else 'FALLS SHORT'}", flush=True, file=sys.stderr if as_json else sys.stdout)
    if as_json:
        print(json.dumps(dict(figures=rows)))
    return 0 if all(row["holds"] for row in rows) else 3

# Creep, lag and saturation of pressure-sensitive film: three public data sets against the simulated glove.
# Sources: github.com/Lupasic/tactile-sensor-velostat (a Velostat taxel and a load cell), peter-kiechle/tactile-sensors
# (Weiss arrays under weights), TAMS-Group/tams_tactile_sensor_array_hardware (a taxel and a load cell).
# needs: numpy scipy
import argparse
import bz2
import json
import re
import struct
import subprocess
import sys

import numpy as np
from scipy.ndimage import median_filter
from scipy.signal import lfilter

import figures
from clones import paths, read
from figures import row

VELOSTAT = "Lupasic/tactile-sensor-velostat", "c319860", "src/experimental_data/velostat_data"
WEISS = "peter-kiechle/tactile-sensors", "7bbb341", "pressure_profiles/calibration_weight_and_temperature/chunks"
TAMS = "TAMS-Group/tams_tactile_sensor_array_hardware", "ad42434", "calibration"
STEP_S = 0.005
CREEP_TIMES_S = 0.1, 1.0, 10.0
FORMER_LAGS_S, FORMER_CREEP, FORMER_CREEP_S = (0.008, 0.03), 0.12, 2.0


def low_pass(values, time_s, step_s):
    gain = -np.expm1(-step_s / time_s)
    return lfilter([gain], [1, gain - 1], values)


def simulated(force_n, lag_s, creep, step_s=STEP_S, contact_n=0.2):
    """Conductance of a simulated taxel under a force, up to a factor."""
    lagged = low_pass(force_n, lag_s, step_s)
    is_loaded = (lagged > contact_n).astype(float)
    return lagged * (1 + creep) ** sum(low_pass(is_loaded, time_s, step_s) for time_s in CREEP_TIMES_S)


def formerly_simulated(force_n):
    """Two lags, and creep that outlives the contact."""
    rising, falling = (-np.expm1(-STEP_S / lag_s) for lag_s in FORMER_LAGS_S)
    lagged, value = np.empty_like(force_n), force_n[0]
    for i, force in enumerate(force_n):
        value += (rising if force > value else falling) * (force - value)
        lagged[i] = value
    return lagged + FORMER_CREEP * low_pass(lagged, FORMER_CREEP_S, STEP_S)


def columns(text):
    """Time [s] and value of lines "value time [remark]"."""
    rows = [line.split()[:2] for line in text.splitlines()]
    rows = [(float(time), float(value)) for value, time in (row for row in rows if len(row) == 2)]
    return np.array(rows).T if rows else np.empty((2, 0))


def velostat_runs(clones):
    """Force [N] and conductance every STEP_S."""
    for path in paths(clones, *VELOSTAT):
        if not re.search(r"/pike[1-5][^/]*/exp", path):
            continue
        try:
            sensor, load = (columns(read(clones, *VELOSTAT[:2], p)) for p in (path, path.replace("velostat_data", "futek_data")))
        except (ValueError, subprocess.CalledProcessError):
            continue
        if min(sensor.shape[1], load.shape[1]) < 100:
            continue
        time_s = np.arange(max(sensor[0, 0], load[0, 0]), min(sensor[0, -1], load[0, -1]), STEP_S)
        force_n = np.maximum(0, np.interp(time_s, load[0], median_filter(load[1], 5)))
        yield force_n, 1 / np.interp(time_s, *sensor)


def presses(force_n):
    """First and last index of presses of 1.2 to 20 s."""
    is_loaded = (force_n > 0.5 * np.percentile(force_n, 98)).astype(int)
    starts, ends = np.flatnonzero(np.diff(is_loaded) > 0), np.flatnonzero(np.diff(is_loaded) < 0)
    for start in starts:
        later = ends[ends > start]
        if len(later) and 1.2 < (later[0] - start) * STEP_S < 20:
            yield start, later[0]


def plateau(force_n, start, end):
    inside = np.flatnonzero(force_n[start:end] > 0.95 * np.median(force_n[start:end]))
    return start + inside[0], start + inside[-1]


def creep_of(runs, times_s):
    """Conductance of holds relative to that after .05 s: median and number of holds at each time."""
    ratios = [[] for _ in times_s]
    for force_n, conductance in runs:
        for press in presses(force_n):
            first, last = plateau(force_n, *press)
            if (last - first) * STEP_S < 0.9:
                continue
            for time_s, found in zip(times_s, ratios):
                at = first + round(time_s / STEP_S)
                if at < last:
                    found.append(conductance[at] / conductance[first + round(0.05 / STEP_S)])
    return [(np.median(found), len(found)) for found in ratios]


def half_force(runs):
    """Conductance relative to the median of the hold at half of its force, rising and falling, and .01 s after 3 % of it."""
    found = []
    for force_n, conductance in runs:
        for start, end in presses(force_n):
            force, hold = np.median(force_n[start:end]), np.median(conductance[start:end])
            middle = (start + end) // 2
            rises = np.flatnonzero(force_n[max(0, start - 200) : end] >= 0.5 * force)
            falls, gone = (np.flatnonzero(force_n[middle : end + 1000] < share * force) for share in (0.5, 0.03))
            if len(rises) and len(falls) and len(gone) and middle + gone[0] + 2 < len(conductance):
                at = max(0, start - 200) + rises[0], middle + falls[0], middle + gone[0] + 2
                found.append([conductance[i] / hold for i in at])
    return np.median(found, axis=0)


def model_error(runs, model):
    """Median over runs of the median |measured - simulated| over the middle of a press; a factor is fitted to each press,
    since the place of the tip changes."""
    errors = []
    for force_n, conductance in runs:
        predicted, differences = model(force_n), []
        for start, end in presses(force_n):
            part = slice(max(0, start - 160), end + 160)
            measured, expected = conductance[part], predicted[part]
            middle = np.median(measured[len(measured) // 3 : 2 * len(measured) // 3])
            differences.append((measured - expected * (measured @ expected) / (expected @ expected)) / middle)
        errors.append(np.median(np.abs(np.concatenate(differences))))
    return np.median(errors), len(errors)


def weiss_frames(data):
    """Times [s] and sums of the counts of a pressure profile."""
    text = (bz2.decompress(data) if data.startswith(b"BZh") else data).decode("latin1")
    for time_ms, frame in re.findall(r"<time_stamp>(\d+)</time_stamp>\s*<frame_data>([0-9A-Fa-f\s]*)</frame_data>", text):
        values = struct.unpack(f">{len(''.join(frame.split())) // 8}f", bytes.fromhex("".join(frame.split())))
        yield int(time_ms) / 1000, sum(value for value in values if value > 0)  # negative: number of zeros


def weiss_creep(clones, times_s):
    """Sum of the counts relative to that 1 s after the weight was set down: median over all profiles."""
    ratios = []
    for path in paths(clones, *WEISS):
        time_s, total = np.array(list(weiss_frames(read(clones, *WEISS[:2], path, binary=True)))).T
        loaded = np.flatnonzero(total > 0.3 * total.max())
        start, end = time_s[loaded[0]], time_s[loaded[-1]] - 0.3
        at = lambda t: np.interp(start + t, time_s, total) if start + t < end else np.nan
        ratios.append([at(t) / at(1) for t in times_s])
    return np.nanmedian(ratios, axis=0), len(ratios)


def tams_saturation(clones, path):
    """Exponent of conductance over force, and force at half of the full scale [N], of pairs of load cell and 10-bit reading in
    a divider with 10 kOhm. The scale of the load cell is that of the project's own calibration (160 g)."""
    load, reading = np.array([line.split()[:2] for line in read(clones, *TAMS[:2], path).splitlines()], float).T
    force_n, share = (load - 1660130) / (1667333 - 1660130) * 0.16 * 9.81, reading / 5 / 1023
    used = (force_n > 0.02) & (share > 0.03) & (share < 0.97)
    exponent, offset = np.polyfit(np.log(force_n[used]), np.log((1 - share[used]) / share[used]), 1)
    return exponent, np.exp(-offset / exponent)


def simulated_holds(lag_s, creep):
    """A press of 10 N: rising in .4 s (10 to 90 %), held 2 s or 12 s, falling in .04 s."""
    step_s, time_s = 0.001, np.arange(0, 13, 0.001)
    long_hold = simulated(10 * np.clip((time_s - 0.5) / 0.5, 0, 1), lag_s, creep, step_s)
    at = lambda t: np.interp(1 + t, time_s, long_hold)
    force_n = 10 * np.clip(np.minimum((time_s - 0.5) / 0.5, 1 - (time_s - 2.5) / 0.05), 0, 1)
    short, middle = simulated(force_n, lag_s, creep, step_s), np.median
    hold = middle(short[(force_n > 5)])
    rising, falling = np.flatnonzero(force_n >= 5)[[0, -1]]
    gone = np.flatnonzero((time_s > 2.5) & (force_n < 0.3))[0]
    return at, [short[i] / hold for i in (rising, falling, gone + 10)]


def figures_of(options):
    listed = subprocess.run([options.touchtrace, "parameters", "--json"], check=True, capture_output=True, text=True)
    values = {p["name"]: p["value"][0] for p in json.loads(listed.stdout)["parameters"]}
    lag_s, creep = values["glove-lag"], values["glove-creep"]
    runs = [run for run in velostat_runs(options.clones) if np.percentile(run[0], 98) >= 1.5]
    simulated_at, simulated_half = simulated_holds(lag_s, creep)

    times_s = 0.1, 0.5, 1.0, 2.0, 8.0
    for time_s, (ratio, count) in zip(times_s, creep_of(runs, times_s)):
        yield row(f"reading of a hold after {time_s:g} s over that after .05 s: Velostat, {count} holds", ratio, "")
        yield row(f"reading of a hold after {time_s:g} s over that after .05 s: simulated", simulated_at(time_s) / simulated_at(0.05), "")
    times_s = 2, 5, 10
    ratios, count = weiss_creep(options.clones, times_s)
    for time_s, ratio in zip(times_s, ratios):
        yield row(f"reading of a hold after {time_s} s over that after 1 s: Weiss, {count} weights", ratio, "")
        yield row(f"reading of a hold after {time_s} s over that after 1 s: simulated", simulated_at(time_s) / simulated_at(1), "")
    states = "at half force, rising", "at half force, falling", ".01 s after 3 % of the force"
    for state, measured, expected in zip(states, half_force(runs), simulated_half):
        yield row(f"reading over that of the hold, {state}: Velostat", measured, "")
        yield row(f"reading over that of the hold, {state}: simulated", expected, "")

    strong = [run for run in runs if np.percentile(run[0], 98) >= 4 and len(list(presses(run[0]))) >= 4]
    models = {"no dynamics": lambda f: f, "simulated": lambda f: simulated(f, lag_s, creep), "formerly simulated": formerly_simulated}
    for name, model in models.items():
        error, count = model_error(strong, model)
        yield row(f"median error in {count} recordings of Velostat: {name}", 100 * error, "%")
    for path in paths(options.clones, *TAMS):
        if "/10k-" in path:
            exponent, force_n = tams_saturation(options.clones, path)
            cover = path.split("/10k-")[1].split("-")[0]
            yield row(f"exponent of conductance over force: TAMS, {cover}", exponent, "")
            yield row(f"force at half of the full scale: TAMS, {cover}", force_n, "N")


def main():
    parser = argparse.ArgumentParser(description="Film sensors against the simulated glove.")
    parser.add_argument("--clones", required=True, help="folder of clones, OWNER/NAME")
    parser.add_argument("--touchtrace", default="build/release/touchtrace")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    sys.exit(figures.emit(figures_of(options), 76, options.json))


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the tables of docs/benchmarks.md that stand between markers, from the JSON of the benchmarks.

    write_benchmarks.py FOLDER            runs the benchmarks that are built in FOLDER and writes the document
    write_benchmarks.py FOLDER --check    runs none, writes nothing; status 1 where a row or column of a table is not what it
                                          would write, or names a benchmark that the program does not have

A figure is the median of five repetitions in random order; its spread is the largest less the smallest, over the median.
"""
import datetime
import json
import os
import pathlib
import platform
import re
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCUMENT = ROOT / "docs" / "benchmarks.md"
MARKER = re.compile(r"(<!-- benchmarks: (\w+) -->\n)(.*?)(<!-- end of benchmarks -->)", re.DOTALL)
REPETITIONS = 5
LEAST_S = 0.05  # of one repetition

HAND, EIGEN, PAST = "kalman/hand_unrolled_2_1", "kalman/eigen_conventional_4_2", "array/past_plain"
CERES, CHO, POLAR = "tma/ceres_225/{}", "tma/cho/levenberg_marquardt_225/{}", "tma/modified_polar/{}/{}"
NAMES = {HAND: "by hand", EIGEN: "plain Eigen conventional 4/2", PAST: "PAST in plain Eigen"}

# What is held to a goal: work, figure (or figure and what stands below it), unit, peer of the same run, largest ratio to it.
# Goals that were stated in ns are over the peer's figure of the run that they were stated beside: plain Eigen conventional 4/2
# 57 ns, Ceres 9.3 / 28.7 / 123 ms, PAST in plain Eigen 14.6 us.
GOALS = [
    ("predict + update 2/1, default form (Joseph)", "kalman/joseph_2_1", None, "ns", HAND, 1.25),
    ("4/2, default form (Joseph)", "kalman/joseph_4_2", None, "ns", EIGEN, 1.3),
    ("4/2 square root", "kalman/square_root_4_2", None, "ns", EIGEN, 150 / 57),
    ("unscented 4/2, linear", "plane/unscented_linear", None, "ns", EIGEN, 150 / 57),
    ("unscented 4/2, range and bearing", "plane/unscented_polar", None, "ns", EIGEN, 250 / 57),
    ("IMM of six modes", "plane/imm6", None, "ns", EIGEN, 1000 / 57),
    ("tracker, over its filter", "plane/tracker_cv", "plane/kalman_cv", "ns", EIGEN, 40 / 57),
    ("correction, 32 rules, plane, with covariance head, gate, kappa, over its trackers", "plane/tracker_corrected/rules:32",
     "plane/tracker_ensemble", "ns", EIGEN, 400 / 57),
    ("correction, 16 rules, on the line, over its trackers", "correction/corrected/rules:16", "correction/ensemble", "ns", EIGEN,
     200 / 57),
    *((f"TMA 225 starts, m = {m}", CHO.format(m), None, "ms", CERES.format(m), goal / ceres)
      for m, goal, ceres in ((60, 1, 9.3), (200, 2, 28.7), (1000, 9, 123))),
    *((f"TMA, one start in modified polar coordinates, m = {m}", POLAR.format("one_start", m), None, "ms", CERES.format(m), goal / ceres)
      for m, goal, ceres in ((60, 0.01, 9.3), (200, 0.04, 28.7), (1000, 0.2, 123))),
    ("array interval, the paper's, N 5 M 15", "array/subspace/implicit", None, "us", PAST, 5 / 14.6),
    ("array interval, joint with hypotheses, N 5 M 15", "array/joint/beam:8/moving_blocks:0", None, "us", PAST, 15 / 14.6),
    ("array interval, joint with hypotheses, N 8 M 15", "array/joint_growth/N:8/M:15", None, "us", PAST, 40 / 14.6),
]

# What else is timed: work, unit, figures by column.
FILTERS = ["2 / 1", "4 / 2", "4 / 1, a range"], [
    ("by hand, scalars, without a check of anything", "ns", ["kalman/hand_unrolled_2_1"]),
    ("plain Eigen, conventional", "ns", ["kalman/eigen_conventional_2_1", "kalman/eigen_conventional_4_2"]),
    ("plain Eigen, Joseph", "ns", ["kalman/eigen_joseph_2_1", "kalman/eigen_joseph_4_2"]),
    *((f"**KalmanFilter, {shown}**", "ns", [f"kalman/{form}_2_1", f"kalman/{form}_4_2", f"kalman/{form}_range_4_1"])
      for shown, form in (("Joseph (default)", "joseph"), ("conventional", "conventional"), ("square root", "square_root"))),
    ("Orocos BFL", "ns", ["kalman/bfl_2_1", "kalman/bfl_4_2"]),
    ("OpenCV cv::KalmanFilter", "ns", ["kalman/opencv_2_1", "kalman/opencv_4_2"]),
]
PLANE = ["a step"], [
    ("Kalman: constant velocity", "ns", ["plane/kalman_cv"]),
    ("Kalman: coordinated turn", "ns", ["plane/kalman_ct"]),
    ("Kalman: constant acceleration", "ns", ["plane/kalman_ca"]),
    ("Kalman: Singer", "ns", ["plane/kalman_singer"]),
    ("extended: turn rate estimated", "ns", ["plane/extended_turning"]),
    ("extended: range and bearing", "ns", ["plane/extended_polar"]),
    ("unscented: turn rate estimated", "ns", ["plane/unscented_turning"]),
    ("tracker: constant velocity", "ns", ["plane/tracker_cv"]),
    ("tracker: IMM of six modes", "ns", ["plane/tracker_imm6"]),
    ("one of eight trackers in a pack: constant velocity", "ns", ["plane/together_cv"]),
    ("one of eight trackers in a pack: IMM of six modes", "ns", ["plane/together_imm6"]),
    ("two trackers", "ns", ["plane/tracker_ensemble"]),
    ("two trackers and a correction of 32 rules", "ns", ["plane/tracker_corrected/rules:32"]),
    ("on the line: three trackers", "ns", ["correction/ensemble"]),
    ("on the line: three trackers and a correction of 16 rules", "ns", ["correction/corrected/rules:16"]),
    *((f"recurrent network of {units} units" + (" and an encoder of as many" if encoder else ""), "ns",
       [f"recurrent/gru/units:{units}/encoder:{encoder}"]) for units, encoder in ((32, 0), (48, 0), (48, 48), (64, 64))),
    *((f"LibTorch's GRUCell of {units} units, one thread, the gates alone", "ns", [f"recurrent/libtorch_gru_cell/units:{units}"]) for units in (32, 48)),
]
TMA = ["m = 60", "200", "1000"], [
    ("Ceres, 225 starts, the better of DENSE_QR and DENSE_NORMAL_CHOLESKY", "ms", [CERES.format(m) for m in (60, 200, 1000)]),
    ("**Cho's Levenberg-Marquardt, 225 starts**", "ms", [CHO.format(m) for m in (60, 200, 1000)]),
    ("**modified polar, three starts: the whole answer**", "ms", [POLAR.format("three_starts", m) for m in (60, 200, 1000)]),
    ("**modified polar, one start**", "ms", [POLAR.format("one_start", m) for m in (60, 200, 1000)]),
]
ARRAY = ["an interval"], [
    ("PAST alone, std::complex in plain Eigen", "us", [PAST]),
    ("PAST alone, ours", "us", ["array/past"]),
    ("the paper's whole interval: PAST, innovations, five filters", "us", ["array/subspace/implicit"]),
    ("the same with the M x M projector as printed", "us", ["array/subspace/projection"]),
    ("the same with Ryu's (2N + 1) systems", "us", ["array/subspace/ryu"]),
    ("joint filter with hypotheses", "us", ["array/joint/beam:8/moving_blocks:0"]),
    ("joint filter without", "us", ["array/joint/beam:1/moving_blocks:0"]),
]
TABLES = {"filters": FILTERS, "plane": PLANE, "tma": TMA, "array": ARRAY}
# The better of several of a peer's ways.
BETTER = {CERES.format(m): [f"tma/ceres_dense_qr/{m}", f"tma/ceres_dense_normal_cholesky/{m}"] for m in (60, 200, 1000)}
UNITS_S = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3}


def wanted():
    """Every benchmark that a table names."""
    for _, own, below, _, peer, _ in GOALS:
        for name in filter(None, (own, below, peer)):
            yield from BETTER.get(name, [name])
    for _, rows in TABLES.values():
        for _, _, names in rows:
            for name in names:
                yield from BETTER.get(name, [name])


def by_program():
    programs = {}
    for name in wanted():
        program, _, benchmark = name.partition("/")
        programs.setdefault(program, {})[benchmark] = None
    return programs


def listed(folder, program):
    command = [folder / f"bench_{program}", "--benchmark_list_tests=true"]
    return set(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout.split("\n"))


class Figures:
    """Seconds of every benchmark, of each repetition."""

    def __init__(self, folder):
        self.seconds = {}
        for program, names in by_program().items():
            chosen = "^(" + "|".join(map(re.escape, names)) + ")$"
            command = [folder / f"bench_{program}", f"--benchmark_filter={chosen}", f"--benchmark_repetitions={REPETITIONS}",
                       f"--benchmark_min_time={LEAST_S}", "--benchmark_enable_random_interleaving=true", "--benchmark_format=json"]
            run = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
            for entry in json.loads(run.stdout)["benchmarks"]:
                if entry.get("run_type") != "iteration":
                    continue
                if entry.get("error_occurred"):
                    raise SystemExit(f"benchmarks.md: {program}/{entry['run_name']}: {entry['error_message']}")
                seconds = next((entry[one] for one in ("per_step", "per_interval") if one in entry), None)
                if seconds is None:
                    seconds = entry["cpu_time"] * UNITS_S[entry["time_unit"]]
                self.seconds.setdefault(f"{program}/{entry['run_name']}", []).append(seconds)

    def of(self, name):
        """None where the program does not have it: a peer that is not installed."""
        those = [self.seconds[one] for one in BETTER.get(name, [name]) if one in self.seconds]
        return min(those, key=statistics.median) if those else None


def shown(seconds, unit):
    value = statistics.median(seconds) / UNITS_S[unit]
    digits = 0 if abs(value) >= 100 else 1 if abs(value) >= 10 else 2 if abs(value) >= 1 else 3
    spread = 100 * (max(seconds) - min(seconds)) / statistics.median(seconds) if statistics.median(seconds) else 0.0
    return f"{value:.{digits}f} {unit} ({spread:.0f} %)"


def goals(figures):
    lines = ["| work | now (spread) | held to | ratio | to reach | reached |", "|---|---|---|---|---|---|"]
    for work, own, below, unit, peer, goal in GOALS:
        name = NAMES.get(peer, "Ceres, 225 starts")
        cells = ["", "", ""]
        if figures:
            seconds, other = figures.of(own), figures.of(peer)
            if below:
                seconds = [a - b for a, b in zip(sorted(seconds), sorted(figures.of(below)))]
            ratio = statistics.median(seconds) / statistics.median(other) if other else None
            cells = [shown(seconds, unit)]
            cells += ["", "peer not installed"] if ratio is None else [f"{ratio:.3g}", "yes" if ratio <= goal else "no"]
        lines.append(f"| {work} | {cells[0]} | {name} | {cells[1]} | <= {goal:.3g} | {cells[2]} |")
    return "\n".join(lines) + "\n"


def table(figures, columns, rows):
    lines = ["| | " + " | ".join(columns) + " |", "|---" * (len(columns) + 1) + "|"]
    for work, unit, names in rows:
        those = [figures.of(name) if figures else None for name in names]
        cells = [shown(seconds, unit) if seconds else "" for seconds in those] + [""] * (len(columns) - len(names))
        lines.append(f"| {work} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def processor():
    found = re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    return found[1] if found else platform.machine()


def flags(folder):
    """As the benchmarks of the filters were compiled: compiler, and what of its options makes code faster or slower."""
    commands = json.loads((folder / "compile_commands.json").read_text())
    command = next(entry["command"] for entry in commands if entry["file"].endswith("bench/kalman_bench.cpp")).split()
    compiler = next(part for part in command if re.search(r"(\+\+|cc)(-\d+)?$", part))
    version = subprocess.run([compiler, "--version"], check=True, stdout=subprocess.PIPE, text=True).stdout.split("\n")[0]
    return version, " ".join(part for part in command if re.match(r"-(O|m|f|D_FORTIFY|DNDEBUG)", part))


def machine(folder):
    compiler, options = flags(folder)
    loaded = " / ".join(f"{load:.1f}" for load in os.getloadavg())
    return (f"{datetime.date.today()}, {processor()}, Linux {platform.release()}, load {loaded} before it began; {compiler}, `{options}`; "
            f"{REPETITIONS} repetitions of at least {LEAST_S} s, in random order.\n")


def shape(text):
    """Headings, the rows' names and what they are held to: what no run changes."""
    lines = [line.strip("|").split("|") for line in text.strip().splitlines()]
    if not lines:
        return None
    return lines[0], [(line[0], line[2::2] if len(line) == 6 else "") for line in lines[1:]]


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--check"]):
        raise SystemExit(__doc__)
    folder, check = pathlib.Path(sys.argv[1]).resolve(), len(sys.argv) == 3
    said = None if check else machine(folder)
    figures = None if check else Figures(folder)
    other, written = [], []

    def write(match):
        head, name, present, end = match.groups()
        written.append(name)
        if name == "machine":
            return head + (said or present) + end
        made = goals(figures) if name == "goals" else table(figures, *TABLES[name])
        if shape(made) != shape(present):
            other.append(name)
        return head + made + end

    new = MARKER.sub(write, DOCUMENT.read_text())
    if sorted(written) != sorted(["machine", "goals", *TABLES]):
        raise SystemExit(f"benchmarks.md: has markers for {', '.join(written)}; would be: machine, goals, {', '.join(TABLES)}")
    if not check:
        DOCUMENT.write_text(new)
        return
    for program, names in by_program().items():
        # Of peers that are not installed nothing can be said.
        missing = names.keys() - listed(folder, program)
        other += [f"bench_{program} has no {name}" for name in missing if not re.match(r"(opencv|bfl|ceres|libtorch)", name)]
    if other:
        raise SystemExit("benchmarks.md: write it anew with ./run bench; other rows or columns: " + ", ".join(other))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the tables of docs/results.md that stand between markers, from the JSON of `truebearing compare`.

    write_results.py PROGRAM            runs the studies as they are and writes the document
    write_results.py PROGRAM --check    runs them with three runs, writes nothing; status 1 where a table has other rows or
                                        columns than its marker gives

A marker names a study, what stands in each column and in each row:

    <!-- table: STUDY
    columns: HEADING = FIGURE | HEADING = FIGURE of TRACKER @ STUDY/SET + FIGURE
    rows: TRACKER | LABEL = TRACKER @ STUDY/SET | LABEL = TRACKER / REFERENCE
    -->
    <!-- end of table -->

A line `runs: NAME = STUDY OPTIONS | ...` before the columns lets NAME stand for a study that is run with other options than
its own, such as `--runs 1000` or `--truth LOG.csv`. A log is looked for in the folders LOGS; a table of one that is in
none of them stays as it is.

FIGURE is `rmse QUANTITY` and `metric NAME` (each with its standard error), `value NAME NAME...` (metrics and quantities' RMSE
without), `percent NAME...`, `root NAME` (of a square in dB), `over TRACKER NAME NAME...` (each over that of the tracker or
bound; `over / NAME...`: over that of the row's REFERENCE), `gain FROM TO NAME NAME...` (share of the way between two trackers), `ratio` (to plain, each quantity), `nees` or
`coverage`. NAME:600 is the metric at 600 s. A row may also be one of the study's bounds or published ones, or `@ STUDY/SET`
alone where the columns name the trackers; its study goes before the column's, to which `@ /SET` of a column adds a set.
"""
import json
import math
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCUMENT = ROOT / "docs" / "results.md"
LOGS = [ROOT / "data" / "real", ROOT.parent / "shared" / "data" / "real"]
DECIMALS = {"dB": 2, "runs": 0}
MARKER = re.compile(r"(<!-- table: (\S+)\n(?:runs: (.+)\n)?columns: (.+)\nrows: (.+)\n-->\n)((?:\|.*\n)+)(<!-- end of table -->)")


class LogIsNotHere(Exception):
    """Of a table whose study runs on a log that is no part of the project."""


def figure(value, decimals=None):
    """As the program prints them: four digits, of which no more than three stand behind the point, or three below .2."""
    if value is None:
        return ""
    if abs(value) >= 1e6:
        return f"{value:.1e}".replace("e+0", "e").replace("e+", "e")
    if decimals is None:
        size = math.floor(math.log10(abs(value))) if value else 0
        decimals = min(6, 2 - size) if 0 < abs(value) < 0.2 else min(3, max(0, 3 - size))
    return f"{value:.{decimals}f}"


def with_error(value, error, decimals=None):
    text = figure(value, decimals)
    if value is None or error is None:
        return text
    digits = max(0, 1 - math.floor(math.log10(error))) if error else 0
    return f"{text} +- {error:.{digits}f}"


def metric(tracker, name):
    """The metric's entry: over all steps, or that of NAME:TIME."""
    name, _, time = name.partition(":")
    for entry in tracker["metrics"]:
        if entry["name"] == name and entry.get("time_s") == (float(time) if time else None):
            return entry
    if not time and name in tracker:
        return {"unit": "", "value": tracker[name]}
    raise SystemExit(f"results.md: no metric \"{name}\"" + (f" at {time} s" if time else ""))


def named(tracker, name):
    """A quantity's RMSE or a metric."""
    if name in tracker.get("rmse", {}):
        return {"unit": "", "value": tracker["rmse"][name], "se": tracker["rmse_se"][name]}
    return metric(tracker, name)


def cell(results, row, what):
    kind, _, name = what.partition(" ")
    row, _, reference_of_row = row.partition(" / ")
    if row in results["bounds"] and row not in results["trackers"]:
        tracker = results["bounds"][row]
        known = {*tracker, *(entry["name"] for entry in tracker["metrics"])}
        if kind not in ("metric", "value") or any(one.partition(":")[0] not in known for one in name.split()):
            return ""
    elif row in results["trackers"]:
        tracker = results["trackers"][row]
    else:
        printed = results.get("published", {}).get(row, {}).get(name or kind)
        if kind == "root" and printed is not None:
            return figure(10 ** (printed / 20))
        return "" if printed is None else f"{printed:g}"
    if kind == "rmse":
        if name not in tracker["rmse"]:
            return ""
        return with_error(tracker["rmse"][name], tracker["rmse_se"][name])
    if kind in ("metric", "value"):
        entries = [named(tracker, one) for one in name.split()]
        return " / ".join(with_error(entry["value"], entry.get("se") if kind == "metric" else None,
                                     DECIMALS.get(entry["unit"])) for entry in entries)
    if kind == "percent":
        return " / ".join(figure(100 * named(tracker, one)["value"], 1) for one in name.split())
    if kind == "root":
        return figure(10 ** (metric(tracker, name)["value"] / 20))
    if kind == "over":
        reference, *names = name.split()
        reference = reference_of_row if reference == "/" else reference
        others = results["trackers"].get(reference) or results["bounds"][reference]
        return " / ".join(figure(named(tracker, one)["value"] / named(others, one)["value"]) for one in names)
    if kind == "gain":
        low, high, *names = name.split()
        ends = [[named(results["trackers"][end], one)["value"] for end in (low, high)] for one in names]
        return " / ".join(figure((worst - named(tracker, one)["value"]) / (worst - best))
                          for one, (worst, best) in zip(names, ends))
    if kind == "ratio":
        return " / ".join(figure(ratio) for ratio in tracker["ratio_to_plain"].values())
    if kind == "nees":
        return figure(tracker["nees"])
    if kind == "coverage":
        return figure(tracker["coverage95"])
    raise SystemExit(f"results.md: \"{what}\" is no figure: rmse, metric, value, percent, root, over, gain, ratio, nees or coverage")


class Studies:
    """The results of each study, made once for each set of options."""

    def __init__(self, program, few_runs):
        self.program, self.few_runs, self.made, self.named = program, few_runs, {}, {}

    def name(self, runs):
        """Lets `NAME = STUDY OPTIONS | ...` stand for these in what follows."""
        self.named = {name: run.split() for name, run in parts(runs)} if runs else {}

    def arguments(self, name):
        study, *options = self.named.get(name, [name])
        for at, option in enumerate(options):
            if at > 0 and options[at - 1] == "--truth":
                found = [folder / option for folder in LOGS if (folder / option).exists()]
                if not found:
                    raise LogIsNotHere(option)
                options[at] = str(found[0])
        if self.few_runs:
            for at in reversed([at for at, option in enumerate(options) if option == "--runs"]):
                del options[at:at + 2]
            options += ["--runs", "3"]  # of which one has a sharp turn
        return [study, *options]

    def results(self, place):
        name, _, part = place.partition("/")
        arguments = self.arguments(name)
        made = self.made.get(tuple(arguments))
        if made is None:
            command = [self.program, "compare", *arguments, "--quiet", "--json", "-"]
            made = json.loads(subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)
            self.made[tuple(arguments)] = made
        return made["sets"][part] if part else made


def parts(text):
    """`HEADING = WHAT | WHAT`: pairs of what is shown and what it is."""
    pairs = []
    for part in text.split(" | "):
        shown, _, what = part.rpartition(" = ")
        pairs.append((shown.strip() or what.strip(), what.strip()))
    return pairs


def column_cell(studies, study, column, tracker, own):
    """own: the place that the row names, or nothing."""
    cells = []
    for what in column.split(" + "):
        what, _, place = what.partition(" @ ")
        name, _, other = what.partition(" of ")
        where = (own or study) + place if place.startswith("/") else own or place or study
        cells.append(cell(studies.results(where), other or tracker, name))
    return ", ".join(one for one in cells if one)


def table(studies, study, columns, rows):
    first = "set" if all(row.startswith("@ ") for _, row in rows) else "tracker"
    lines = [f"| {first} | " + " | ".join(heading for heading, _ in columns) + " |", "|---" * (len(columns) + 1) + "|"]
    for label, row in rows:
        tracker, _, own = row.rpartition("@ ") if "@ " in row else (row, "", "")
        cells = [column_cell(studies, study, what, tracker.strip(), own) for _, what in columns]
        if not any(cells):
            raise SystemExit(f"results.md: \"{row}\" is no tracker, no bound and no published row of {study}")
        lines.append(f"| {label} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def shape(text):
    """Headings, labels, and which cells are filled: what does not depend on the number of runs."""
    lines = [line.strip("|").split("|") for line in text.strip().splitlines()]
    return lines[:2], [(line[0], [bool(entry.strip()) for entry in line[1:]]) for line in lines[2:]]


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--check"]):
        raise SystemExit(__doc__)
    check = len(sys.argv) == 3
    studies = Studies(str(pathlib.Path(sys.argv[1]).resolve()), check)
    text = DOCUMENT.read_text()
    other, tables = [], 0

    def written(match):
        nonlocal tables
        tables += 1
        head, study, runs, columns, rows, present, end = match.groups()
        studies.name(runs)
        try:
            made = table(studies, study, parts(columns), parts(rows))
        except LogIsNotHere as log:
            print(f"results.md: stays as it is, without {log}: {study}", file=sys.stderr)
            return match.group()
        if shape(made) != shape(present):
            other.append(study)
        return head + made + end

    new = MARKER.sub(written, text)
    if tables == 0 or tables != text.count("<!-- table:"):
        raise SystemExit(f"results.md: {text.count('<!-- table:')} markers, {tables} of them with columns, rows and an end")
    if not check:
        DOCUMENT.write_text(new)
    elif other:
        raise SystemExit("results.md: write it anew with ./run results; other rows or columns: " + ", ".join(other))


if __name__ == "__main__":
    main()

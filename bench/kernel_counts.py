#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts the instructions of the library's kernels (kernel_counts.cpp) under valgrind and holds them to stated limits.

    kernel_counts.py PROGRAM            status 1 where a kernel takes more than its limit; 77 where another compiler than the
                                        limits' built the program, so that nothing can be said
    kernel_counts.py PROGRAM --write    writes the limits anew: the counts, rounded up, and 3 % more (./run counts)

A count is of user-space instructions per step, the same in every run of one program. Valgrind 3.19 knows AVX2 and no AVX-512:
what is chosen at run time is chosen for that.
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

LIMITS = pathlib.Path(__file__).resolve().with_name("kernel_limits.json")
COUNTED = "truebearing_counted"  # the function that runs a kernel
ROOM = 1.03
SKIPPED = 77


def counts(program):
    """The compiler, and instructions per step by kernel."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", f"--toggle-collect={COUNTED}", f"--dump-after={COUNTED}",
                   f"--callgrind-out-file={folder}/counts", program]
        run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if run.returncode != 0:
            raise SystemExit(f"kernel counts: {' '.join(command)} ends with status {run.returncode}:\n{run.stderr}")
        compiler, *kernels = run.stdout.splitlines()
        found = {}
        for number, line in enumerate(kernels, 1):
            name, steps = line.split()
            text = pathlib.Path(f"{folder}/counts.{number}").read_text()
            total = re.search(r"^(?:summary|totals): (\d+)", text, re.MULTILINE)
            if COUNTED not in (re.search(r"^desc: Trigger: (.*)$", text, re.MULTILINE) or [""])[0] or not total:
                raise SystemExit(f"kernel counts: part {number} of callgrind's is not that of {name}")
            found[name] = int(total[1]) / int(steps)
    return compiler, found


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["--write"]):
        raise SystemExit(__doc__)
    write = len(sys.argv) == 3
    if not write:
        stated = json.loads(LIMITS.read_text())
        compiler = subprocess.run([sys.argv[1], "--compiler"], stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
        if compiler != stated["compiler"]:
            print(f"kernel counts: the limits are those of {stated['compiler']}, this is {compiler}: not compared")
            sys.exit(SKIPPED)
    compiler, found = counts(sys.argv[1])
    if write:
        limits = {name: math.ceil(ROOM * count) for name, count in found.items()}
        LIMITS.write_text(json.dumps({"compiler": compiler, "instructions_per_step": limits}, indent=2) + "\n")
        print("written:", LIMITS)
        return
    limits = stated["instructions_per_step"]
    faults = [f"{name} is in {LIMITS.name} and is not counted" for name in limits if name not in found]
    for name, count in found.items():
        limit = limits.get(name)
        print(f"{name:24} {count:12.1f} of {limit}")
        if limit is None:
            faults.append(f"{name} has no limit in {LIMITS.name}")
        elif count > limit:
            faults.append(f"{name} takes {count:.1f} instructions a step, its limit is {limit}")
    if faults:
        raise SystemExit("kernel counts: " + "; ".join(faults) + "; ./run counts states the limits anew where that is meant")


if __name__ == "__main__":
    main()

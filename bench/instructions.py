"""Counts the instructions of a few short workloads and compares them with those of the last change.

    instructions.py INSTRUCTIONS_BENCH COMPILER [--update]

Counted by valgrind --tool=callgrind, whose processor is the same everywhere: AVX2 without AVX-512 where the real one
has AVX2. COMPILER is what the program was built with: counts of another one are not compared. Exit code 1 when a
workload takes more than TOLERANCE above the count in instructions.json, 77 when nothing can be compared; --update
writes the counts.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

COUNTS = pathlib.Path(__file__).with_name("instructions.json")
WORKLOADS = ("fit", "draws", "grid", "csv", "projection")
TOLERANCE = 0.05
SKIPPED = 77


def skip(reason):
    print(f"instructions: not compared: {reason}", file=sys.stderr)
    sys.exit(SKIPPED)


def count(program, workload):
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("OPENBLAS_", "OMP_"))}
    done = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null",
                           "--toggle-collect=run_counted*", program, workload],
                          env=environment | {"OPENBLAS_NUM_THREADS": "1", "OPENBLAS_CORETYPE": "Haswell"},
                          capture_output=True, text=True, check=False)
    found = re.search(r"Collected\s*:\s*(\d+)", done.stderr)
    if done.returncode != 0 or found is None or int(found[1]) == 0:
        sys.exit(f"instructions: {workload}: {done.stderr.strip()}")
    return int(found[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("compiler")
    parser.add_argument("--update", action="store_true")
    arguments = parser.parse_args()
    if shutil.which("valgrind") is None:
        skip("valgrind is missing (scripts/install-dependencies bench)")
    if " avx2 " not in pathlib.Path("/proc/cpuinfo").read_text():
        skip("the processor has no AVX2")
    known = json.loads(COUNTS.read_text()) if COUNTS.exists() else {"compiler": "", "instructions": {}}
    if not arguments.update and known["compiler"] != arguments.compiler:
        skip(f"the counts are those of {known['compiler']}, the program is {arguments.compiler}'s")
    counts = {workload: count(arguments.program, workload) for workload in WORKLOADS}
    print("| Workload | Instructions | Before | Ratio |\n|---|--:|--:|--:|")
    above = []
    for workload, instructions in counts.items():
        before = known["instructions"].get(workload)
        ratio = instructions / before if before else 1.0
        print(f"| {workload} | {instructions:,} | {before or 0:,} | {ratio:.3f} |")
        if before is None or ratio > 1.0 + TOLERANCE:
            above.append(workload)
    if arguments.update:
        COUNTS.write_text(json.dumps({"compiler": arguments.compiler, "instructions": counts}, indent=1) + "\n")
    elif above:
        sys.exit(f"instructions: more than before: {', '.join(above)}; --update when it is meant to be so")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Every use of the program, however hostile, ends in a sentence and an exit code, and nothing is lost.

Usage: hostile_uses_test.py PROGRAM SOURCE_FOLDER [NAME]...     (names, or beginnings of names, of rows)
"""
import concurrent.futures
import os
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import content_rows  # noqa: E402
import option_rows  # noqa: E402
import system_rows  # noqa: E402
from runner import Failure, Runner, Skip  # noqa: E402


def outcome(runner, row):
    start = time.monotonic()
    try:
        runner.run(row)
        return row.name, "", time.monotonic() - start
    except Skip as reason:
        return row.name, f"skipped: {reason}", time.monotonic() - start
    except (Failure, ValueError, OSError) as failure:
        return row.name, f"FAILED: {failure}", time.monotonic() - start


def main():
    program, source, *wanted = sys.argv[1:]
    rows = [*option_rows.rows(), *content_rows.rows(), *system_rows.rows(source)]
    names = [row.name for row in rows]
    doubled = {name for name in names if names.count(name) > 1}
    if doubled:
        sys.exit(f"two rows are named {doubled}")
    if wanted:
        rows = [row for row in rows if row.name.startswith(tuple(wanted))]
    runner = Runner(os.path.abspath(program), os.path.join(source, "tests/data/small"))
    failed = skipped = 0
    slowest = []
    try:
        with concurrent.futures.ThreadPoolExecutor(max(2, os.cpu_count() or 1)) as pool:
            for name, said, seconds in pool.map(lambda row: outcome(runner, row), rows):
                failed += said.startswith("FAILED")
                skipped += said.startswith("skipped")
                slowest.append((seconds, name))
                if said:
                    print(f"{name}: {said}")
    finally:
        runner.close()
    print("slowest: " + ", ".join(f"{name} {seconds:.1f} s" for seconds, name in sorted(slowest)[:-4:-1]))
    print(f"{len(rows)} hostile uses, {failed} failed, {skipped} skipped")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()

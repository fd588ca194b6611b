"""Times the fit of the reference problem against scipy and against Ceres with one residual block per reading.

    fit_against_scipy.py FIT_BENCH [--sizes 4752,12960,...] [--noisy] [--write PAGE]

Every figure is from this run on this machine. Both sides start at the same parameters and stop at the same cost
to 1e-11. When other programs used the processors during a measurement it is repeated, and in the end refused
(exit code 3); --noisy quotes it with a mark instead. --write puts the figures between the marks of a page.
"""

import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

import quiet_machine
from quiet_machine import environment, free_bytes, merged, milliseconds

HERE = pathlib.Path(__file__).parent
GRIDS = {4752: (11, 9, 8), 12960: (15, 12, 12), 100776: (34, 26, 19), 1003104: (72, 54, 43)}
SAME_COST = 1e-9            # between the two programs, at the solution
SAME_JACOBIAN = 1e-7        # of central differences, relative to a column's largest element
SCIPY_BYTES = 11_000        # memory that scipy needs per reading
MARK = "<!-- figures: written by scripts/bench -->"


class Bench:
    def __init__(self, machine, fit_bench):
        self.machine, self.fit_bench = machine, fit_bench

    def run(self, command, threads):
        return self.machine.run(command, threads)

    def volcal(self, readings, threads, repeats, target, solver="compressed"):
        grid = [str(n) for n in GRIDS[readings]]
        return self.run([self.fit_bench, *grid, "--threads", str(threads), "--repeats", str(repeats),
                         "--target", repr(target), "--solver", solver], threads)

    def scipy(self, folder, threads, repeats, x_scale):
        return self.run([sys.executable, str(HERE / "scipy_fit.py"), folder, "--repeats", str(repeats),
                         "--x-scale", x_scale], threads)

    def faster_scale(self, folder):
        """The scaling of the parameters that serves scipy better here."""
        times = {scale: statistics.median(self.scipy(folder, 2, 3, scale)["fit_s"]) for scale in ("1", "jac")}
        return min(times, key=times.get)


def check(folder):
    """The two programs must solve the same problem."""
    done = subprocess.run([sys.executable, str(HERE / "scipy_fit.py"), folder, "--check"],
                          env=environment(1), capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    if abs(found["cost_difference"]) > SAME_COST or found["jacobian_difference"] > SAME_JACOBIAN:
        sys.exit(f"fit_against_scipy: the programs do not solve the same problem: {found}")
    return found


def measure(bench, readings, repeats, rounds, scipy_repeats):
    """Rows of the table for one size: (name, threads, figures)."""
    with tempfile.TemporaryDirectory() as folder:
        grid = [str(n) for n in GRIDS[readings]]
        target = bench.run([bench.fit_bench, *grid, "--repeats", "1", "--write", folder], 1)["target"]
        same = check(folder) if readings < 100_000 else None
        x_scale = bench.faster_scale(folder) if readings < 100_000 else "1"
        runs = {}
        scipy_fits = SCIPY_BYTES * readings < free_bytes()
        for _ in range(rounds):
            for threads in (1, 2):
                if scipy_fits:
                    runs.setdefault(("scipy TRF", threads), []).append(
                        bench.scipy(folder, threads, scipy_repeats, x_scale))
                if readings == min(GRIDS):
                    runs.setdefault(("one block per reading", threads), []).append(
                        bench.volcal(readings, threads, 2, target, "per-reading"))
                runs.setdefault(("volcal", threads), []).append(
                    bench.volcal(readings, threads, repeats, target))
        if not scipy_fits:
            print(f"scipy was not run on {readings} readings: it needs {SCIPY_BYTES * readings / 1e9:.0f} GB "
                  f"and {free_bytes() / 1e9:.0f} GB are free", file=sys.stderr)
    return {key: merged(parts) for key, parts in runs.items()}, same, x_scale


def table(results):
    lines = ["| Readings | Program | Threads | Set-up, ms | Fit, ms | n | scipy / fit | scipy / both | Peak, MB |",
             "|--:|---|--:|--:|--:|--:|--:|--:|--:|"]
    for readings, rows in results.items():
        for (name, threads), figures in rows.items():
            setup, fit = (statistics.median(figures[key]) for key in ("setup_s", "fit_s"))
            peer = rows.get(("scipy TRF", threads))
            ratios = ["", ""]
            if peer is not None and name != "scipy TRF":
                peer_setup, peer_fit = (statistics.median(peer[key]) for key in ("setup_s", "fit_s"))
                ratios = [f"{peer_fit / fit:.1f}", f"{(peer_setup + peer_fit) / (setup + fit):.1f}"]
            mark = " (noisy)" if figures["marked"] else ""
            lines.append(f"| {readings:,} | {name}{mark} | {threads} | {milliseconds(figures['setup_s'])} | "
                         f"{milliseconds(figures['fit_s'])} | {len(figures['fit_s'])} | {ratios[0]} | {ratios[1]} | "
                         f"{figures['peak_bytes'] / 1e6:,.0f} |")
    return "\n".join(lines)


def conditions(bench, results, checks):
    any_row = next(iter(results.values()))
    volcal, scipy = any_row[("volcal", 2)], any_row.get(("scipy TRF", 2), {})
    lines = [bench.machine.conditions(f"{volcal['blas']} (volcal), {scipy.get('blas', 'not run')} (scipy)")]
    for readings, (same, x_scale) in checks.items():
        if same is not None:
            lines.append(f"{readings:,} readings: costs at the solution differ by {abs(same['cost_difference']):.0e}, "
                         f"scipy's Jacobian from central differences by {same['jacobian_difference']:.0e} "
                         f"(relative); scipy with x_scale = {x_scale}.")
    return "  \n".join(lines)


def measured_text(bench, sizes):
    results, checks = {}, {}
    for size in sizes:
        million = size > 500_000
        rows, same, x_scale = measure(bench, size, repeats=5, rounds=3 if size < 10_000 else 1,
                                      scipy_repeats=1 if million else 5)
        results[size], checks[size] = rows, (same, x_scale)
    return conditions(bench, results, checks) + "\n\n" + table(results)


def main():
    parser = quiet_machine.parser(__doc__)
    parser.add_argument("fit_bench")
    parser.add_argument("--sizes", default=",".join(map(str, GRIDS)), help="default: %(default)s")
    arguments = parser.parse_args()
    sizes = [int(size) for size in arguments.sizes.split(",")]
    quiet_machine.main("fit_against_scipy",
                       lambda machine: measured_text(Bench(machine, arguments.fit_bench), sizes), MARK, arguments)


if __name__ == "__main__":
    main()

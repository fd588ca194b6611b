"""Times draws of a Monte Carlo study: linear ones beside the matrix product alone, nonlinear ones beside refits.

    montecarlo_against_refits.py MONTECARLO_BENCH FIT_BENCH [--rounds N] [--noisy] [--write PAGE]

The reference problem of the fit's benchmark. A cold refit is scipy's (bench/scipy_fit.py), with as many threads.
When other programs used the processors during a measurement it is repeated, and in the end refused (exit code 3);
--noisy quotes it with a mark instead. --write puts the figures between the marks of a page.
"""

import pathlib
import statistics
import sys
import tempfile

import quiet_machine

HERE = pathlib.Path(__file__).parent
GRID = ("11", "9", "8")
THREADS = (1, 2)
MARK = "<!-- figures: written by scripts/bench --montecarlo -->"


def cold_fits_per_second(machine, fit_bench, rounds):
    """Of scipy, by threads."""
    with tempfile.TemporaryDirectory() as folder:
        machine.run([fit_bench, *GRID, "--repeats", "1", "--write", folder], 1)
        return {threads: 1.0 / statistics.median(
            machine.run([sys.executable, str(HERE / "scipy_fit.py"), folder, "--repeats", str(rounds)],
                        threads)["fit_s"]) for threads in THREADS}


def lines_of(figures, cold, threads):
    rate = {key: statistics.median(figures[f"{key}_per_s"]) for key in ("linear", "product", "chord", "refit")}
    mark = " (noisy)" if figures["marked"] else ""
    return [f"| linear{mark} | {threads} | {rate['linear']:,.0f} | {1e6 / rate['linear']:.1f} s for 10^6 | "
            f"{rate['linear'] / rate['product']:.2f} of the product |",
            f"| the matrix product alone | {threads} | {rate['product']:,.0f} | | |",
            f"| chord steps{mark} | {threads} | {rate['chord']:,.0f} | {1e5 / rate['chord']:.1f} s for 10^5 | "
            f"{rate['chord'] / rate['refit']:.0f} times warm refits, {rate['chord'] / cold:.0f} times scipy |",
            f"| full refits, warm start | {threads} | {rate['refit']:,.1f} | | |",
            f"| scipy TRF, cold | {threads} | {cold:,.1f} | | |"]


def measured_text(machine, arguments):
    cold = cold_fits_per_second(machine, arguments.fit_bench, arguments.rounds)
    runs = {threads: machine.run([arguments.montecarlo_bench, "--threads", str(threads), "--rounds",
                                  str(arguments.rounds)], threads) for threads in THREADS}
    first = runs[THREADS[0]]
    peak = max(figures["peak_bytes"] for figures in runs.values())
    table = ["| Draws | Threads | Per second | Takes | Ratio |", "|---|--:|--:|--:|---|"]
    for threads, figures in runs.items():
        table += lines_of(figures, cold[threads], threads)
    return "\n".join([machine.conditions(first["blas"]) + "  ",
                      f"{first['readings']:,} readings, {first['parameters']} parameters, {first['quantities']} "
                      f"quantities and {first['components']} components in the volume; peak memory "
                      f"{peak / 1e6:.0f} MB; medians of {arguments.rounds} interleaved rounds.", "", *table])


def main():
    parser = quiet_machine.parser(__doc__)
    parser.add_argument("montecarlo_bench")
    parser.add_argument("fit_bench")
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    quiet_machine.main("montecarlo_against_refits", lambda machine: measured_text(machine, arguments), MARK,
                       arguments)


if __name__ == "__main__":
    main()

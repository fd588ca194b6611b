"""Times the fit of the reference problem against scipy and against Ceres with one residual block per reading.

    fit_against_scipy.py FIT_BENCH [--sizes 4752,12960,...] [--noisy] [--write PAGE]

Every figure is from this run on this machine. Both sides start at the same parameters and stop at the same cost
to 1e-11. When other programs used the processors during a measurement it is repeated, and in the end refused
(exit code 3); --noisy quotes it with a mark instead. --write puts the figures between the marks of a page.
"""

import argparse
import json
import os
import pathlib
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).parent
GRIDS = {4752: (11, 9, 8), 12960: (15, 12, 12), 100776: (34, 26, 19), 1003104: (72, 54, 43)}
SAME_COST = 1e-9            # between the two programs, at the solution
SAME_JACOBIAN = 1e-7        # of central differences, relative to a column's largest element
OTHERS = 0.1                # processor seconds per second that other programs may use
ATTEMPTS = 5
SCIPY_BYTES = 11_000        # memory that scipy needs per reading
MARKS = ("<!-- figures: written by scripts/bench -->", "<!-- end of figures -->")


class Noise(Exception):
    pass


def busy_seconds():
    """Processor time used by everything since the machine started, s."""
    user, nice, system, _idle, _wait, irq, softirq, steal = map(
        int, pathlib.Path("/proc/stat").read_text().splitlines()[0].split()[1:9])
    return (user + nice + system + irq + softirq + steal) / os.sysconf("SC_CLK_TCK")


def own_seconds():
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def load_of_others(work):
    """Result of work() and the processor seconds per second that other programs used meanwhile."""
    clock, busy, own = time.monotonic(), busy_seconds(), own_seconds()
    result = work()
    elapsed = time.monotonic() - clock
    return result, max(0.0, busy_seconds() - busy - (own_seconds() - own)) / elapsed


def free_bytes():
    for line in open("/proc/meminfo"):
        if line.startswith("MemAvailable:"):
            return 1024 * int(line.split()[1])
    raise RuntimeError("/proc/meminfo has no MemAvailable")


def environment(threads):
    clean = {key: value for key, value in os.environ.items()
             if not key.startswith(("OPENBLAS_", "GOTO_", "OMP_", "MKL_"))}
    return clean | {"OPENBLAS_NUM_THREADS": str(threads)}


class Bench:
    def __init__(self, fit_bench, noisy):
        self.fit_bench, self.noisy = fit_bench, noisy
        self.marked = False
        self.most_noise = 0.0

    def run(self, command, threads):
        """JSON of a program that had the machine to itself."""
        def work():
            done = subprocess.run(command, env=environment(threads), capture_output=True, text=True, check=False)
            if done.returncode != 0:
                sys.exit(f"fit_against_scipy: {' '.join(command)}: {done.stderr.strip()}")
            return json.loads(done.stdout)

        for attempt in range(ATTEMPTS):
            figures, others = load_of_others(work)
            if others <= OTHERS or self.noisy:
                break
            time.sleep(5.0 * (attempt + 1))
        else:
            raise Noise(f"other programs used {others:.2f} processors during {' '.join(command)}")
        self.most_noise = max(self.most_noise, others)
        self.marked |= others > OTHERS
        return figures | {"marked": others > OTHERS}

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


def merged(parts):
    """One set of figures out of several runs of the same program."""
    total = dict(parts[0])
    for key in ("setup_s", "fit_s", "converged_s"):
        if key in total:
            total[key] = [value for part in parts for value in part[key]]
    total["peak_bytes"] = max(part["peak_bytes"] for part in parts)
    total["marked"] = any(part["marked"] for part in parts)
    return total


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


def milliseconds(seconds):
    value = 1e3 * statistics.median(seconds)
    return f"{value:.2f}" if value < 10 else f"{value:.1f}" if value < 1000 else f"{value:,.0f}"


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


def processor():
    for line in open("/proc/cpuinfo"):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def conditions(bench, results, checks):
    any_row = next(iter(results.values()))
    volcal, scipy = any_row[("volcal", 2)], any_row.get(("scipy TRF", 2), {})
    lines = [f"{time.strftime('%Y-%m-%d')}; {processor()}, {os.cpu_count()} processors; "
             f"BLAS core {volcal['blas']} (volcal), {scipy.get('blas', 'not run')} (scipy); "
             f"load average {os.getloadavg()[0]:.2f}; other programs used at most {bench.most_noise:.2f} processors "
             f"during a measurement." + (" **Some figures are marked noisy.**" if bench.marked else "")]
    for readings, (same, x_scale) in checks.items():
        if same is not None:
            lines.append(f"{readings:,} readings: costs at the solution differ by {abs(same['cost_difference']):.0e}, "
                         f"scipy's Jacobian from central differences by {same['jacobian_difference']:.0e} "
                         f"(relative); scipy with x_scale = {x_scale}.")
    return "  \n".join(lines)


def write(page, text):
    content = page.read_text()
    begin, end = (content.index(mark) for mark in MARKS)
    page.write_text(content[:begin + len(MARKS[0])] + "\n\n" + text + "\n\n" + content[end:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fit_bench")
    parser.add_argument("--sizes", default=",".join(map(str, GRIDS)), help="default: %(default)s")
    parser.add_argument("--noisy", action="store_true")
    parser.add_argument("--write", type=pathlib.Path)
    arguments = parser.parse_args()
    bench = Bench(arguments.fit_bench, arguments.noisy)
    _, others = load_of_others(lambda: time.sleep(1.0))
    try:
        if others > OTHERS and not arguments.noisy:
            raise Noise(f"other programs use {others:.2f} processors")
        results, checks = {}, {}
        for size in map(int, arguments.sizes.split(",")):
            million = size > 500_000
            rows, same, x_scale = measure(bench, size, repeats=5, rounds=3 if size < 10_000 else 1,
                                          scipy_repeats=1 if million else 5)
            results[size], checks[size] = rows, (same, x_scale)
    except Noise as noise:
        print(f"fit_against_scipy: no figures: {noise}; try again later, or quote them as --noisy", file=sys.stderr)
        sys.exit(3)
    text = conditions(bench, results, checks) + "\n\n" + table(results)
    print(text)
    if arguments.write:
        write(arguments.write, text)


if __name__ == "__main__":
    main()

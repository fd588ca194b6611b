"""Times model criticism: the projection of candidate effects against numpy, and the whole of `volcal diagnose`.

    projection_against_numpy.py CRITICISM_BENCH VOLCAL [--grid NX,NY,NZ] [--diagnose NX,NY,NZ ...] [--repeats N]
                                [--rounds N] [--noisy] [--write PAGE]

Both sides project the same arrays (criticism_bench --write) with the same number of threads, one program after the
other in every round; their LM must agree to 1e-6. When other programs used the processors during a measurement it
is repeated, and in the end refused (exit code 3); --noisy quotes it with a mark instead. --write puts the figures
between the marks of a page.
"""

import pathlib
import statistics
import sys
import tempfile

import quiet_machine
from quiet_machine import command_figures, merged, milliseconds

HERE = pathlib.Path(__file__).parent
REFERENCE = "9,7,6"         # 8 runs of 756 readings
HUNDRED_THOUSAND = "25,25,10"
RUNS = 8                    # of the simulated campaign: stations and tools
SAME_LM = 1e-6              # of every shape, relative to 1 + LM
THREADS = (1, 2)
MARK = "<!-- figures: written by scripts/bench --criticism -->"

STUDY = """format = "volcal-study-1"
machine = "{machine}"
seed = 31

[truth]
kind = "random"
volumetric_rms_um = [15.5, 21.5]

[[temperatures]]
channel = "column"
start_degC = 20.0
amplitude_K = 3.0
period_s = 86400.0

[[measurements]]
kind = "laser-tracer"
grid = [{grid}]
noise = {{ constant_um = 0.25, per_metre_um = 0.3, repeatability_um = 0.6 }}

[validation]
points = 10
"""


def readings_of(grid):
    count = 2 * RUNS
    for points in grid.split(","):
        count *= int(points)
    return count


def measure_projection(machine, arguments):
    """Figures by program and threads."""
    runs = {}
    with tempfile.TemporaryDirectory() as folder:
        def volcal(threads, repeats, *more):
            return machine.run([arguments.criticism_bench, "--threads", str(threads), "--repeats", str(repeats),
                                "--grid", arguments.grid, *more], threads)

        volcal(1, 1, "--write", folder)
        for _ in range(arguments.rounds):
            for threads in THREADS:
                numpy = machine.run([sys.executable, str(HERE / "numpy_projection.py"), folder,
                                     str(arguments.repeats)], threads)
                if numpy["difference"] > SAME_LM:
                    sys.exit(f"projection_against_numpy: LM of the two programs differs by {numpy['difference']:.1e}")
                runs.setdefault(("numpy", threads), []).append(numpy)
                runs.setdefault(("volcal", threads), []).append(volcal(threads, arguments.repeats))
    return {key: merged(parts) for key, parts in runs.items()}


def measure_diagnose(machine, program, grid, repeats):
    """The whole command on a simulated campaign: reading files, fit, diagnosis, report."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "study.toml").write_text(
            STUDY.format(machine=(HERE.parent / "datasets/demo/machine.toml").as_posix(), grid=grid))
        command_figures([program, "simulate", str(folder / "study.toml"), "-o", str(folder / "campaign")], THREADS[-1])
        command = [program, "diagnose", str(folder / "campaign/campaign.toml"), "--threads", str(THREADS[-1]),
                   "-o", str(folder / "diagnosis")]
        return merged([machine.run(command, THREADS[-1], command_figures) for _ in range(repeats)])


def mark(figures):
    return " (noisy)" if figures["marked"] else ""


def projection_table(rows):
    lines = ["| Program | Threads | Set-up, ms | Projection, ms | n | numpy / projection | numpy / both | Peak, MB |",
             "|---|--:|--:|--:|--:|--:|--:|--:|"]
    for (name, threads), figures in rows.items():
        setup, step = (statistics.median(figures[key]) for key in ("setup_s", "projection_s"))
        ratios = ["", ""]
        if name == "volcal":
            peer_setup, peer_step = (statistics.median(rows[("numpy", threads)][key])
                                     for key in ("setup_s", "projection_s"))
            ratios = [f"{peer_step / step:.1f}", f"{(peer_setup + peer_step) / (setup + step):.1f}"]
        lines.append(f"| {name}{mark(figures)} | {threads} | {milliseconds([setup])} | {milliseconds([step])} | "
                     f"{len(figures['projection_s'])} | {ratios[0]} | {ratios[1]} | "
                     f"{figures['peak_bytes'] / 1e6:,.0f} |")
    return lines


def step_rows(rows):
    for (name, threads), figures in rows.items():
        for key, what in (("families_s", "score tests of the catalogue, columns computed"),
                          ("generic_s", "both generic scans")):
            if name == "volcal":
                yield (figures["readings"], what, threads, figures[key], figures)


def steps_table(rows):
    lines = ["| Readings | What | Threads | Time, s | n | Peak, MB |", "|--:|---|--:|--:|--:|--:|"]
    for readings, what, threads, times, figures in rows:
        lines.append(f"| {readings:,} | {what}{mark(figures)} | {threads} | {statistics.median(times):.3g} | "
                     f"{len(times)} | {figures['peak_bytes'] / 1e6:,.0f} |")
    return lines


def measured_text(machine, arguments):
    rows = measure_projection(machine, arguments)
    whole = []
    for grid in arguments.diagnose:
        readings = readings_of(grid)
        figures = measure_diagnose(machine, arguments.volcal, grid, 1 if readings > 50_000 else arguments.rounds)
        whole.append((readings, "`volcal diagnose`, all of it", THREADS[-1], figures["whole_s"], figures))
    volcal, numpy = rows[("volcal", 1)], rows[("numpy", 1)]
    lines = [machine.conditions(f"{volcal['blas']} (volcal), {numpy['blas']} (numpy)") + "  ",
             f"{volcal['readings']:,} readings, {volcal['parameters']} parameters; {volcal['families']} effects at "
             f"{volcal['shapes']:,} shapes, {volcal['columns']:,} columns; LM of the two programs differs by "
             f"{numpy['difference']:.0e}.", "", *projection_table(rows), "", *steps_table([*step_rows(rows), *whole])]
    return "\n".join(lines)


def main():
    parser = quiet_machine.parser(__doc__)
    parser.add_argument("criticism_bench")
    parser.add_argument("volcal")
    parser.add_argument("--grid", default=REFERENCE, help="positions per axis of a run; default: %(default)s")
    parser.add_argument("--diagnose", nargs="*", default=[REFERENCE, HUNDRED_THOUSAND], metavar="NX,NY,NZ",
                        help="grids of the campaigns that are diagnosed; default: %(default)s")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    quiet_machine.main("projection_against_numpy", lambda machine: measured_text(machine, arguments), MARK, arguments)


if __name__ == "__main__":
    main()

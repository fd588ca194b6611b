"""Times what an identified machine is evaluated with, against numpy, Ceres and the machine's own limits.

    evaluation_against_numpy.py EVALUATION_BENCH PROGRAM_BENCH [--repeats N] [--rounds N] [--noisy] [--write PAGE]

Programs that are compared run one after the other in every round. Results must agree: covariances to 1e-9 of the
largest, numbers of a file to rounding. When other programs used the processors during a measurement it is repeated,
and in the end refused (exit code 3); --noisy quotes it with a mark instead. --write puts the figures between the
marks of a page.
"""

import pathlib
import statistics
import sys
import tempfile

import quiet_machine
from quiet_machine import merged, milliseconds

HERE = pathlib.Path(__file__).parent
THREADS = (1, 2)
SAME_COVARIANCE = 1e-9  # of the largest, or of u_i u_j
SAME_SUM = 1e-12
SAME_ERROR = 1e-8       # m, of second order
AXES = (3, 5)
BYTES = 24              # of an error vector
MARK = "<!-- figures: written by scripts/bench --evaluation -->"


class Measured:
    """Figures of the parts of evaluation_bench and of numpy, by part and threads."""

    def __init__(self, machine, arguments):
        self.parts = {}
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(arguments.rounds):
                for threads in THREADS:
                    self._round(machine, arguments, folder, threads)
        self.parts = {key: merged(parts) for key, parts in self.parts.items()}

    def _round(self, machine, arguments, folder, threads):
        def own(part):
            return self._add(part, threads, machine.run(
                [arguments.evaluation_bench, part, "--folder", folder, "--threads", str(threads), "--repeats",
                 str(arguments.repeats)], threads))

        def numpy(part, *more):
            return self._add(f"numpy {part}", threads, machine.run(
                [sys.executable, str(HERE / "numpy_evaluation.py"), part, folder, *map(str, more),
                 str(arguments.repeats)], threads))

        require("the covariances of the parameters", own("covariance")["difference"], SAME_COVARIANCE)
        parameters = own("volume")["parameters"]
        require("the covariances on the grid", numpy("volume", parameters)["difference"], SAME_COVARIANCE)
        own("field")
        if threads > 1:
            return
        own("points")
        own("effect")
        self._add("program", threads, machine.run([arguments.program_bench], threads))
        own("grid_file")
        for axes in AXES:
            require("twists and transforms, m,", own(f"transforms_{axes}")["largest_difference_m"], SAME_ERROR)
        mine, theirs = own("csv"), numpy("csv")
        require("the sums of the file's numbers", abs(mine["sum"] / theirs["sum"] - 1.0), SAME_SUM)

    def _add(self, part, threads, figures):
        self.parts.setdefault((part, threads), []).append(figures)
        return figures


def require(what, difference, limit):
    if not difference <= limit:
        sys.exit(f"evaluation_against_numpy: {what} differ by {difference:.1e}")


def median(figures, name):
    return statistics.median(figures[f"{name}_s"])


def mark(figures):
    return " (noisy)" if figures["marked"] else ""


def covariance_rows(parts):
    for threads in THREADS:
        figures = parts[("covariance", threads)]
        yield (f"covariance of {figures['parameters']} parameters, {figures['readings']:,} readings{mark(figures)}",
               threads, f"{milliseconds(figures['own_s'])} ms", f"ceres::Covariance, SPARSE_QR: "
               f"{milliseconds(figures['ceres_s'])} ms", f"{median(figures, 'ceres') / median(figures, 'own'):.0f}")


def volume_rows(parts):
    for threads in THREADS:
        own, numpy = parts[("volume", threads)], parts[("numpy volume", threads)]
        yield (f"3 x 3 covariances at {own['nodes']:,} nodes{mark(own)}", threads,
               f"{milliseconds(own['own_s'])} ms", f"numpy, rows given: {milliseconds(numpy['numpy_s'])} ms",
               f"{median(numpy, 'numpy') / median(own, 'own'):.1f}")


def field_rows(parts):
    for threads in THREADS:
        figures = parts[("field", threads)]
        time = median(figures, "own")
        limit = min(median(figures, "ordinary"), median(figures, "streaming"))
        rates = [BYTES * figures["points"] / median(figures, name) / 1e9 for name in ("ordinary", "streaming")]
        yield (f"errors at {figures['points']:,} nodes{mark(figures)}", threads,
               f"{figures['points'] / time / 1e6:,.0f} Mpoint/s",
               f"writing as many bytes: {rates[0]:.1f} GB/s ordinary, {rates[1]:.1f} GB/s streaming stores",
               f"{limit / time:.2f} of the limit")


def points_rows(parts):
    figures = parts[("points", 1)]
    yield (f"errors at {figures['points']:,} points at random, 3 axes{mark(figures)}", 1,
           f"{figures['points'] / median(figures, 'own') / 1e6:.1f} Mpoint/s",
           f"joint by joint along the chain: {figures['points'] / median(figures, 'plain') / 1e6:.1f} Mpoint/s",
           f"{median(figures, 'plain') / median(figures, 'own'):.1f}")


def csv_rows(parts):
    own, numpy = parts[("csv", 1)], parts[("numpy csv", 1)]
    peer = median(numpy, "numpy")
    for name, what in (("reader", "readings"), ("parser", "numbers alone, text in memory")):
        time = median(own, name)
        yield (f"CSV of {own['readings']:,} readings: {what}{mark(own)}", 1, f"{own['bytes'] / time / 1e6:,.0f} MB/s",
               f"numpy.loadtxt: {own['bytes'] / peer / 1e6:,.0f} MB/s", f"{peer / time:.1f}")


def grid_file_rows(parts):
    figures = parts[("grid_file", 1)]
    own, write = median(figures, "own"), median(figures, "write")
    yield (f"spatial grid of {figures['points']:,} points for {figures['tools']} tools as CSV, "
           f"{figures['bytes'] / 1e9:.2f} GB{mark(figures)}", 1,
           f"{own:.1f} s", f"writing as many bytes: {write:.2f} s", f"{own / write:.1f} times as long")


def effect_table(parts):
    figures, program = parts[("effect", 1)], parts[("program", 1)]
    lines = ["| What | without | with the effect | times |", "|---|--:|--:|--:|"]
    for name, what in (("covariances", f"3 x 3 covariances at {figures['nodes']:,} nodes, ms"),
                       ("grid_file", f"spatial grid of {figures['file_points']:,} points for three tools, as text, ms"),
                       ("points", f"errors at {figures['points']:,} points at random, one by one, ms")):
        rigid, extended = figures[f"{name}_s"], figures[f"{name}_effect_s"]
        lines.append(f"| {what}{mark(figures)} | {milliseconds(rigid)} | {milliseconds(extended)} "
                     f"| {statistics.median(extended) / statistics.median(rigid):.2f} |")
    plain, extended = (median(program, name) for name in ("rewritten", "rewritten_effect"))
    lines.append(f"| `volcal compensate`, {program['lines']:,} short blocks, ms{mark(program)} | {1e3 * plain:,.0f} "
                 f"| {1e3 * extended:,.0f} | {extended / plain:.2f} |")
    return lines


def transforms_table(parts):
    lines = ["| Axes | Exact transforms | Small angles | Twists, pose by pose | Twists side by side | Ratio to exact |",
             "|--:|--:|--:|--:|--:|--:|"]
    for axes in AXES:
        figures = parts[(f"transforms_{axes}", 1)]
        rates = {name: figures["points"] / median(figures, name) / 1e6
                 for name in ("exact", "small", "twists", "lanes")}
        lines.append(f"| {axes}{mark(figures)} | " + " | ".join(f"{rate:.1f}" for rate in rates.values())
                     + f" | {rates['lanes'] / rates['exact']:.1f} |")
    return lines


def measured_text(machine, arguments):
    parts = Measured(machine, arguments).parts
    table = ["| What | Threads | volcal | Peer | Ratio |", "|---|--:|--:|---|--:|"]
    for rows in (covariance_rows, volume_rows, field_rows, points_rows, csv_rows, grid_file_rows):
        table += ["| " + " | ".join(map(str, row)) + " |" for row in rows(parts)]
    own, numpy = parts[("volume", 1)], parts[("numpy volume", 1)]
    repeats = len(own["own_s"])
    return "\n".join([machine.conditions(f"{own['blas']} (volcal), {numpy['blas']} (numpy)") + "  ",
                      f"Covariances differ by {parts[('covariance', 1)]['difference']:.0e} of u u (Ceres) and "
                      f"{numpy['difference']:.0e} of the largest (numpy); medians of {repeats}.", "", *table, "",
                      "The same work for a machine with one effect, EAY by the product of y and z, one thread:", "",
                      *effect_table(parts), "", "Mpoint/s of 16,384 poses with errors of their own, one thread:", "", *transforms_table(parts)])


def main():
    parser = quiet_machine.parser(__doc__)
    parser.add_argument("evaluation_bench")
    parser.add_argument("program_bench")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    quiet_machine.main("evaluation_against_numpy", lambda machine: measured_text(machine, arguments), MARK, arguments)


if __name__ == "__main__":
    main()

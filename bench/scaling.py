"""Times `volcal montecarlo` under mpirun: the same draws on more ranks (strong scaling), and
as many more draws as there are ranks (weak scaling), against one process.

    scaling.py VOLCAL CAMPAIGN.toml [--ranks 2] [--linear N] [--chord N] [--rounds N] [--noisy] [--write PAGE]

VOLCAL is built with VOLCAL_MPI. Every rank has one thread. What does not depend on the draws (the fit, the tables,
a refit) is measured by a study of few draws and taken off. When other programs used the processors during a
measurement it is repeated, and in the end refused (exit code 3); --noisy quotes it with a mark instead. --write
puts the figures between the marks of a page.
"""

import os
import pathlib
import shutil
import statistics
import sys
import tempfile

import quiet_machine

FEW = {"linear": 10000, "chord": 320}
MARK = "<!-- figures: written by scripts/bench --scaling -->"


def seconds(machine, arguments, path, ranks, draws):
    """Of a whole study, median of the rounds."""
    times = []
    for _ in range(arguments.rounds):
        with tempfile.TemporaryDirectory() as folder:
            study = [arguments.volcal, "montecarlo", arguments.campaign, "--path", path, "-n", str(draws),
                     "--refits", "1", "--threads", "1", "--checkpoint-every", "0", "-o", f"{folder}/out"]
            command = study if ranks == 1 else ["mpirun", "--oversubscribe", "-n", str(ranks), *study]
            times += machine.run(command, 1, quiet_machine.command_figures)["whole_s"]
    return statistics.median(times)


def row(machine, arguments, path, kind, ranks, draws):
    """Of the table, but for the efficiency, and the draws per second."""
    apart = seconds(machine, arguments, path, ranks, FEW[path])
    whole = seconds(machine, arguments, path, ranks, draws)
    rate = (draws - FEW[path]) / (whole - apart)
    return f"| {path} | {kind} | {ranks} | {draws:,} | {whole:.1f} s | {apart:.1f} s | {rate:,.0f} |", rate


def rows(machine, arguments, path, draws):
    text, alone = row(machine, arguments, path, "", 1, draws)
    yield f"{text} 1.00 |"
    for ranks in arguments.ranks:
        for kind, count in {"strong": draws, "weak": draws * ranks}.items():
            text, rate = row(machine, arguments, path, kind, ranks, count)
            yield f"{text} {rate / (ranks * alone):.2f} |"


def measured_text(machine, arguments):
    table = ["| Path | Scaling | Ranks | Draws | Whole study | of it apart from draws | Draws per second | "
             "Efficiency |", "|---|---|--:|--:|--:|--:|--:|--:|"]
    table += rows(machine, arguments, "linear", arguments.linear)
    table += rows(machine, arguments, "chord", arguments.chord)
    return "\n".join([machine.conditions(), "", *table])


def main():
    if shutil.which("mpirun") is None:
        sys.exit("bench: mpirun is missing; install it with scripts/install-dependencies mpi")
    # mpirun refuses root, which a container's user often is.
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    parser = quiet_machine.parser(__doc__)
    parser.add_argument("volcal", type=pathlib.Path)
    parser.add_argument("campaign")
    parser.add_argument("--ranks", type=lambda text: [int(each) for each in text.split(",")], default=[2])
    parser.add_argument("--linear", type=int, default=400000)
    parser.add_argument("--chord", type=int, default=3200)
    parser.add_argument("--rounds", type=int, default=1)
    arguments = parser.parse_args()
    quiet_machine.main("scaling", lambda machine: measured_text(machine, arguments), MARK, arguments)


if __name__ == "__main__":
    main()

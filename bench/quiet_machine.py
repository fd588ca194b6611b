"""What the benchmarks share: programs that run while nothing else uses the processors, and the pages they write.

A measurement during which other programs used the processors is repeated, and in the end refused (Noise); with
`noisy` it is given with a mark instead.
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
import time

OTHERS = 0.1                # processor seconds per second that other programs may use
ATTEMPTS = 5
END = "<!-- end of figures -->"


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
             if key == "OPENBLAS_CORETYPE" or not key.startswith(("OPENBLAS_", "GOTO_", "OMP_", "MKL_"))}
    return clean | {"OPENBLAS_NUM_THREADS": str(threads)}


def finished(command, done):
    if done.returncode != 0:
        sys.exit(f"bench: {' '.join(map(str, command))}: {done.stderr.strip()}")
    return done


def figures_of(command, threads):
    """The JSON that a program prints."""
    done = subprocess.run(command, env=environment(threads), capture_output=True, text=True, check=False)
    return json.loads(finished(command, done).stdout)


def command_figures(command, threads):
    """Wall-clock time and peak memory of a whole program, whatever it prints."""
    clock = time.perf_counter()
    with subprocess.Popen(command, env=environment(threads), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          text=True) as process:
        errors = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        finished(command, subprocess.CompletedProcess(command, process.returncode, stderr=errors))
    return {"whole_s": [time.perf_counter() - clock], "peak_bytes": 1024 * usage.ru_maxrss}


class QuietMachine:
    def __init__(self, noisy):
        self.noisy = noisy
        self.marked = False
        self.most_noise = 0.0
        _, others = load_of_others(lambda: time.sleep(1.0))
        if others > OTHERS and not noisy:
            raise Noise(f"other programs use {others:.2f} processors")

    def run(self, command, threads, measure=figures_of):
        """Figures of a program that had the machine to itself."""
        for attempt in range(ATTEMPTS):
            figures, others = load_of_others(lambda: measure(command, threads))
            if others <= OTHERS or self.noisy:
                break
            time.sleep(5.0 * (attempt + 1))
        else:
            raise Noise(f"other programs used {others:.2f} processors during {' '.join(map(str, command))}")
        self.most_noise = max(self.most_noise, others)
        self.marked |= others > OTHERS
        return figures | {"marked": others > OTHERS}

    def conditions(self, blas=""):
        core = f"BLAS core {blas}; " if blas else ""
        return (f"{time.strftime('%Y-%m-%d')}; {processor()}, {os.cpu_count()} processors; {core}"
                f"load average {os.getloadavg()[0]:.2f}; other programs used at most {self.most_noise:.2f} processors "
                "during a measurement." + (" **Some figures are marked noisy.**" if self.marked else ""))


def merged(parts):
    """One set of figures out of several runs of the same program."""
    total = dict(parts[0])
    for key in total:
        if key.endswith("_s"):
            total[key] = [value for part in parts for value in part[key]]
    total["peak_bytes"] = max(part["peak_bytes"] for part in parts)
    total["marked"] = any(part["marked"] for part in parts)
    return total


def milliseconds(seconds):
    value = 1e3 * statistics.median(seconds)
    return f"{value:.2f}" if value < 10 else f"{value:.1f}" if value < 1000 else f"{value:,.0f}"


def processor():
    for line in open("/proc/cpuinfo"):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def write(page, mark, text):
    """Puts the text between a mark of the page and the END after it."""
    content = page.read_text()
    begin = content.index(mark) + len(mark)
    end = content.index(END, begin)
    page.write_text(content[:begin] + "\n\n" + text + "\n\n" + content[end:])


def parser(description):
    """With the options that every benchmark has."""
    options = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--noisy", action="store_true", help="give figures while other programs run, with a mark")
    options.add_argument("--write", type=pathlib.Path, metavar="PAGE", help="put the figures into this page")
    return options


def main(program, measured_text, mark, arguments):
    """Prints, and writes with --write, what measured_text(machine) gives; exit code 3 when the machine is busy."""
    try:
        text = measured_text(QuietMachine(arguments.noisy))
    except Noise as noise:
        print(f"{program}: no figures: {noise}; try again later, or quote them as --noisy", file=sys.stderr)
        sys.exit(3)
    print(text)
    if arguments.write:
        write(arguments.write, mark, text)

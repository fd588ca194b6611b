"""What the Python module costs: a call, a fit of 6,048 readings, and the memory of a fit of a million from arrays.

Usage: python_overhead.py PROGRAM PACKAGES [--rounds N] [--million]     (run by scripts/bench --python)

The whole job, read, fit, write, is timed by processor seconds in the program and in the module; rounds alternate, the
least of each counts. What volcal.fit takes beyond the library is by the stages that result.json states.
"""

import argparse
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
CAMPAIGN = ROOT / "datasets/examples/structure-0/campaign.toml"
COPIES = 166  # of 6,048 readings: 1,003,968


def stages(result):
    """Seconds that result.json states."""
    return sum(stage["seconds"] for stage in result["timings"])


def of_calls(volcal, result):
    """Seconds of single calls, the median of many."""
    campaign = volcal.read_campaign(CAMPAIGN)
    calls = {
        "result.parameters": lambda: result.parameters,
        "result.residuals": lambda: result.residuals,
        "result.names": lambda: result.names,
        "result.status": lambda: result.status,
        "campaign.setups": lambda: campaign.setups,
        "setup['x_mm']": lambda: campaign.setups[0]["x_mm"],
        "errors_at(1 point)": lambda: result.errors_at(x_mm=[100.0], y_mm=[100.0], z_mm=[-50.0]),
        "Machine.parse": lambda text=campaign.machine.to_toml(): volcal.Machine.parse(text),
    }
    for name, call in calls.items():
        seconds = []
        for _ in range(200):
            start = time.perf_counter()
            call()
            seconds.append(time.perf_counter() - start)
        print(f"  {name:22} {np.median(seconds) * 1e3:8.4f} ms")


def processor_seconds(who):
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def job_of_program(program, folder):
    """Processor seconds of reading, fitting and writing."""
    before = processor_seconds(resource.RUSAGE_CHILDREN)
    subprocess.run([program, "fit", CAMPAIGN, "--threads", "1", "-o", f"{folder}/program"], check=True,
                   stdout=subprocess.DEVNULL)
    return processor_seconds(resource.RUSAGE_CHILDREN) - before


def job_of_module(volcal, folder):
    """The same in this process, and what volcal.fit takes beyond the stages of the library, a share."""
    before = processor_seconds(resource.RUSAGE_SELF)
    campaign = volcal.read_campaign(CAMPAIGN)
    start = time.perf_counter()
    result = volcal.fit(campaign, threads=1)
    elapsed = time.perf_counter() - start
    result.write(f"{folder}/module")
    used = processor_seconds(resource.RUSAGE_SELF) - before
    return used, elapsed / stages(result.to_dict()) - 1.0, result


def of_a_fit(volcal, program, rounds):
    in_program, in_module, beyond = [], [], []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            in_program.append(job_of_program(program, folder))
            seconds, share, result = job_of_module(volcal, folder)
            in_module.append(seconds)
            beyond.append(share)
    print(f"6,048 readings read, fitted and written, one thread, least of {rounds}, processor seconds: program "
          f"{min(in_program):.2f}, module {min(in_module):.2f}: {100 * (min(in_module) / min(in_program) - 1):+.1f} %; "
          f"volcal.fit beyond its library {100 * min(beyond):.2f} %")
    return result


def many_readings(volcal, folder):
    """The same campaign with every reading taken many times, as arrays, and as files for the program."""
    campaign = volcal.read_campaign(CAMPAIGN)
    random = np.random.default_rng(1)
    text = CAMPAIGN.read_text()
    for setup in campaign.setups:
        columns = {name: np.tile(values, COPIES) for name, values in setup.to_dict().items()}
        columns["length_mm"] += random.normal(0.0, 0.8e-3, columns["length_mm"].size)
        columns["line"] += np.repeat(np.arange(COPIES), len(setup)) * (columns["line"].max() + 1)
        columns["time_s"] = np.arange(columns["time_s"].size, dtype=float)
        np.savez(folder / f"{setup.name}.npz", **columns)
        np.savetxt(folder / f"{setup.name}.csv", np.column_stack(list(columns.values())), "%.10g", ",",
                   header=",".join(columns), comments="")
        text = text.replace(f'data = "{setup.name}.csv"', f'data = "{folder}/{setup.name}.csv"')
    (folder / "machine.toml").write_text((CAMPAIGN.parent / "machine.toml").read_text())
    (folder / "campaign.toml").write_text(text)


def fit_of_arrays(packages, folder):
    """In a process of its own, so that its memory is its own: MiB at most, and of the arrays."""
    sys.path.insert(0, packages)
    import volcal

    declared = volcal.read_campaign(CAMPAIGN)
    text = (pathlib.Path(folder) / "campaign.toml").read_text()
    stations = re.findall(r"station_mm = \[(.*?)\]", text)
    setups, size = [], 0
    for setup, station in zip(declared.setups, stations, strict=True):
        readings = dict(np.load(f"{folder}/{setup.name}.npz"))
        size += sum(column.nbytes for column in readings.values())
        setups.append({"name": setup.name, "instrument": setup.instrument, "tool": setup.tool, "station": f"P{setup.name[1]}",
                       "station_mm": [float(x) for x in station.split(",")], "readings": readings,
                       "noise": {"constant_um": 0.25, "per_metre_um": 0.3}, "repeatability_um": 0.6})
    campaign = volcal.Campaign.from_arrays(declared.machine, setups)
    result = volcal.fit(campaign, noise="white", robust="huber")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps({"readings": campaign.reading_count, "peak": peak, "arrays": size / 2**20, "sigma0": result.sigma0}))


def of_a_million(volcal, program, packages):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        many_readings(volcal, folder)
        said = subprocess.run([sys.executable, __file__, program, packages, "--arrays-in", name], check=True,
                              stdout=subprocess.PIPE, text=True).stdout
        told = json.loads(said)
        peak = peak_of([program, "fit", str(folder / "campaign.toml"), "--noise", "white",
                        "--robust", "huber", "-o", f"{folder}/r"])
    print(f"fit of {told['readings']:,} readings, white noise, robust loss (no scans of the residuals at its end):\n"
          f"  peak memory {told['peak']:.0f} MiB from arrays, {told['arrays']:.0f} MiB of it the arrays; {peak:.0f} MiB by the "
          f"program from files\n  {told['peak'] / peak:.2f} times, without the caller's arrays "
          f"{(told['peak'] - told['arrays']) / peak:.2f} times")


def peak_of(command):
    """MiB of a process."""
    child = os.fork()
    if child == 0:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        os.execv(command[0], command)
    _, _, usage = os.wait4(child, 0)
    return usage.ru_maxrss / 1024


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("program")
    arguments.add_argument("packages")
    arguments.add_argument("--rounds", type=int, default=9)
    arguments.add_argument("--million", action="store_true")
    arguments.add_argument("--arrays-in")
    given = arguments.parse_args()
    if given.arrays_in:
        return fit_of_arrays(given.packages, given.arrays_in)
    sys.path.insert(0, given.packages)
    import volcal

    result = of_a_fit(volcal, given.program, given.rounds)
    print("single calls, median:")
    of_calls(volcal, result)
    if given.million:
        of_a_million(volcal, given.program, given.packages)


if __name__ == "__main__":
    main()

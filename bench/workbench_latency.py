"""How long the workbench takes to answer, and from an input to the picture, beside what is wanted.

Usage: workbench_latency.py PROGRAM [--session SESSION_BENCH] [--readings 6048,100000] [--repeats N]
                            [--browser CHROMIUM MODULES]

The campaigns are simulated by `volcal study criticism --one`. Times of the program are measured by a client on the
same machine; those of the page by identify/workbench/web/check/times.mjs in headless Chromium; processor times of
the session behind it, which other programs disturb less, by session_bench.
"""
import argparse
import http.client
import json
import os
import re
import statistics
import subprocess
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
# Of some 6,000 and of some 100,000 readings, ms.
WANTED = {"preview": (30, 80), "add": (50, 150), "rank": (200, 1000), "formula": (60, 200),
          "columns": (16, 50), "refit": (500, 3000), "confirm": (10000, 60000)}


REFITS = 8  # of the repeats


class Program:
    """A workbench, and a client of it."""

    def __init__(self, program, campaign):
        self.process = subprocess.Popen([program, "workbench", campaign, "--no-browser", "--keep", "--no-confirmation"],
                                        stdout=subprocess.PIPE, text=True, cwd=os.path.dirname(campaign))
        address = re.search(r"http://127\.0\.0\.1:(\d+)/#(\w+)", self.process.stdout.readline())
        self.connection = http.client.HTTPConnection("127.0.0.1", int(address[1]), timeout=600)
        self.headers = {"X-Volcal-Token": address[2], "X-Volcal-Tab": "bench"}

    def ask(self, request, **body):
        self.connection.request("POST", f"/api/{request}", json.dumps(body), self.headers)
        answer = self.connection.getresponse()
        content = answer.read()
        if answer.status != 200:
            raise RuntimeError(f"{request}: {answer.status} {content[:300]!r}")
        return content

    def state(self):
        return json.loads(self.ask("state"))

    def until_idle(self):
        while (state := self.state())["phase"] == "loading" or state["busy"]:
            time.sleep(0.02)
        return state

    def timed(self, request, **body):
        start = time.perf_counter()
        self.ask(request, **body)
        return 1e3 * (time.perf_counter() - start)

    def standing(self):
        state = self.state()
        return state["models"][state["current"]]["standing"]

    def until_stands(self, request, *standings):
        """Until the current model stands as it should; what is scanned behind is not waited for."""
        start = time.perf_counter()
        self.ask(request)
        while self.standing() not in standings:
            time.sleep(0.01)
        return 1e3 * (time.perf_counter() - start)

    def end(self):
        self.process.terminate()
        self.process.wait()


def simulated(program, readings, folder):
    subprocess.run([program, "study", "criticism", "--one", "listed:4", "--seed", "2001", "--readings", str(readings),
                    "-o", folder], check=True, stdout=subprocess.DEVNULL)
    for where, _, files in os.walk(folder):
        if "campaign.toml" in files:
            return os.path.join(where, "campaign.toml")
    raise RuntimeError(f"no campaign in {folder}")


def measure(program, campaign, repeats):
    """Milliseconds of every request, and the number of observations."""
    bench = Program(program, campaign)
    try:
        start = time.perf_counter()
        state = bench.until_idle()
        times = {name: [] for name in WANTED}
        times["load"] = [1e3 * (time.perf_counter() - start)]
        first = None
        for k in range(repeats):
            bench.ask("go", model=0)
            if first is None:
                times["rank"].append(bench.timed("rank"))
                first = [each["name"] for each in json.loads(bench.ask("rank"))["effects"] if each["can_be_added"]]
            times["preview"].append(bench.timed("preview", effect=first[k % len(first)]))
            times["formula"].append(bench.timed("formula", text=f"EXX += dir_x * (x - {k})"))
            times["columns"].append(bench.timed("columns", names=["residual@0"]))
            times["add"].append(bench.timed("add", effect=first[k % min(3, len(first))]))
            times["rank"].append(bench.timed("rank"))
            if k < REFITS:
                times["refit"].append(bench.until_stands("refit", "refitted"))
        times["confirm"].append(bench.until_stands("confirm", "fitted", "contradicted"))
        return times, state["campaign"]["observations"]
    finally:
        bench.end()


def at_share(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--readings", default="6048,100000", help="of the campaigns, about")
    parser.add_argument("--repeats", type=int, default=20)
    parser.add_argument("--session", metavar="SESSION_BENCH", help="also the processor time of the session alone")
    parser.add_argument("--browser", nargs=2, metavar=("CHROMIUM", "MODULES"), help="also from the input to the picture")
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.program)
    for which, readings in enumerate(arguments.readings.split(",")):
        with tempfile.TemporaryDirectory() as folder:
            campaign = simulated(program, int(readings), folder)
            times, observations = measure(program, campaign, arguments.repeats)
            print(f"{observations} readings, times of the program, {arguments.repeats} repeats; load "
                  f"{times.pop('load')[0] / 1e3:.1f} s")
            print("  request   median [ms]  95 % [ms]  wanted [ms]")
            for name, values in times.items():
                wanted = WANTED[name][0 if observations < 20000 else 1]
                print(f"  {name:9} {statistics.median(values):11.1f} {at_share(values, 0.95):10.1f} {wanted:12}")
            if arguments.session:
                print("  of the session alone:")
                print(subprocess.run([arguments.session, campaign, "--repeats", str(min(9, arguments.repeats))],
                                     check=True, stdout=subprocess.PIPE, text=True).stdout, end="")
            if arguments.browser:
                print("  from the input to the picture:")
                said = subprocess.run(["node", f"{ROOT}/identify/workbench/web/check/times.mjs", *arguments.browser, campaign,
                                       program, "workbench", "--no-browser", "--keep", "--no-confirmation"],
                                      check=True, stdout=subprocess.PIPE, text=True).stdout
                print("".join(f"  {line}\n" for line in said.splitlines()), end="")


if __name__ == "__main__":
    main()

"""Runs the program under hostile conditions; see hostile_uses_test.py."""
import contextlib
import dataclasses
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import time
from typing import Callable, Optional

TIMEOUT = 60 * max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))  # s; longer where others work, too
RAW = re.compile(r"basic_string::|map::at|vector::_M|std::|json\.exception|\[json|internal error|terminate called|"
                 r"what\(\):|bad_alloc|DPOTRF|OpenBLAS|jemalloc|stoi|stod|invalid_argument")
# Few functions: a fit in a tenth of a second.
COARSE = """format = "volcal-model-1"
machine = "machine.toml"
[functions]
default = { basis = "legendre", degree = 2 }
"""
FIT = ["fit", "c/campaign.toml", "-m", "c/coarse.toml", "-o", "o"]
TEMPORARY = re.compile(r"\.tmp-|\.part|\.previous$")


@dataclasses.dataclass
class Row:
    """One use: `arguments` as the program takes them, run in a folder of its own that holds the small campaign (c/),
    its result (r/) and what `prepare(folder)` makes. `code`: one exit code or several. `says`: a regular expression
    that must be found in what is printed. `limits`: of setrlimit by name. `streams`: stdin, stdout or stderr ->
    "closed", "full", "null". `stop`: (signal, seconds). `output`: a folder that must be whole or as it was."""
    name: str
    arguments: list
    code: object
    says: str = ""
    prepare: Optional[Callable] = None
    environment: dict = dataclasses.field(default_factory=dict)
    limits: dict = dataclasses.field(default_factory=dict)
    streams: dict = dataclasses.field(default_factory=dict)
    stop: tuple = ()
    output: str = "o"
    needs_root: bool = False
    kept: tuple = ()  # files that must be as they were
    patience: int = 1  # times TIMEOUT


class Failure(Exception):
    pass


class Skip(Exception):
    pass


def whole_folder(path):
    """Every file that the list names is there, and JSON is complete."""
    if not os.path.isdir(path):
        return
    listed = os.path.join(path, b".volcal" if isinstance(path, bytes) else ".volcal")
    if os.path.exists(listed):
        for line in open(listed, encoding="utf-8", errors="surrogateescape"):
            name = line.rstrip("\n").split("\t")[0]
            if not os.path.exists(os.path.join(path, os.fsencode(name) if isinstance(path, bytes) else name)):
                raise Failure(f"half a result: {name} is missing in {path}")
    for name in os.listdir(path):
        if os.fsdecode(name).endswith(".json"):
            with open(os.path.join(path, name), encoding="utf-8") as file:
                json.load(file)


def hears(pid, sent):
    """Whether the program has its handler in place."""
    with contextlib.suppress(OSError):
        for line in open(f"/proc/{pid}/status", encoding="ascii"):
            if line.startswith("SigCgt:"):
                return bool(int(line.split()[1], 16) >> (sent - 1) & 1)
    return False


class Runner:
    def __init__(self, program, campaign):
        self.program = program
        self.base = tempfile.mkdtemp(prefix="volcal-hostile-")
        self.campaign = os.path.join(self.base, "c")
        self.result = os.path.join(self.base, "r")
        shutil.copytree(campaign, self.campaign)
        with open(os.path.join(self.base, FIT[FIT.index("-m") + 1]), "w", encoding="ascii") as file:
            file.write(COARSE)
        made = subprocess.run([program, *FIT[:-1], "r"], cwd=self.base, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, stdin=subprocess.DEVNULL)
        if not os.path.exists(os.path.join(self.result, "result.json")):
            raise SystemExit(f"the small campaign cannot be fitted: {made.stdout}")

    def close(self):
        shutil.rmtree(self.base, ignore_errors=True)

    @contextlib.contextmanager
    def folder(self):
        path = tempfile.mkdtemp(dir=self.base)
        shutil.copytree(self.campaign, os.path.join(path, "c"))
        shutil.copytree(self.result, os.path.join(path, "r"))
        try:
            yield path
        finally:
            subprocess.run(["chmod", "-R", "u+rwx", path], check=False, stderr=subprocess.DEVNULL)
            shutil.rmtree(path, ignore_errors=True)

    def start(self, row, folder):
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", **row.environment}
        environment = {key: value for key, value in environment.items() if value is not None}
        closed = [number for number, name in enumerate(("stdin", "stdout", "stderr"))
                  if row.streams.get(name) == "closed"]

        def arrange():
            for name, value in row.limits.items():
                resource.setrlimit(getattr(resource, name), value if isinstance(value, tuple) else (value, value))
            for number in closed:
                os.close(number)

        def stream(name, default):
            kind = row.streams.get(name)
            return {"full": lambda: open("/dev/full", "w"), "null": lambda: subprocess.DEVNULL}.get(
                kind, lambda: default)()
        arguments = row.arguments(folder) if callable(row.arguments) else row.arguments
        return subprocess.Popen([self.program, *arguments], cwd=folder, env=environment, preexec_fn=arrange,
                                stdin=stream("stdin", subprocess.DEVNULL), stdout=stream("stdout", subprocess.PIPE),
                                stderr=stream("stderr", subprocess.PIPE))

    def finish(self, row, process):
        try:
            if row.stop:
                begun = time.monotonic()
                while process.poll() is None and not hears(process.pid, row.stop[0]) and \
                        time.monotonic() - begun < TIMEOUT:
                    time.sleep(0.01)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(row.stop[1])
                if process.poll() is None:
                    process.send_signal(row.stop[0])
            out, err = process.communicate(timeout=TIMEOUT * row.patience)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            raise Failure(f"hangs: no end after {TIMEOUT * row.patience:.0f} s") from None
        return (out or b"").decode(errors="replace"), (err or b"").decode(errors="replace")

    def judge(self, row, folder, before, code, out, err):
        said = err + out
        codes = row.code if isinstance(row.code, tuple) else (row.code,)
        shown = f"; it says: {said.strip()[-600:]}"
        if code < 0:
            raise Failure(f"ends by {signal.Signals(-code).name}{shown}")
        if code not in codes:
            raise Failure(f"exit {code}, expected {codes}{shown}")
        if raw := RAW.search(said):
            raise Failure(f'raw text "{raw.group()}"{shown}')
        if "\x1b" in said:
            raise Failure("an escape sequence reaches the terminal" + shown)
        if code != 0 and "stderr" not in row.streams and "stdout" not in row.streams and not said.strip():
            raise Failure(f"exit {code} without a sentence")
        if row.says and not re.search(row.says, said, re.S):
            raise Failure(f"does not say /{row.says}/{shown}")
        for path, content in before.items():
            if open(os.path.join(folder, path), "rb").read() != content:
                raise Failure(f"{path} was changed")
        for place, _, names in os.walk(folder):
            for name in [*names, os.path.basename(place)]:
                if TEMPORARY.search(name):
                    raise Failure(f"{name} was left behind in {place}{shown}")
        whole_folder(os.path.join(os.fsencode(folder), os.fsencode(row.output)))

    def run(self, row):
        """Nothing, or why the row fails. Raises Skip."""
        if row.needs_root and os.geteuid() != 0:
            raise Skip("only as root")
        with self.folder() as folder:
            undo = row.prepare(folder) if row.prepare else None
            try:
                before = {path: open(os.path.join(folder, path), "rb").read() for path in row.kept}
                process = self.start(row, folder)
                out, err = self.finish(row, process)
                self.judge(row, folder, before, process.returncode, out, err)
            finally:
                if callable(undo):
                    undo()

"""Limits, signals, folders and streams."""
import os
import shutil
import signal
import subprocess

from runner import COARSE, FIT, Row, Skip

DRAW = ["montecarlo", "d/campaign.toml", "-m", "d/model.toml", "-n", "100000000", "-o", "o"]
MEBIBYTE = 1 << 20


def copy_demo(source):
    def prepare(folder):
        os.symlink(os.path.join(source, "datasets/demo/campaign"), os.path.join(folder, "d"))
        os.symlink(os.path.join(source, "datasets/demo/study.toml"), os.path.join(folder, "study.toml"))
        os.symlink(os.path.join(source, "datasets/demo/machine.toml"), os.path.join(folder, "machine.toml"))
    return prepare


def old_result(source):
    def prepare(folder):
        copy_demo(source)(folder)
        os.rename(os.path.join(folder, "r"), os.path.join(folder, "o"))
    return prepare


def limits():
    def memory(name, kibibytes, arguments, code=(0, 1, 2), says="."):
        return Row(f"{name} in {kibibytes} KiB", arguments, code, says, limits={"RLIMIT_AS": kibibytes * 1024})
    rows = [memory("fit", size, FIT, 2, "limit of memory is too low")
            for size in (150_000, 200_000, 250_000, 307_200)]
    rows += [memory("fit", size, FIT) for size in (400_000, 430_000, 460_000, 500_000, 600_000, 1_000_000)]
    rows += [memory("draws", size, ["montecarlo", "c/campaign.toml", "-n", "100", "-o", "o"])
             for size in (307_200, 430_000, 600_000)]
    rows += [memory("diagnosis", size, ["diagnose", "c/campaign.toml", "-o", "o"]) for size in (307_200, 450_000)]
    rows += [memory("tables", size, ["tables", "r", "--format", "csv", "-o", "o"]) for size in (307_200, 450_000)]
    rows += [
        Row("fit with 20 MB of data", FIT, 2, "limit of memory", limits={"RLIMIT_DATA": 20_000_000}),
        Row("many threads in little memory", [*FIT, "--threads", "1000"], (0, 1), ".",
            limits={"RLIMIT_AS": 700 * MEBIBYTE}),
        Row("a thousand threads", [*FIT, "--threads", "1000"], (0, 1), "written"),
        Row("no file may be written", FIT, 2, "File too large|writing", limits={"RLIMIT_FSIZE": 0}),
        Row("files of 4 KiB", FIT, 2, "File too large|writing", limits={"RLIMIT_FSIZE": 4096}),
        Row("a program's files of 10 bytes", ["extend", "c/model.toml", "-e", "reversal:EYY", "-o", "x.toml"], (0, 2),
            ".", limits={"RLIMIT_FSIZE": 10}),
        Row("seven open files", FIT, (0, 1, 2), ".", limits={"RLIMIT_NOFILE": 7}),
        Row("five open files", FIT, (0, 1, 2), ".", limits={"RLIMIT_NOFILE": 5}),
        Row("no core", FIT, (0, 1), "written", limits={"RLIMIT_CORE": 0}),
        Row("a stack of 256 KiB", FIT, (0, 1), "written", limits={"RLIMIT_STACK": 256 * 1024}),
    ]
    return rows


def ends_of_time(source):
    demo = ["fit", "d/campaign.toml", "-m", "d/model.toml", "-o", "o"]
    whole = {"prepare": old_result(source), "kept": ("o/result.json",)}
    rows = [
        Row("processor time of 3 s", DRAW, 1, "processor time", limits={"RLIMIT_CPU": 3}, **whole),
        Row("processor time of 2 s, soft", DRAW, 1, "processor time", limits={"RLIMIT_CPU": (2, 60)}, **whole),
    ]
    for name, sent in (("SIGINT", signal.SIGINT), ("SIGTERM", signal.SIGTERM), ("SIGHUP", signal.SIGHUP)):
        rows.append(Row(f"draws stopped by {name}", DRAW, 1, f"interrupted by {name}.*as before", stop=(sent, 2.0),
                        **whole))
    for seconds in (0.0, 0.1, 0.4, 1.0):
        rows.append(Row(f"demo's fit stopped after {seconds} s", demo, (0, 1), ".", stop=(signal.SIGTERM, seconds),
                        prepare=old_result(source)))
        rows.append(Row(f"small fit stopped after {seconds + 0.05:.2f} s", FIT, (0, 1), ".",
                        stop=(signal.SIGINT, seconds + 0.05), prepare=old_result(source)))
    rows += [
        Row("diagnosis stopped", ["diagnose", "d/campaign.toml", "--auto", "-o", "o"], (0, 1), ".",
            stop=(signal.SIGINT, 1.5), prepare=copy_demo(source)),
        Row("plan stopped", ["plan", "c/machine.toml", "--readings", "20000", "-o", "o"], (0, 1), ".",
            stop=(signal.SIGTERM, 1.5)),
        Row("simulation stopped", ["simulate", "study.toml", "-o", "o"], (0, 1, 2), ".",
            stop=(signal.SIGTERM, 0.3), prepare=copy_demo(source)),
        Row("draws into nowhere stopped", DRAW, (1,), ".", stop=(signal.SIGTERM, 0.5), streams={"stdout": "null"}, **whole),
    ]
    return rows


def made(path, make):
    def prepare(folder):
        place = os.path.join(folder, path)
        if os.path.lexists(place):
            os.remove(place)
        make(place)
    return prepare


def in_place_of(path):
    """What stands where a file is expected."""
    return [
        ("missing", 2, made(path, lambda place: None)),
        ("a folder", 2, made(path, os.mkdir)),
        ("a pipe", 2, made(path, os.mkfifo)),
        ("a dangling link", 2, made(path, lambda place: os.symlink("nowhere", place))),
        ("a link to itself", 2, made(path, lambda place: os.symlink(os.path.basename(place), place))),
        ("a device", 2, made(path, lambda place: os.symlink("/dev/null", place))),
        ("an endless device", 2, made(path, lambda place: os.symlink("/dev/zero", place))),
    ]


def files():
    rows = []
    for path in ("c/campaign.toml", "c/machine.toml", "c/S1.csv"):
        rows += [Row(f"{path} is {name}", FIT, code, ".", prepare=prepare)
                 for name, code, prepare in in_place_of(path)]
    rows += [Row(f"result is {name}", ["tables", "r", "--format", "csv", "-o", "o"], code, ".", prepare=prepare)
             for name, code, prepare in in_place_of("r/result.json")]
    rows += [Row(f"model is {name}", ["fit", "c/campaign.toml", "-m", "c/model.toml", "-o", "o"], code, ".", prepare=prepare)
             for name, code, prepare in in_place_of("c/model.toml")]
    long_name = "n" * 255
    rows += [
        Row("output is a pipe", FIT, 2, ".", prepare=made("o", os.mkfifo)),
        Row("output is a dangling link", FIT, (0, 1, 2), ".",
            prepare=made("o", lambda place: os.symlink("nowhere", place))),
        Row("output is a link to itself", FIT, 2, ".", prepare=made("o", lambda place: os.symlink("o", place))),
        Row("output is a device", ["fit", "c/campaign.toml", "-o", "/dev/null"], 2, "."),
        Row("output of 256 letters", ["fit", "c/campaign.toml", "-o", long_name + "n"], 2, "."),
        Row("output of 255 letters", ["fit", "c/campaign.toml", "-o", long_name], 2, "."),
        Row("output of 5,000 letters", ["fit", "c/campaign.toml", "-o", "/".join(["p" * 200] * 25)], 2, "."),
        Row("input of 5,000 letters", ["fit", "i" * 5000, "-o", "o"], 2, "."),
        Row("input of 256 letters", ["fit", long_name + "i", "-o", "o"], 2, "."),
        Row("output not UTF-8", ["fit", "c/campaign.toml", "--json", "-o", b"o\xff\xfe"], (0, 1), "sigma0",
            output="o\udcff\udcfe"),
        Row("campaign's folder not UTF-8", ["fit", b"c\xff/campaign.toml", "--json", "-o", "o"], (0, 1), "sigma0",
            prepare=lambda folder: os.rename(f"{folder}/c", os.fsencode(folder) + b"/c\xff")),
        Row("comparison in a folder not UTF-8", ["compare", b"c\xff/campaign.toml", "r", "--json", "-o", "o"], (0, 1),
            ".", prepare=lambda folder: os.rename(f"{folder}/c", os.fsencode(folder) + b"/c\xff")),
        Row("diagnosis in a folder not UTF-8", ["diagnose", b"c\xff/campaign.toml", "-o", "o"], (0, 1), ".",
            prepare=lambda folder: os.rename(f"{folder}/c", os.fsencode(folder) + b"/c\xff")),
        Row("model written from a folder not UTF-8",
            ["extend", b"c\xff/model.toml", "-e", "reversal:EYY", "--json", "-o", b"c\xff/new.toml"], (0, 2), ".",
            prepare=lambda folder: os.rename(f"{folder}/c", os.fsencode(folder) + b"/c\xff")),
        Row("machine files in a folder not UTF-8", ["init", "w X' b Y Z t", "--json", "-o", b"m\xff"], 0, "."),
        Row("campaign's folder with a line end", ["fit", "c\nd/campaign.toml", "-o", "o"], (0, 1), ".",
            prepare=lambda folder: os.rename(f"{folder}/c", f"{folder}/c\nd")),
        Row("campaign's folder with markup", ["fit", "<b>&/campaign.toml", "-o", "o"], (0, 1), "written",
            prepare=lambda folder: os.rename(f"{folder}/c", f"{folder}/<b>&")),
        Row("missing file with an escape", ["fit", "\x1b[31mred.toml", "-o", "o"], 2, "."),
        Row("output is the folder of the campaign's link", ["fit", "l/campaign.toml", "-o", "c"], 2, ".",
            prepare=lambda folder: os.symlink("c", f"{folder}/l")),
        Row("output of a stranger", FIT, 2, "did not write",
            prepare=lambda folder: os.makedirs(f"{folder}/o/stranger")),
    ]
    return rows


def read_only(folder):
    os.mkdir(f"{folder}/s")
    os.chmod(f"{folder}/s", 0o500)


def immutable(folder):
    if os.geteuid() == 0:
        raise Skip("root may write everywhere")
    read_only(folder)


def unreadable(folder):
    if os.geteuid() == 0:
        raise Skip("root may read everything")
    os.chmod(f"{folder}/c/S1.csv", 0)


def small_disk(size):
    def prepare(folder):
        os.mkdir(f"{folder}/disk")
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", f"{folder}/disk"], check=False,
                               stderr=subprocess.DEVNULL)
        if mount.returncode != 0:
            raise Skip("no file system can be mounted here")
        return lambda: subprocess.run(["umount", "-l", f"{folder}/disk"], check=False)
    return prepare


def places(source):
    full = {"needs_root": True, "output": "disk/o"}
    demo = ["fit", "c/campaign.toml", "-o", "disk/o"]
    return [
        Row("read-only folder", ["fit", "c/campaign.toml", "-o", "s/o"], 2, "ermission", prepare=immutable),
        Row("data without permission", FIT, 2, "ermission", prepare=unreadable),
        Row("kernel's folder", ["fit", "c/campaign.toml", "-o", "/proc/o"], 2, "."),
        Row("folder of devices", ["fit", "c/campaign.toml", "-o", "/sys/o"], 2, "."),
        Row("disk of 4 KiB", demo, 2, "No space|space", prepare=small_disk("4k"), **full),
        Row("disk of 64 KiB", demo, 2, "No space|space", prepare=small_disk("64k"), **full),
        Row("tables on a full disk", ["tables", "r", "--format", "csv", "-o", "disk/o"], 2, "space",
            prepare=small_disk("16k"), **full),
        Row("model on a full disk", ["extend", "c/model.toml", "-e", "reversal:EYY", "-o", "disk/x.toml"], 2, "room|space",
            prepare=small_disk("0,nr_inodes=1"), **full),
        Row("simulation on a full disk", ["simulate", "study.toml", "-o", "disk/o"], 2, "space",
            prepare=lambda folder: (copy_demo(source)(folder), small_disk("16k")(folder))[1], **full),
    ]


def streams():
    rows = [Row(f"closed {name}", FIT, (0, 1), "", streams={name: "closed"}) for name in ("stdin", "stdout", "stderr")]
    rows += [
        Row("all streams closed", FIT, (0, 1), "",
            streams={"stdin": "closed", "stdout": "closed", "stderr": "closed"}),
        Row("errors to a closed stream", ["fit", "nothing", "-o", "o"], 2, "", streams={"stderr": "closed"}),
        Row("errors to a full device", ["fit", "nothing", "-o", "o"], 2, "", streams={"stderr": "full"}),
        Row("output to nowhere", FIT, (0, 1), "", streams={"stdout": "null"}),
        Row("output to a full device", FIT, 1, "standard output cannot be written", streams={"stdout": "full"}),
        Row("JSON to a full device", [*FIT, "--json"], 1, "standard output cannot be written",
            streams={"stdout": "full"}),
        Row("help to a full device", ["--help"], 1, "standard output cannot be written", streams={"stdout": "full"}),
    ]
    return rows


def environments():
    def row(name, **environment):
        return Row(f"environment: {name}", FIT, (0, 1), "written", environment=environment)
    return [
        row("LC_ALL=C", LC_ALL="C"),
        row("LC_ALL=de_DE.UTF-8", LC_ALL="de_DE.UTF-8", LC_NUMERIC="de_DE.UTF-8"),
        row("LC_ALL=tr_TR", LC_ALL="tr_TR.UTF-8"),
        row("LC_ALL of nonsense", LC_ALL="xx_YY.ZZ\x7f"),
        row("LANG empty", LANG="", LC_ALL=None),
        row("TZ of nonsense", TZ="../../../etc/passwd"),
        row("TZ far east", TZ="Pacific/Kiritimati"),
        row("no HOME", HOME=None),
        row("HOME nowhere", HOME="/nonexistent"),
        row("no PATH", PATH=None),
        row("TMPDIR nowhere", TMPDIR="/nonexistent"),
        row("no OPENBLAS_NUM_THREADS", OPENBLAS_NUM_THREADS=None),
        row("OPENBLAS_NUM_THREADS of nonsense", OPENBLAS_NUM_THREADS="many"),
        row("OMP_NUM_THREADS of nonsense", OMP_NUM_THREADS="-1"),
        row("a variable of 100 KB", VOLCAL_RUBBISH="x" * 100_000),
        row("NO_COLOR and a dumb terminal", NO_COLOR="1", TERM="dumb"),
        Row("environment: two processes of mpirun", ["montecarlo", "c/campaign.toml", "-n", "10", "-o", "o"], 2, ".",
            environment={"OMPI_COMM_WORLD_SIZE": "2"}),
        Row("environment: mpirun of nonsense", ["montecarlo", "c/campaign.toml", "-n", "10", "-o", "o"], (0, 1, 2), ".",
            environment={"OMPI_COMM_WORLD_SIZE": "99999999999999999999"}),
    ]


def many_setups(count, same_file):
    """A campaign of so many setups of one reading each."""
    def prepare(folder):
        head = 'format = "volcal-campaign-1"\nmachine = "machine.toml"\n'
        setups = []
        for i in range(count):
            name = "S1.csv" if same_file else f"m{i}.csv"
            if not same_file:
                with open(f"{folder}/c/{name}", "w", encoding="ascii") as file:
                    file.write(f"x_mm,y_mm,z_mm,displacement_mm\n{i % 499},0,-300,1.5\n{i % 499 + 1},9,-290,1.7\n")
            setups.append(f'[[setups]]\nname = "S{i}"\ninstrument = "displacement"\ndata = "{name}"\ntool = "none"\n'
                          "direction = [1, 0, 0]\nnoise = { constant_um = 0.3 }\n")
        with open(f"{folder}/c/campaign.toml", "w", encoding="ascii") as file:
            file.write(head + "".join(setups))
    return prepare


def further_setups(source, count):
    """The demo campaign, which sees every error, and so many lines of three positions, each with an offset."""
    def prepare(folder):
        shutil.rmtree(f"{folder}/c")
        shutil.copytree(os.path.join(source, "datasets/demo/campaign"), f"{folder}/c")
        with open(f"{folder}/c/coarse.toml", "w", encoding="ascii") as file:
            file.write(COARSE)
        with open(f"{folder}/c/campaign.toml", "a", encoding="ascii") as campaign:
            for i in range(count):
                with open(f"{folder}/c/line{i}.csv", "w", encoding="ascii") as file:
                    file.write("x_mm,y_mm,z_mm,displacement_mm\n")
                    for k, x in enumerate((-200, 0, 200)):
                        noise = ((7 * i + 3 * k) % 11 - 5) * 1e-4
                        file.write(f"{x},{i % 199 - 99},{-100 - i % 97},{x + 2 + noise:.4f}\n")
                campaign.write(f'[[setups]]\nname = "line{i}"\ninstrument = "displacement"\ndata = "line{i}.csv"\n'
                               'tool = "short"\ndirection = [1, 0, 0]\nnoise = { constant_um = 0.3 }\n')
    return prepare


def sizes(source):
    rows = [
        Row("a hundred setups", [*FIT, "--noise", "white"], (0, 1), ".", prepare=many_setups(100, False)),
        Row("10^5 setups", FIT, (1, 2), ".", prepare=many_setups(100_000, True)),
        Row("600 setups", [*FIT, "--threads", "2"], 0, "written", prepare=further_setups(source, 600),
            limits={"RLIMIT_AS": 1000 * MEBIBYTE}),
    ]
    if os.environ.get("VOLCAL_LONG_TESTS"):
        rows.append(Row("3,000 setups", [*FIT, "--threads", "2"], 0, "written", prepare=further_setups(source, 3000),
                        limits={"RLIMIT_AS": 4000 * MEBIBYTE}, patience=20))
    return rows


def rows(source):
    return [*limits(), *ends_of_time(source), *files(), *places(source), *streams(), *environments(), *sizes(source)]

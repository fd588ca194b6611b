"""Hostile files."""
import json
import os
import random
import re

from runner import FIT, Row

ROW = "0,0,-300,1.0012\n"


def put(path, content):
    """Writes a file of the folder."""
    def prepare(folder):
        place = os.path.join(folder, path)
        os.makedirs(os.path.dirname(place), exist_ok=True)
        with open(place, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
    return prepare


def change(path, old, new):
    """Replaces the first `old` of a file by `new`."""
    def prepare(folder):
        place = os.path.join(folder, path)
        text = open(place, "rb").read()
        old_bytes, new_bytes = (word if isinstance(word, bytes) else word.encode() for word in (old, new))
        assert old_bytes in text, f"{old} is not in {path}"
        with open(place, "wb") as file:
            file.write(text.replace(old_bytes, new_bytes, 1))
    return prepare


def before(path, head):
    def prepare(folder):
        place = os.path.join(folder, path)
        text = open(place, "rb").read()
        with open(place, "wb") as file:
            file.write(head + text)
    return prepare


def bad(name, prepare, says=".", arguments=FIT, code=2):
    return Row(name, arguments, code, says, prepare=prepare)


def toml():
    campaign, machine = "c/campaign.toml", "c/machine.toml"
    station = "station_mm = [-200.0, -150.0, -250.0]"
    deep = 10000
    return [
        bad("empty campaign file", put(campaign, b""), "empty"),
        bad("campaign of blanks", put(campaign, b" \n\t\n" * 1000), "empty"),
        bad("campaign of NUL bytes", put(campaign, bytes(1000)), "binary"),
        bad("NUL byte in the campaign", change(campaign, 'name = "S1"', b'name = "S\x001"'), "NUL"),
        bad("campaign in UTF-16", put(campaign, 'format = "volcal-campaign-1"\n'.encode("utf-16")), "UTF-16"),
        bad("campaign not UTF-8", change(campaign, 'name = "S1"', b'name = "S\xff\xfe"'), "UTF-8|utf-8"),
        bad("campaign of CR alone", put(campaign, b'format = "volcal-campaign-1"\rmachine = "machine.toml"\r'), "CR"),
        Row("campaign with a byte order mark", FIT, (0, 1), "written", prepare=before(campaign, b"\xef\xbb\xbf")),
        bad("campaign of random bytes", put(campaign, random.Random(1).randbytes(5000))),
        bad("campaign that is JSON", put(campaign, b'{"format": "volcal-campaign-1"}')),
        bad("campaign that is CSV", put(campaign, b"x_mm,y_mm\n1,2\n")),
        bad("nested arrays in TOML", put(campaign, "format = " + "[" * deep + "]" * deep), "nested"),
        bad("nested tables in TOML", put(campaign, "a = " + "{a=" * deep + "1" + "}" * deep), "nested"),
        bad("open brackets in TOML", put(campaign, "a = " + "[" * 100 * deep), "nested"),
        bad("dotted keys in TOML", put(campaign, ".".join("a" * deep) + " = 1"), "nested"),
        bad("dotted table in TOML", put(campaign, "[" + ".".join("a" * deep) + "]\nb = 1"), "nested"),
        bad("dotted keys with blanks in TOML", put(campaign, " . ".join("a" * deep) + " = 1"), "nested"),
        bad("one line of 10 MB in TOML", put(campaign, b"a = '" + b"x" * 10_000_000 + b"'\n"), "."),
        bad("10^5 unknown keys", put(campaign, "".join(f"k{i} = 1\n" for i in range(100_000))), "."),
        bad("future campaign format", change(campaign, "volcal-campaign-1", "volcal-campaign-99"), "format"),
        bad("campaign format of a machine", change(campaign, "volcal-campaign-1", "volcal-machine-1"), "format"),
        bad("format that is a number", change(campaign, '"volcal-campaign-1"', "1"), "format"),
        bad("format with an escape", change(campaign, "volcal-campaign-1", "volcal\\u001b[31m"), "."),
        bad("machine format of the future", change(machine, "volcal-machine-1", "volcal-machine-2"), "format"),
        bad("station of 1e300", change(campaign, station, "station_mm = [1e300, 0, 0]"), "large|believed"),
        bad("station not a number", change(campaign, station, "station_mm = [nan, 0, 0]"), "finite"),
        bad("station infinite", change(campaign, station, "station_mm = [inf, 0, 0]"), "finite"),
        bad("station of two numbers", change(campaign, station, "station_mm = [0, 0]"), "expected 3"),
        bad("station of text", change(campaign, station, 'station_mm = "far"'), "number"),
        bad("noise of 1e300", change(campaign, "constant_um = 0.2", "constant_um = 1e300"), "."),
        Row("noise of 1e-300", FIT, (0, 1, 2), ".",
            prepare=change(campaign, "constant_um = 0.2, per_metre_um = 0.3 }",
                           "constant_um = 1e-300 }\nrepeatability_um = 0")),
        bad("noise below zero", change(campaign, "constant_um = 0.2", "constant_um = -0.2"), "negative"),
        bad("travel of 1e300", change(machine, "travel_mm = [0, 500]", "travel_mm = [0, 1e300]"), "."),
        bad("travel of nothing", change(machine, "travel_mm = [0, 500]", "travel_mm = [0, 0]"), "travel"),
        bad("travel reversed", change(machine, "travel_mm = [0, 500]", "travel_mm = [500, 0]"), "travel"),
        bad("tool of 1e300", change(machine, "offset_mm = [0.0, 0.0, -150.0]", "offset_mm = [0, 0, -1e300]"), "."),
        bad("integer beyond 64 bits", change(campaign, "skip_rows = 2", "skip_rows = 99999999999999999999"), "."),
        bad("skip_rows of all rows", change(campaign, "skip_rows = 2", "skip_rows = 1000000000"), "."),
        bad("skip_rows below zero", change(campaign, "skip_rows = 2", "skip_rows = -2"), "."),
        bad("scale of 1e300", change(campaign, "ex_um = 1000.0", "ex_um = 1e300"), "."),
        bad("scale of zero", change(campaign, "ex_um = 1000.0", "ex_um = 0.0"), "."),
        bad("delimiter of two letters", change(campaign, 'delimiter = ";"', 'delimiter = ";;"'), "delimiter"),
        bad("delimiter that is a figure", change(campaign, 'delimiter = ";"', 'delimiter = "1"'), "."),
        bad("delimiter that is the decimal", change(campaign, 'delimiter = ";"', 'delimiter = ","'), "."),
        bad("empty name of a setup", change(campaign, 'name = "S1"', 'name = ""'), "empty"),
        bad("two setups of one name", change(campaign, 'name = "S2"', 'name = "S1"'), "S1"),
        Row("setup with markup", FIT, (0, 1), "written", prepare=change(campaign, 'name = "S1"',
                                                                         'name = "<script>alert(1)</script>"')),
        Row("setup with quotes and commas", FIT, (0, 1, 2), ".",
            prepare=change(campaign, 'name = "S1"', "name = 'a,\"b\"'")),
        Row("setup of 10,000 letters", FIT, (0, 1, 2), ".",
            prepare=change(campaign, 'name = "S1"', f'name = "{"s" * 10000}"')),
        bad("unknown tool", change(campaign, 'tool = "long"', 'tool = "longer"'), "did you mean"),
        bad("unknown instrument", change(campaign, '"laser-tracer"', '"laser-traser"'), "did you mean"),
        bad("machine that is the campaign", change(campaign, '"machine.toml"', '"campaign.toml"'), "format"),
        bad("machine with NUL in its path", change(campaign, '"machine.toml"', '"mach\\u0000ine.toml"'), "."),
        bad("data that is missing", change(campaign, '"S1.csv"', '"S9.csv"'), "did you mean"),
        bad("data that is a folder", change(campaign, '"S1.csv"', '"."'), "directory"),
        bad("data that is a device", change(campaign, '"S1.csv"', '"/dev/zero"'), "device"),
        bad("data with a path of 5,000 letters", change(campaign, '"S1.csv"', f'"{"d" * 5000}.csv"'), "."),
        bad("machine of 10,000 tools at one name", put(machine, "[tools.a]\n" * 10000), "."),
    ]


def csv():
    s1 = "c/S1.csv"
    head = b"time_s,line,x_mm,y_mm,z_mm,dir_x,dir_y,dir_z,T_air_degC,length_mm\n"
    good = b"0.0,0,118.024,41.266,-181.183,1,1,-1,20.00,0.00063\n"

    def value(old, new):
        return put(s1, head + good.replace(old, new))
    wide = b",".join(b"c%d" % i for i in range(10000))
    return [
        bad("empty data", put(s1, b""), "empty"),
        bad("data of a header alone", put(s1, head), "no rows"),
        bad("data without header", put(s1, good), "header"),
        bad("data of NUL bytes", put(s1, bytes(100)), "NUL"),
        bad("data of random bytes", put(s1, random.Random(2).randbytes(5000))),
        bad("data in UTF-16", put(s1, (head + good).decode().encode("utf-16")), "UTF-16"),
        Row("data with a byte order mark", FIT, (0, 1), "written", prepare=before(s1, b"\xef\xbb\xbf")),
        bad("data of one line of 10 MB", put(s1, b"1," * 5_000_000), "."),
        bad("10^4 columns without the right ones", put(s1, wide + b"\n" + b",".join([b"1"] * 10000) + b"\n"), "column"),
        Row("10^4 columns beside the right ones", FIT, (0, 1, 2), ".",
            prepare=put(s1, head.strip() + b"," + wide + b"\n" +
                        b"".join(good.replace(b"118.024", b"%d" % (10 + i)).strip() + b",1" * 10000 + b"\n"
                                 for i in range(5)))),
        bad("cell that is no number", value(b"118.024", b"abc"), "number"),
        bad("cell with a German thousand", value(b"118.024", b"1.118,024"), "."),
        bad("cell with a decimal comma", value(b"118.024,", b'"118,024",'), "comma"),
        bad("cell with a Swiss thousand", value(b"118.024", b"1'118.024"), "number"),
        bad("cell of hexadecimal figures", value(b"118.024", b"0x76"), "number"),
        bad("cell nan", value(b"118.024", b"nan"), "number"),
        bad("cell inf", value(b"118.024", b"inf"), "."),
        bad("cell of 1e400", value(b"118.024", b"1e400"), "."),
        bad("cell of 1e300", value(b"118.024", b"1e300"), "."),
        bad("reading of 1e300", value(b"0.00063", b"1e300"), "."),
        bad("time of 1e300", value(b"0.0,0,", b"1e300,0,"), "."),
        bad("line of 1e300", value(b"0.0,0,", b"0.0,1e300,"), "."),
        bad("direction of 7", value(b",1,1,-1,", b",7,1,-1,"), "."),
        bad("temperature of 1e300", value(b"20.00", b"1e300"), "."),
        bad("cell with an escape", value(b"118.024", b"\x1b[31m1"), "number"),
        bad("cell missing", value(b"118.024,", b""), "cell"),
        bad("cell too many", value(b"0.00063", b"0.00063,1"), "cell"),
        bad("quote that does not close", value(b"118.024", b'"118.024'), "quote"),
        bad("header with a quote open", put(s1, b'"' + head + good), "quote"),
        bad("header twice", put(s1, head.replace(b"y_mm", b"x_mm") + good), "."),
        bad("position outside the travel", value(b"118.024", b"99999"), "travel"),
        Row("column name not UTF-8", FIT, 2, "encoding",
            prepare=change(s1, b"T_air_degC", b"T_l\xfcft_degC")),
        Row("column name with markup", FIT, (0, 1), "written",
            prepare=change(s1, b"T_air_degC", b"T_<b>_degC")),
        Row("column name of 10,000 letters", FIT, (0, 1), "written",
            prepare=change(s1, b"T_air_degC", b"T_" + b"a" * 10000 + b"_degC")),
    ]


def cut(share):
    def prepare(folder):
        place = os.path.join(folder, "r/result.json")
        text = open(place, "rb").read()
        with open(place, "wb") as file:
            file.write(text[:len(text) * share // 20])
    return prepare


def edited(edit):
    def prepare(folder):
        place = os.path.join(folder, "r/result.json")
        result = json.load(open(place))
        edit(result)
        with open(place, "w") as file:
            json.dump(result, file)
    return prepare


def assign(*path):
    *keys, value = path

    def edit(result):
        at = result
        for key in keys[:-1]:
            at = at[key]
        at[keys[-1]] = value
    return edit


def results():
    tables = ["tables", "r", "--format", "csv", "-o", "o"]
    deep = 10000
    rows = [bad(f"result cut at {share} of 20", cut(share), "result", tables) for share in range(20)]
    for key in ("status", "machine", "model", "parameters", "layout", "covariance", "rank", "functions", "setups",
                "messages", "variance_components", "timings"):
        for name, value in (("a number", 7), ("null", None), ("an empty list", []), ("a text", "x"),
                            ("an object", {"a": 1})):
            rows.append(Row(f"result with {key} as {name}", tables, (0, 1, 2), ".",
                            prepare=edited(assign(key, value))))
    rows += [
        bad("result that is a list", put("r/result.json", "[]"), "result", tables),
        bad("result that is a number", put("r/result.json", "7"), "result", tables),
        bad("result nested deep", put("r/result.json", "[" * deep + "]" * deep), "nested", tables),
        bad("result of objects nested deep", put("r/result.json", '{"a":' * deep + "1" + "}" * deep), "nested", tables),
        bad("result of a million open brackets", put("r/result.json", "[" * 1_000_000), "nested", tables),
        bad("result of the future", edited(assign("format", "volcal-result-99")), "format|version", tables),
        bad("result with a number too large", change("r/result.json", '"sigma0":', '"sigma0": 1e999, "s":'), ".", tables),
        bad("result with a travel of 1e300", edited(assign("machine", "axes", 0, "travel_max", 1e300)), ".", tables,
            (1, 2)),
        bad("result with a degree of 10^9", edited(assign("model", "default_function", "degree", 10**9)), ".", tables,
            (0, 1, 2)),
        bad("result with a rank of 10^30", change("r/result.json", '"rank": ', '"rank": 1e30, "r": '), ".", tables,
            (0, 2)),
        bad("result of another machine", edited(assign("machine", "structure", "w Z b X Y t")), ".", tables, (0, 1, 2)),
        bad("result that is empty", put("r/result.json", ""), "empty", tables),
        bad("result of NUL bytes", put("r/result.json", bytes(64)), "NUL", tables),
        bad("diagnosis nested deep", put("d/diagnosis.json", "[" * deep), "nested",
            ["extend", "c/model.toml", "--diagnosis", "d", "--accepted", "-o", "x.toml"]),
        bad("diagnosis that is a result", put("d/diagnosis.json", '{"format": "volcal-result-1"}'), ".",
            ["extend", "c/model.toml", "--diagnosis", "d", "--accepted", "-o", "x.toml"]),
        bad("checkpoint of rubbish", put("o.checkpoint", b"rubbish"), ".",
            ["montecarlo", "c/campaign.toml", "-n", "10", "-o", "o"]),
    ]
    return rows


def programs():
    run = ["compensate", "r", "part.ngc", "-o", "out.ngc"]

    def program(name, content, says=".", code=(1, 2)):
        return Row(name, run, code, says, prepare=put("part.ngc", content), output="out")
    return [
        program("program of one line of 10 MB", b"G1 X1 " * 1_666_666, "longer"),
        program("program of 10 MB without words", b"(" + b"x" * 10_000_000 + b")\n", "."),
        program("empty program", b"", ".", (0, 1, 2)),
        program("program of NUL bytes", bytes(100), "NUL"),
        program("program of random bytes", random.Random(3).randbytes(3000)),
        program("program to 1e300", b"G21 G90 G0 X1e300\nM2\n"),
        program("program far away", b"G21 G90 F100\nG0 X0 Y0 Z0\nG1 X999999999999\nM2\n"),
        program("program of nested brackets", b"G0 X" + b"[" * 10000 + b"1" + b"]" * 10000 + b"\nM2\n"),
        program("arc of no radius", b"G21 G90 F100\nG0 X0 Y0 Z0\nG2 X10 Y10 R0\nM2\n"),
        program("10^9 turns of an arc", b"G21 G90 F100\nG0 X0 Y0 Z0\nG2 I10 P1000000000\nM2\n"),
    ]


def models():
    model = "c/model.toml"

    def custom(text):
        return put(model, 'format = "volcal-model-1"\nmachine = "machine.toml"\n' + text)
    run = ["fit", "c/campaign.toml", "-m", model, "-o", "o"]
    rows = []
    for name, text in [
        ("knots of 10^9", '[functions]\ndefault = { basis = "bspline", degree = 3, knots = 1000000000 }\n'),
        ("knots below zero", '[functions]\ndefault = { basis = "bspline", degree = 3, knots = -1 }\n'),
        ("degree of 10^6", '[functions]\ndefault = { basis = "legendre", degree = 1000000 }\n'),
        ("no functions but text", 'functions = "all"\n'),
        ("unknown basis", '[functions]\ndefault = { basis = "wavelet" }\n'),
        ("unknown effect", '[[effects]]\nkind = "ghost"\n'),
        ("effect without kind", "[[effects]]\n"),
        ("expression nested deep", '[[effects]]\nkind = "custom"\nsymbol = "EXX"\nexpression = "'
         + "(" * 10000 + "x" + ")" * 10000 + '"\n'),
        ("expression of 10^5 letters", '[[effects]]\nkind = "custom"\nsymbol = "EXX"\nexpression = "'
         + "x+" * 50000 + 'x"\n'),
        ("expression dividing by zero", '[[effects]]\nkind = "custom"\nsymbol = "EXX"\nexpression = "1/0"\n'),
        ("coefficients of 1e300", '[functions]\nEXX = { basis = "legendre", degree = 1, coefficients = [1e300] }\n'),
    ]:
        rows.append(bad(f"model with {name}", custom(text), ".", run))
    return rows


STUDY = '''format = "volcal-study-1"
machine = "c/machine.toml"
seed = 1
'''


def studies():
    run = ["simulate", "study.toml", "-o", "o"]

    def study(text):
        return put("study.toml", STUDY + text)
    return [
        bad("study with a grid of 10^9", study('[[measurements]]\nkind = "point-grid"\nname = "G"\ngrid = [1000, 1000, 1000]\n'),
            ".", run),
        bad("study with a grid of nan", study('[[measurements]]\nkind = "point-grid"\nname = "G"\ngrid = [nan, 2, 2]\n'),
            ".", run),
        bad("study with 10^12 readings of a line",
            study('[[measurements]]\nkind = "diagonals"\nname = "D"\npoints = 1000000\nruns = 1000000\n'), ".", run),
        bad("study with 10^9 revisits",
            study('[[measurements]]\nkind = "laser-tracer"\nname = "T"\nrevisits = 1000000000\n'), ".", run),
        bad("study without measurements", study(""), ".", run),
        bad("study of the future", put("study.toml", STUDY.replace("study-1", "study-9")), "format", run),
    ]


def imports():
    use = ["import", "f", "--machine", "c/machine.toml", "--unit", "um", "--runs", "forward", "--axis", "X",
           "--tool", "long", "-o", "o"]
    head = b"HEADER::\nOwner: Linear\nTARGET DATA::\nTargets :\n"
    deviations = b"DEVIATIONS::\nRun Target Data:\n"
    many = b"".join(b"%d\n" % i for i in range(100000))
    return [
        bad("import of an empty file", put("f", b""), "empty", use),
        bad("import of NUL bytes", put("f", bytes(1000)), "NUL", use),
        bad("import of random bytes", put("f", random.Random(3).randbytes(5000)), ".", use),
        bad("import of a picture", put("f", b"\x89PNG\r\n\x1a\n" + bytes(range(1, 256)) * 10), ".", use),
        bad("import of half a UTF-16 character", put("f", b"\xff\xfeH"), ".", use),
        bad("import of a line of 10 MB", put("f", b"1," * 5_000_000), ".", use),
        bad("import of 10^5 lines without a table", put("f", b"word\n" * 100000), "not understood", use),
        bad("import of 10^5 targets without deviations", put("f", head + many), "no deviations", use),
        bad("import of a run beyond all numbers",
            put("f", head + b"0 1\n" + deviations + b"9" * 30 + b" 1 0\n"), "f:8", use),
        bad("import of a deviation of 1e400",
            put("f", head + b"0 1\n" + deviations + b"1 1 1e400\n1 2 0\n"), "f:8", use),
        bad("import of 10^5 words of a user",
            put("f", head + b"USER-TEXT::\n" + b"Name: x\n" * 100000), "two positions", use),
        bad("import of a folder", lambda folder: os.makedirs(os.path.join(folder, "f")), "directory", use),
        bad("import of a name that is a command line", put("f", b"a;b\n1;2\n"), ".",
            [*use, "--set", "noise = { constant_um = 1 }\n[x]"]),
        bad("import over its own file", put("o/f", head), ".", ["import", "o/f", *use[2:]]),
    ]


def rows():
    return [*toml(), *csv(), *imports(), *results(), *programs(), *models(), *studies()]

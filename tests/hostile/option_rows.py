"""Hostile command lines."""
from runner import FIT, Row

DRAW = ["montecarlo", "c/campaign.toml", "-o", "o"]
PLAN = ["plan", "c/machine.toml", "-o", "o"]
TABLES = ["tables", "r", "--format", "csv", "-o", "o"]
COMPARE = ["compare", "c/campaign.toml", "r"]


def bad(name, arguments, says):
    return Row(name, arguments, 2, says)


def numbers_of(option, command, texts, says="number|must|range|at most|at least|Could not convert|not"):
    """Texts that an option must refuse."""
    return [bad(f"{command[0]} {option} {text[:24]}", [*command, option, text], says) for text in texts]


def usage():
    return [
        bad("no command", [], "volcal: .*subcommand|command is required"),
        bad("unknown command", ["fitt"], "did you mean"),
        bad("unknown option", [*FIT, "--threds", "2"], "--threads"),
        bad("option of another command", [*FIT, "--draws", "10"], "there is no option"),
        bad("short option of another command", [*FIT, "-n", "10"], "-n"),
        bad("option without value", ["fit", "c/campaign.toml", "-o"], "output|-o"),
        bad("output missing", ["fit", "c/campaign.toml"], "--output"),
        bad("campaign missing", ["fit", "-o", "o"], "CAMPAIGN"),
        bad("two campaigns", ["fit", "c/campaign.toml", "c/campaign.toml", "-o", "o"], "campaign.toml"),
        bad("duplicated output", [*FIT, "-o", "p"], "output"),
        bad("duplicated threads", [*FIT, "--threads", "1", "--threads", "2"], "threads"),
        bad("empty output", ["fit", "c/campaign.toml", "-o", ""], "output"),
        bad("empty campaign", ["fit", "", "-o", "o"], "."),
        bad("empty argument", [*FIT, ""], "."),
        Row("end of options", [*FIT, "--"], (1, 2), "."),
        bad("unknown word of a choice", [*FIT, "--robust", "tukey"], "huber"),
        bad("choice with capital", [*FIT, "--noise", "White"], "white"),
        bad("unknown table format", ["tables", "r", "--format", "excel", "-o", "o"], "excel"),
        bad("unknown compensation type", [*TABLES, "--type", "L-FOO"], "L-FOO"),
        bad("unknown study", ["study", "nothing"], "nothing"),
        bad("unknown structure", ["init", "w Q t", "-o", "o"], "structur|axis|Q"),
        bad("empty structure", ["init", "", "-o", "o"], "."),
        bad("very long structure", ["init", "w " + "X " * 5000 + "t", "-o", "o"], "."),
        bad("effect that is none", ["extend", "c/model.toml", "-e", ":::::", "-o", "x.toml"], "effect|kind"),
        bad("effect of 10,000 letters", ["extend", "c/model.toml", "-e", "q" * 10000, "-o", "x.toml"], "."),
        bad("effect with markup", ["extend", "c/model.toml", "-e", "<script>:EXX", "-o", "x.toml"], "."),
        bad("disturbance without size", [*DRAW, "--disturb", "length-scale:readings"], "how large"),
        bad("disturbance of nothing", [*DRAW, "--disturb", "="], "how large"),
        bad("disturbance of 1e300", [*DRAW, "--disturb", "length-scale:readings=1e300"], "no effect is so large"),
        bad("disturbance of inf", [*DRAW, "--disturb", "length-scale:readings=inf"], "how large"),
        bad("disturbance within nan", [*DRAW, "--disturb", "length-scale:readings=+-nan"], "how large"),
        bad("disturbance below zero", [*DRAW, "--disturb", "length-scale:readings=-1"], "how large"),
        bad("seed of text", [*DRAW, "--seed", "lucky"], "number"),
        bad("escape in an option", [*FIT, "--\x1b[31mred"], "option"),
        bad("newline in an option", [*FIT, "--a\nb"], "option"),
        bad("rank beyond the list", ["extend", "c/model.toml", "--diagnosis", "r", "--rank", "999999", "-o", "x.toml"],
            "diagnosis"),
        bad("compensate onto its input", ["compensate", "r", "c/S1.csv", "-o", "c/S1.csv"], "."),
        bad("output onto the campaign's folder", ["fit", "c/campaign.toml", "-o", "c"], "holds|files"),
        bad("output is the current folder", ["fit", "c/campaign.toml", "-o", "."], "current directory"),
        bad("output is a file", ["fit", "c/campaign.toml", "-o", "c/S1.csv"], "file"),
        bad("output below a file", ["fit", "c/campaign.toml", "-o", "c/S1.csv/o"], "."),
        bad("output at the root", ["fit", "c/campaign.toml", "-o", "/"], "."),
        bad("result onto itself", ["align", "r", "--origin", "X=0", "-o", "r"], "."),
        bad("session onto the campaign", ["session", "c/campaign.toml", "-o", "c/campaign.toml"], "is read"),
        bad("session onto its readings", ["session", "c/campaign.toml", "-o", "c/S1.csv"], "is read"),
        bad("export onto its result", ["export", "r", "--npz", "r/result.json"], "is read"),
        bad("export onto a folder", ["export", "r", "--npz", "c"], "cannot be written"),
        bad("export below a file", ["export", "r", "--gtc", "c/S1.csv/x"], "cannot be written"),
        bad("reference onto the campaign's folder", ["help", "-o", "c"], "holds|files"),
        bad("help of nothing", ["help", "fit", "fit", "fit"], "there is no command"),
        bad("negative file names", ["fit", "-1", "-o", "o"], "."),
        Row("help with rubbish", ["fit", "--help", "--rubbish"], (0, 2), "."),
        Row("version", ["--version"], 0, r"^\d+\.\d+"),
        Row("help", ["--help"], 0, "Usage"),
    ]


def numbers():
    rubbish = ["nan", "inf", "-inf", "1e400", "0x10z", "1,5", "", " ", "1e", "--", "٣"]
    whole = ["-1", "1e30", "99999999999999999999999999", *rubbish]
    return [
        *numbers_of("--threads", FIT, [*whole, "100000", "2147483648"]),
        *numbers_of("--draws", DRAW, whole),
        *numbers_of("--seed", DRAW, ["-1", "18446744073709551616", "nan", "1e400"]),
        *numbers_of("--refits", DRAW, ["-1", "1001", "inf"]),
        *numbers_of("--grid", DRAW, ["-1", "1000", "nan"]),
        *numbers_of("--digits", DRAW, ["0", "3", "nan"]),
        *numbers_of("--checkpoint-every", DRAW, ["-1", "nan", "1e300"]),
        *numbers_of("--readings", PLAN, ["0", "15", "1e9", "nan", "-5"]),
        *numbers_of("--time", PLAN, ["0", "-1", "nan", "1e300"]),
        *numbers_of("--stations", PLAN, ["0", "13", "1e18"]),
        *numbers_of("--feed-mm-min", PLAN, ["0", "-1", "1e300", "nan"]),
        *numbers_of("--bar-mm", PLAN, ["0", "-1", "inf", "1e300"]),
        *numbers_of("--clearance-mm", PLAN, ["-1", "inf", "1e300"]),
        *numbers_of("--worst", COMPARE, ["-1", "nan", "1e300"]),
        *numbers_of("--max-rms-um", ["validate", "r", "c/campaign.toml"], ["0", "-1", "nan", "inf", "1e300"]),
        *numbers_of("--rank", ["extend", "c/model.toml", "--diagnosis", "r", "-o", "x.toml"], ["0", "-1", "nan"], "."),
        *numbers_of("--at", ["tables", "r"], ["X=", "X=nan", "X=1e400", "Q=1", "X=1,X=2", "=", ","], "."),
        *numbers_of("--readings", ["diagnose", "c/campaign.toml", "-o", "o"], ["0", "10001", "nan"]),
    ]


def rows():
    return [*usage(), *numbers()]

"""A real mill with a B/C head (docs/real-machines.md): what a fit of its probe contacts leaves.

usage: bc_head_mill_test.py PROGRAM SCRIPT. The measurements are not part of the project: VOLCAL_REFERENCE_DATA names
a folder that holds bc-head-mill/contacts.csv of the public repository alj333/linuxcnc; without it the test is skipped.
"""

import importlib.machinery
import importlib.util
import os
import pathlib
import sys
import tempfile

SKIPPED = 77
MOST_FITTED_MM = 0.03  # RMS of a pose: three times its repeatability
LEAST_BY_LOCATIONS_MM = 0.2  # location errors alone leave more, as a separate program found: 0.241
MOST_OF_A_TILT_MM = 0.087  # what another program's model of few right effects leaves of left-out tilts
MOST_OF_A_TURN_MM = 0.039  # and of left-out turns


def load(script):
    loader = importlib.machinery.SourceFileLoader("bc_head_mill", str(script))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("bc_head_mill", loader))
    sys.dont_write_bytecode = True
    loader.exec_module(module)
    return module


def rms_of_poses(mill, contacts, model, program, folder):
    mill.write_campaign(contacts, ["2026082404"], folder)
    residuals = mill.fit(program, folder, mill.MODELS[model], "result")
    poses = mill.pose_vectors(residuals, mill.contacts_by_setup(contacts))
    assert len(poses) == 101, len(poses)
    return mill.figures([vector for _, vector in poses])[0]


def rms_of_left_out(mill, contacts, program, folder, key, value):
    """Of poses that a model of few functions was not fitted to."""
    mill.write_campaign(contacts, ["2026082404"], folder, left_out=lambda contact: key(contact) == value)
    residuals = mill.fit(program, folder, mill.MODELS["eleven functions and a period"], "result")
    poses = mill.pose_vectors(residuals, mill.contacts_by_setup(contacts))
    return mill.figures([vector for contact, vector in poses if key(contact) == value])[0]


def main():
    program, script = sys.argv[1:3]
    data = pathlib.Path(os.environ.get("VOLCAL_REFERENCE_DATA", "")) / "bc-head-mill"
    if not (data / "contacts.csv").is_file():
        print("skipped: VOLCAL_REFERENCE_DATA names no folder with bc-head-mill/contacts.csv")
        return SKIPPED
    mill = load(script)
    contacts = mill.read_contacts(data)
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch)
        all_errors = rms_of_poses(mill, contacts, "all error functions", program, out / "all")
        locations = rms_of_poses(mill, contacts, "location errors of B and C", program, out / "locations")
        tilt = rms_of_left_out(mill, contacts, program, out / "tilt", mill.tilt, 60.0)
        turn = rms_of_left_out(mill, contacts, program, out / "turn", mill.turn, 180.0)
    print(f"RMS of a pose: all error functions {all_errors:.4f} mm, location errors alone {locations:.4f} mm")
    print(f"of eleven functions where |B| = 60 deg was left out {tilt:.4f} mm, where C = 180 deg was {turn:.4f} mm")
    fits = all_errors < MOST_FITTED_MM and locations > LEAST_BY_LOCATIONS_MM
    return 0 if fits and tilt < MOST_OF_A_TILT_MM and turn < MOST_OF_A_TURN_MM else 1


if __name__ == "__main__":
    sys.exit(main())

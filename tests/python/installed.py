"""The module as `cmake --install` leaves it: imported from there, and nothing else of the build.

Usage: installed.py CMAKE BUILD FOLDER     (FOLDER: of Python packages, below the prefix)
"""

import os
import pathlib
import subprocess
import sys
import tempfile

cmake, build, packages = sys.argv[1:]
with tempfile.TemporaryDirectory() as prefix:
    subprocess.run([cmake, "--install", build, "--prefix", prefix], stdout=subprocess.DEVNULL, check=True)
    code = "import volcal; print(volcal.__file__, volcal.__version__, len(volcal.effect_kinds()))"
    environment = {**os.environ, "PYTHONPATH": f"{prefix}/{packages}"}
    said = subprocess.run([sys.executable, "-B", "-c", code], cwd=prefix, env=environment, stdout=subprocess.PIPE,
                          text=True, check=True).stdout
    folder = pathlib.Path(said.split()[0]).parent
    if not str(folder).startswith(prefix) or sorted(p.suffix for p in folder.iterdir()) != [".py", ".pyi", ".so", ".typed"]:
        sys.exit(f"installed: {said} {sorted(folder.iterdir())}")
    print("installed:", said, end="")

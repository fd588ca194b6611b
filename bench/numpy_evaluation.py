"""What bench/evaluation_against_numpy.py times of numpy: covariances on a grid, reading a file of numbers.

    numpy_evaluation.py volume FOLDER PARAMETERS REPEATS
    numpy_evaluation.py csv FOLDER REPEATS

FOLDER is that of evaluation_bench. `volume`: three rows of derivatives per node are given; covariances by products
of whole matrices, in blocks that stay in the caches, or of all rows at once, whichever is faster. Prints JSON.
"""

import json
import pathlib
import sys
import time

import numpy as np

from scipy_fit import blas_core, peak_memory

BLOCK = 441  # nodes
UPPER = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


def covariances(rows, covariance, block):
    """xx xy xz yy yz zz of every node."""
    nodes = len(rows) // 3
    result = np.empty((nodes, len(UPPER)))
    for begin in range(0, nodes, block):
        end = min(nodes, begin + block)
        left = rows[3 * begin:3 * end]
        weighted = (left @ covariance).reshape(end - begin, 3, -1)
        full = weighted @ left.reshape(end - begin, 3, -1).transpose(0, 2, 1)
        for column, (i, j) in enumerate(UPPER):
            result[begin:end, column] = full[:, i, j]
    return result


def timed(work, repeats):
    work()
    times = []
    for _ in range(repeats):
        clock = time.perf_counter()
        result = work()
        times.append(time.perf_counter() - clock)
    return result, times


def volume(folder, parameters, repeats):
    covariance = np.fromfile(folder / "covariance.f64").reshape(parameters, parameters)
    rows = np.fromfile(folder / "rows.f64").reshape(-1, parameters)
    expected = np.fromfile(folder / "covariances.f64").reshape(-1, len(UPPER))
    tries = [timed(lambda size=size: covariances(rows, covariance, size), repeats)
             for size in (BLOCK, len(rows) // 3)]
    result, times = min(tries, key=lambda each: np.median(each[1]))
    return {"numpy_s": times, "difference": float(np.max(np.abs(result - expected)) / np.max(np.abs(expected)))}


def csv(folder, repeats):
    table, times = timed(lambda: np.loadtxt(folder / "readings.csv", delimiter=",", skiprows=1), repeats)
    return {"numpy_s": times, "readings": len(table), "sum": float(table.sum())}


def main():
    folder = pathlib.Path(sys.argv[2])
    figures = volume(folder, *map(int, sys.argv[3:5])) if sys.argv[1] == "volume" else csv(folder, int(sys.argv[3]))
    figures["blas"], figures["threads"] = blas_core()
    figures["peak_bytes"] = peak_memory()
    print(json.dumps(figures))


if __name__ == "__main__":
    main()

"""The projection step of model criticism in numpy: what bench/projection_against_numpy.py times.

    numpy_projection.py FOLDER REPEATS     (FOLDER from criticism_bench --write)

Prints JSON: seconds of the set-up (whitening and factor of the model's columns) and of the step (whitening the
candidates' columns, projecting them, LM of every shape), the largest relative difference of LM, and
peak memory.
"""

import json
import pathlib
import sys
import time

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from scipy_fit import blas_core, peak_memory

VISIBLE = 1e-8  # least eigenvalue of a normalised Gram matrix, as in score_test


def matrix(path, rows):
    return np.fromfile(path, dtype="<f8").reshape((rows, -1), order="F")


def factors(problem):
    """Rows of each sequence that are not left out, and the Cholesky factor of their noise."""
    noise, sigma = problem["noise"], np.array([np.inf if s is None else s for s in problem["sigma"]])
    parts = []
    for sequence in problem["sequences"]:
        rows = np.array(sequence["observation"])
        used = np.isfinite(sigma[rows])
        rows, time_s, line = rows[used], np.array(sequence["time"])[used], np.array(sequence["line"])[used]
        covariance = noise["wander"] ** 2 * np.exp(-np.abs(time_s[:, None] - time_s) / noise["tau"])
        covariance += noise["line"] ** 2 * (line[:, None] == line)
        covariance[np.diag_indices_from(covariance)] += (noise["white"] * sigma[rows]) ** 2
        parts.append((rows, cholesky(covariance, lower=True, check_finite=False)))
    return parts


def whiten(parts, columns):
    whitened = np.empty((sum(len(rows) for rows, _ in parts), columns.shape[1]), order="F")
    at = 0
    for rows, lower in parts:
        together = rows[-1] - rows[0] + 1 == len(rows)
        of_part = columns[rows[0]:rows[-1] + 1] if together else columns[rows]
        whitened[at:at + len(rows)] = solve_triangular(lower, of_part, lower=True, check_finite=False)
        at += len(rows)
    return whitened


class Projection:
    def __init__(self, problem, jacobian, residual, precision, mean):
        self.parts = factors(problem)
        self.jacobian, self.residual = whiten(self.parts, jacobian), whiten(self.parts, residual)[:, 0]
        normal = self.jacobian.T @ self.jacobian + precision
        self.scale = 1.0 / np.sqrt(np.diag(normal))
        self.lower = cholesky(normal * self.scale * self.scale[:, None], lower=True, check_finite=False)
        right = self.jacobian.T @ self.residual + (precision @ mean)[:, 0]
        self.rotated = solve_triangular(self.lower, self.scale * right, lower=True, check_finite=False)

    def lm(self, columns, widths):
        whitened = whiten(self.parts, columns)
        explained = solve_triangular(self.lower, self.scale[:, None] * (self.jacobian.T @ whitened), lower=True,
                                     check_finite=False)
        score = whitened.T @ self.residual - explained.T @ self.rotated
        norm = np.sqrt(np.einsum("ij,ij->j", whitened, whitened))
        first = np.concatenate([[0], np.cumsum(widths)[:-1]])
        result = np.zeros(len(widths))
        for width in np.unique(widths):  # all shapes of one width together
            index = np.flatnonzero(widths == width)
            at = first[index][:, None] + np.arange(width)
            gram = np.empty((len(index), width, width))
            for i in range(width):
                for j in range(i + 1):
                    gram[:, i, j] = (np.einsum("ij,ij->j", whitened[:, at[:, i]], whitened[:, at[:, j]])
                                     - np.einsum("ij,ij->j", explained[:, at[:, i]], explained[:, at[:, j]]))
                    gram[:, j, i] = gram[:, i, j]
            scale = np.divide(1.0, norm[at], out=np.zeros_like(norm[at]), where=norm[at] > 0.0)
            value, vector = np.linalg.eigh(gram * scale[:, :, None] * scale[:, None, :])
            along = np.einsum("sij,si->sj", vector, scale * score[at])
            visible = value >= VISIBLE
            result[index] = np.sum(np.where(visible, along ** 2 / np.where(visible, value, 1.0), 0.0), axis=1)
        return result


def main():
    folder, repeats = pathlib.Path(sys.argv[1]), int(sys.argv[2])
    problem = json.loads((folder / "problem.json").read_text())
    rows, parameters = problem["observations"], problem["parameters"]
    arrays = (matrix(folder / "jacobian.f64", rows), matrix(folder / "residual.f64", rows),
              matrix(folder / "precision.f64", parameters), matrix(folder / "mean.f64", parameters))
    columns, widths = matrix(folder / "columns.f64", rows), np.array(problem["widths"])
    figures = {"setup_s": [], "projection_s": []}
    for _ in range(repeats):
        clock = time.perf_counter()
        projection = Projection(problem, *arrays)
        figures["setup_s"].append(time.perf_counter() - clock)
        clock = time.perf_counter()
        lm = projection.lm(columns, widths)
        figures["projection_s"].append(time.perf_counter() - clock)
    expected = np.array(problem["lm"])
    figures["difference"] = float(np.max(np.abs(lm - expected) / (1.0 + expected)))
    figures["blas"], figures["threads"] = blas_core()
    figures["peak_bytes"] = peak_memory()
    print(json.dumps(figures))


if __name__ == "__main__":
    main()

"""The reference problem by scipy.optimize.least_squares, trust-region reflective, analytic Jacobian.

    scipy_fit.py DIR --repeats N [--x-scale 1|jac] [--check]

DIR holds problem.json and readings.f64 as fit_bench --write stores them. Model, basis, parameters, weights and
start are those of the C++ fit; the splines are scipy's own. Prints figures as JSON. The clock stops at the first
evaluation whose cost is the target's to 1e-11. --check compares cost and Jacobian and times nothing.
"""

import argparse
import ctypes
import json
import pathlib
import time

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import least_squares

SAME_COST = 1e-11  # relative


def read_problem(folder):
    problem = json.loads((folder / "problem.json").read_text())
    readings = np.fromfile(folder / "readings.f64").reshape(-1, 5)
    return problem, readings


def spline_values(axis, positions):
    """All basis functions of an axis at the positions, one row each."""
    degree, breakpoints = axis["degree"], np.array(axis["breakpoints"])
    knots = np.r_[[breakpoints[0]] * degree, breakpoints, [breakpoints[-1]] * degree]
    return BSpline.design_matrix(positions, knots, degree).toarray()


class Fit:
    """Residuals and Jacobian of the campaign in the reduced parameters z."""

    def __init__(self, problem, readings):
        self.problem = problem
        self.size = len(problem["start"])
        columns = np.ascontiguousarray(readings.T)
        self.position = dict(zip("XYZ", columns[:3]))
        self.length, self.inverse_sigma = columns[3], 1.0 / columns[4]
        rows = [setup["rows"] for setup in problem["setups"]]
        self.row_ends = np.cumsum(rows)
        self._bind_kinematics(rows)
        self._bind_functions()
        self._bind_blocks()

    def _bind_kinematics(self, rows):
        """Nominal points and the arm of every axis, m; see the header of chain.h for the equations."""
        point = np.repeat([setup["tool"] for setup in self.problem["setups"]], rows, axis=0).T.copy()
        self.arm = {}
        for joint in reversed(self.problem["joints"]):
            name = joint["name"]
            reference = np.array(joint["reference_point"])[:, None]
            before = point - reference
            point["XYZ".index(name)] += self.position[name]
            self.arm[name] = point - reference if joint["workpiece_side"] else before
        self.nominal = point

    def _bind_functions(self):
        """Spline values times the datum's basis; functions that share both share the matrix."""
        values = {j["name"]: spline_values(j, self.position[j["name"]]) for j in self.problem["joints"]}
        self.functions, distinct = [], {}
        for function in self.problem["functions"]:
            axis, columns = function["axis"], function["basis_columns"]
            key = (axis, json.dumps(columns))
            if key not in distinct:
                distinct[key] = np.asfortranarray(values[axis] @ np.array(columns).T)
            first = function["offset"]
            self.functions.append(
                (axis, function["component"], slice(first, first + len(columns)), distinct[key]))

    def _bind_blocks(self):
        self.squareness, self.nuisance = [], []
        for block in self.problem["blocks"]:
            if "axis" in block:
                turn, along = np.eye(3)[block["component"] - 3], np.eye(3)["XYZ".index(block["axis"])]
                lever = np.cross(turn, along)[:, None] * self.position[block["axis"]]
                self.squareness.append((block["offset"], lever))
        offsets = {block["name"]: block["offset"] for block in self.problem["blocks"]}
        for setup, begin, end in zip(self.problem["setups"], np.r_[0, self.row_ends[:-1]], self.row_ends):
            name = setup["name"]
            self.nuisance.append((slice(begin, end), offsets[f"station {name}"], offsets[f"{name}: dead path"]))

    def _from_station(self, z):
        """Vectors from the station to the displaced point, 3 x N."""
        displacement = {axis: np.zeros((6, self.length.size)) for axis in self.arm}
        for axis, component, part, values in self.functions:
            displacement[axis][component] = values @ z[part]
        point = self.nominal.copy()
        for axis, motion in displacement.items():
            point += motion[:3]
            arm, turn = self.arm[axis], motion[3:]
            point[0] += turn[1] * arm[2] - turn[2] * arm[1]
            point[1] += turn[2] * arm[0] - turn[0] * arm[2]
            point[2] += turn[0] * arm[1] - turn[1] * arm[0]
        for offset, lever in self.squareness:
            point += z[offset] * lever
        for rows, station, _ in self.nuisance:
            point[:, rows] -= z[station:station + 3, None]
        return point

    def residuals(self, z):
        distance = np.sqrt(np.sum(self._from_station(z) ** 2, axis=0))
        for rows, _, dead_path in self.nuisance:
            distance[rows] -= z[dead_path]
        return (distance - self.length) * self.inverse_sigma

    def jacobian(self, z):
        beam = self._from_station(z)
        beam *= self.inverse_sigma / np.sqrt(np.sum(beam ** 2, axis=0))
        jacobian = np.zeros((self.length.size, self.size), order="F")
        weight = {axis: np.vstack([beam, np.cross(arm, beam, axis=0)]) for axis, arm in self.arm.items()}
        for axis, component, part, values in self.functions:
            np.multiply(values, weight[axis][component][:, None], out=jacobian[:, part])
        for offset, lever in self.squareness:
            np.sum(beam * lever, axis=0, out=jacobian[:, offset])
        for rows, station, dead_path in self.nuisance:
            jacobian[rows, station:station + 3] = -beam[:, rows].T
            jacobian[rows, dead_path] = -self.inverse_sigma[rows]
        return jacobian

    def cost(self, z):
        residuals = self.residuals(z)
        return 0.5 * residuals @ residuals


class Reached(Exception):
    """Leaves the solver when the target cost is reached."""


def seconds_to_target(fit, x_scale):
    """Time to the first evaluation at the target cost, and the number of evaluations."""
    target = fit.problem["cost"] * (1.0 + SAME_COST)
    evaluations = 0

    def residuals(z):
        nonlocal evaluations
        evaluations += 1
        values = fit.residuals(z)
        if 0.5 * values @ values <= target:
            raise Reached
        return values

    start = np.array(fit.problem["start"])
    begin = time.perf_counter()
    try:
        least_squares(residuals, start, jac=fit.jacobian, method="trf", x_scale=x_scale,
                      ftol=1e-15, xtol=1e-15, gtol=1e-15, max_nfev=100)
    except Reached:
        return time.perf_counter() - begin, evaluations
    raise RuntimeError("the target cost was not reached")


def check(fit):
    """Relative difference of the costs at the C++ solution, and of the Jacobian from central differences."""
    solution = np.array(fit.problem["solution"])
    analytic = fit.jacobian(solution)
    step = 1e-5
    numeric = [(fit.residuals(solution + h) - fit.residuals(solution - h)) / (2.0 * step)
               for h in step * np.eye(fit.size)]
    scale = np.abs(analytic).max(axis=0)
    return {"cost_difference": fit.cost(solution) / fit.problem["cost"] - 1.0,
            "jacobian_difference": np.max(np.abs(np.array(numeric).T - analytic) / scale)}


def blas_core():
    """Core of the OpenBLAS that numpy has loaded, and its number of threads."""
    libraries = {line.split()[-1] for line in open("/proc/self/maps") if "blas" in line and ".so" in line}
    for library in libraries:
        loaded = ctypes.CDLL(library)
        for suffix in ("", "64_"):
            name = getattr(loaded, f"openblas_get_corename{suffix}", None)
            if name is not None:
                name.restype = ctypes.c_char_p
                return name().decode(), getattr(loaded, f"openblas_get_num_threads{suffix}")()
    return "not OpenBLAS", 1


def peak_memory():
    for line in open("/proc/self/status"):
        if line.startswith("VmHWM:"):
            return 1024 * int(line.split()[1])
    raise RuntimeError("/proc/self/status has no VmHWM")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--x-scale", default="1", choices=["1", "jac"])
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    problem, readings = read_problem(arguments.folder)
    begin = time.perf_counter()
    fit = Fit(problem, readings)
    setup = time.perf_counter() - begin
    if arguments.check:
        print(json.dumps(check(fit)))
        return
    x_scale = 1.0 if arguments.x_scale == "1" else "jac"
    times, evaluations = zip(*(seconds_to_target(fit, x_scale) for _ in range(arguments.repeats)))
    core, threads = blas_core()
    print(json.dumps({"readings": len(readings), "threads": threads, "blas": core, "setup_s": [setup],
                      "fit_s": times, "evaluations": evaluations[0], "peak_bytes": peak_memory()}))


if __name__ == "__main__":
    main()

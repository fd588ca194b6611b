#pragma once
/// study.toml: a machine, its hidden truth, surroundings and measurements, for `volcal simulate`.
///
///     format = "volcal-study-1"
///     machine = "machine.toml"
///     seed = 1
///     pause_s = 600.0                    # between setups
///     unseen = true                      # truth/unseen and hidden.json also when nothing is hidden
///     [truth]                            # all optional
///     kind = "random"                    # or "perfect"
///     errors = "model.toml"              # known errors in place of all others: model, tables or result
///     volumetric_rms_um = [15.5, 21.5]   # after rigid alignment, drawn from this range
///     angular_scale, squareness_scale, wave_scale = 1.0
///     reversal_max_um, angular_reversal_max_urad = 0.0
///     [truth.locations_urad]             # rotations in place of random ones: EC0Y = 12.0
///     [truth.locations_um]               # displacements of rotary axes: EX0C = 10.0
///     [truth.functions]                  # in place of random ones, as in model files, with coefficients:
///     EXC = { basis = "fourier", degree = 1, coefficients_um = [0.0, 3.0, -2.0] }
///     [truth.reversals_um]               # EXX = 3.0
///     [truth.reversals_urad]             # EAX = 4.0
///     [truth.expansions.X]               # unknown to the machine file
///     expansion_um_per_m_K = 10.0
///     temperature = "X"
///     [[temperatures]]
///     channel = "X"
///     start_degC, drift_K_per_hour, amplitude_K, period_s, phase_deg, step_K, step_time_s
///     [compensation]                     # of the control while everything is measured
///     tables = "tables"                  # folder that volcal tables wrote
///     least_increment_um = 1.0           # corrections come in whole steps of it; absent = as computed
///     wrong_tool_length_mm = 0.0         # by which every tool is longer than the control knows
///     [validation]
///     points = 400
///     tools = ["short"]
///     [[measurements]]                   # setups' names start with `name`
///     kind = "laser-tracer" | "laser-tracker" | "ball-bar-circles" | "diagonals" | "axis-lines" |
///            "straightness-lines" | "squares" | "angle-lines" | "point-grid" |
///            "r-test" | "probed-sphere" | "ball-bar-poses" | "axis-of-rotation" | "drift-at-rest"
///     shuffled = true                    # lines in random order
///     noise = { constant_um, per_metre_um, repeatability_um,            # the campaign file states these;
///               wander_um, wander_time_s, line_um, outlier_share, outlier_sigma }   # these are sealed
///     [[hidden]]                         # an effect that the campaign file does not know of
///     kind = "screw-lead"                # the kinds and their keys: sim/hidden/hidden_effects.h
///     symbol = "EXX"
///     period_mm = 10.0
///     amplitude_um = 2.0                 # or rms_um = 0.8, of its effect on the readings
/// Rotary axes move in r-test, probed-sphere and ball-bar-poses and, on a grid or at random, with rotary =
/// "grid" | "random" in trackings and point-grid
/// ([docs/guides/calibrate-a-five-axis-machine.md](../../docs/guides)):
///     kind = "r-test"
///     tools = ["short", "long"]          # each with every sphere; absent: the machine's first three
///     positions = { A = 7, C = 12 }      # of each rotary axis
///     range_deg = { A = [-90.0, 30.0] }  # absent: the travel
///     poses = "grid"                     # every combination, or "singly": one axis after another
///     [[measurements.spheres]]
///     name = "S1"
///     position_mm = [120.0, 0.0, -350.0] # workpiece coordinates
/// Direct tests of a standard:
///     kind = "angle-lines"               # ISO 230-2: of a rotary axis the angle about itself
///     axes = ["C"]                       # absent: X, Y, Z
///     kind = "axis-of-rotation"          # ISO 230-7: a sphere on the line of an axis that turns alone
///     axes = ["C"]                       # absent: every rotary axis
///     tools = ["short"]                  # absent: the first
///     heights_mm = [0.0, 100.0]          # of spheres along the line from centre_mm; two tell tilts
///     points, runs, frame, bidirectional
///     kind = "drift-at-rest"             # ISO 230-3: nothing moves, tools are read at the same times
///     tools = ["short", "long"]          # absent: the first; two lengths tell tilts
///     duration_s = 14400.0
///     reading_s = 300.0
/// Keys of a measurement: study_measurements.cpp; defaults: sim/measurement/measurements.h.

#include <string>

#include "volcal/identify/text/toml_document.h"
#include "volcal/sim/study.h"

namespace volcal {

inline constexpr const char* kStudyFormat = "volcal-study-1";

/// Reads a study and its machine. Throws InputError with file, line, problem and remedy.
sim::Study read_study(const std::string& path);
/// The same from text with a given machine (its `machine` key is not followed).
sim::Study parse_study(const std::string& text, const std::string& file, const Machine& machine);

/// Known errors (known_errors.h) as the truth of a machine: functions, locations and effects, and of a result
/// the expansions and tool offsets that it identified. Throws InputError; also for errors of another machine,
/// and for those that state no value.
sim::TruthSettings known_truth(const std::string& path, const Machine& machine,
                               const SourcePlace& named_at = {});

/// The compensation of a folder of tables, with what is said of it in campaign files. Throws InputError.
sim::ActiveCompensation active_compensation(const std::string& folder, double least_increment);

/// One [[measurements]] table.
sim::Measurement read_measurement(const TomlTable& table);

/// One [[hidden]] table.
sim::HiddenEffect read_hidden_effect(const TomlTable& table);

}  // namespace volcal

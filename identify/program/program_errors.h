#pragma once
/// The errors that a program meets on an identified machine, and the commands that cancel them. Positions are
/// those of the axes X, Y, Z in machine coordinates, m.

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "volcal/identify/errors/error_field.h"
#include "volcal/identify/program/nc_state.h"

namespace volcal {

struct ProgramErrors {
  Machine machine;
  /// Field of a functional point, m from the spindle reference.
  std::function<DisplacementField(const Eigen::Vector3d& tool_offset)> field;
  MeasuredTravel measured;  ///< beyond it errors are held
  /// Ends of the intervals of each axis on which the errors are smooth and a polynomial of degree 4 follows
  /// them; ascending.
  std::array<std::vector<double>, 3> pieces;
};

/// Of a result at stated conditions, effects of the machine included; rotary axes stand at 0. `tool`: for
/// effects that belong to one tool; the machine's by this name, or none.
ProgramErrors program_errors(const FitResult& result, const std::string& tool, const Conditions& conditions);

/// Where the functional point is.
struct FunctionalPoint {
  Eigen::Vector3d without_length = Eigen::Vector3d::Zero();  ///< while no tool length is active (G49), m
  /// Point that tool lengths are measured from, m from the spindle reference: with length L active the
  /// functional point is at `lengths_from` - L.
  Eigen::Vector3d lengths_from = Eigen::Vector3d::Zero();

  Eigen::Vector3d at(const NcState& state) const {
    return state.length_active ? Eigen::Vector3d(lengths_from - state.length) : without_length;
  }
};

/// The functional point while no tool length is active: that of `tool`, by default the machine's first one;
/// tool lengths count from the spindle reference, or are differences to the tool `lengths_from`. Throws
/// InputError.
FunctionalPoint functional_point(const Machine& machine, const std::string& tool,
                                 const std::string& lengths_from);

/// Of a machine, nothing set but its homes. Throws InputError for a machine without X, Y or Z.
NcSetup nc_setup(const Machine& machine);

/// Sign of every linear axis's motion; axes that move less than a picometre keep theirs.
void turn_directions(const Eigen::Vector3d& motion, ApproachDirection& directions);

/// Solves p' = p - e(p') for one functional point.
class CommandSolver {
 public:
  /// Corrections along axes that the machine lacks are left out.
  CommandSolver(const Machine& machine, DisplacementField errors);

  Eigen::Vector3d error(const Eigen::Vector3d& position, const ApproachDirection& directions) const;
  /// `steepness`: bound of the change of the error per m of motion, L. Iteration then ends at a step of
  /// 1 nm (1 - L) / L, behind which less than 1 nm is to come.
  void set_steepness(double steepness);
  /// The command at which the functional point is where it would be at `position` without errors, to 1 nm; by
  /// fixed-point iteration from the last solution. Throws std::runtime_error where it does not converge.
  Eigen::Vector3d command(const Eigen::Vector3d& position, const ApproachDirection& directions);

 private:
  DisplacementField errors_;
  Eigen::Vector3d movable_;
  Eigen::Vector3d last_correction_ = Eigen::Vector3d::Zero();
  double last_step_ = 1e-9;  ///< m
};

}  // namespace volcal

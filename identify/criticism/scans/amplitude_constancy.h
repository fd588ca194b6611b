#pragma once
/// Is the amplitude of an effect the same everywhere? A wrong name follows what it stands for only on
/// average: its amplitude then varies with the driver (another shape) or with something else that was
/// recorded (another effect). Score test against amplitudes that vary (parameter constancy; Nyblom 1989, JASA
/// 84, 223; Hansen 1992, J. Policy Modeling 14, 517), smoothly or as a random walk, with one recorded
/// variable: a few degrees of freedom along the effect's own derivative see what a scan of the whole volume
/// misses.

#include <string>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/scans/generic_scan.h"

namespace volcal {

struct ConstancyTest {
  std::string variable;
  double log10_p = 0.0;  ///< over both kinds of variation and the variables of its group
};

/// How far every axis has gone since it last turned round, along the readings of a setup: "travel since
/// dir_y". A reversal that is taken up on the way, or dies away, varies with it. No variable of the scans.
std::vector<ScanVariable> travel_since_turning(const LinearModel& model);

/// The least probable one, of the effect's own variables (its drivers, the position of the axis that it
/// moves, the travel since turning where a direction drives it) and of all others, each group for itself;
/// what a machine does varies with no station. log10_p counts both groups. `projector` holds the effect's
/// columns. `moved`: readings' change by the effect at its estimate.
ConstancyTest least_constant(const Family& family, const Eigen::VectorXd& moved,
                             const std::vector<ScanVariable>& variables, const Projector& projector);

/// Whether an amplitude acts in more than one place (Effect::terms).
bool acts_in_several_places(const Family& family);

/// log10 p that such an effect has one amplitude in all its places: the likelihood ratio of an amplitude for
/// each against one for all, in the linear model. `projector` holds neither the effect nor what acts in one
/// of its places alone.
double log10_p_of_one_amplitude(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape,
                                const Projector& projector);

}  // namespace volcal

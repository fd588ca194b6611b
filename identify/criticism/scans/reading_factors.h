#pragma once
/// Readings that agree with all others once they are multiplied by a number: a sign that was taken the other
/// way round, millimetres in place of micrometres.
///
/// Deviations (columns in um or urad) are linear in the errors of the machine and zero without any. With y
/// those of a setup, or of all setups of an instrument, and zero elsewhere, the campaign with f y in their
/// place leaves |r~ - (1 - f) y~|^2, y~ and r~ as in projector.h: least at 1 - f = y~^T r~ / y~^T y~, with
/// standard uncertainty 1 / |y~| at the noise of the fit.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/criticism/projection/projector.h"

namespace volcal {

struct ReadingFactor {
  std::vector<std::size_t> setups;
  std::vector<std::string> columns;  ///< of their files, "dx_um"
  double factor = 1.0;               ///< -1 or 1000
  double gain = 0.0;                 ///< by which chi-squared falls with it
};

/// The most telling one, with the setups of its instrument that ask for the same: what it spoils in others is
/// no slip of theirs. Nothing where no factor that a slip would make is near the one that the others expect.
std::optional<ReadingFactor> misread_setup(const LinearModel& model, const Projector& projector);

}  // namespace volcal

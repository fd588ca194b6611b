#pragma once
/// What the pages of a diagnosis draw, as plain data. SI; sizes are bounded whatever the number of readings,
/// and the same for any number of threads. "Given" is the model that was criticised, "reached" the one with
/// the effects that the diagnosis added.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/figures/figure_statistics.h"
#include "volcal/identify/criticism/scans/generic_scan.h"

namespace volcal {

/// What the figures are made from, at the end of a diagnosis.
struct FigureSource {
  const LinearModel& model;
  const std::vector<bool>& heldout;
  std::span<const NoiseParameters> noise;
  const Projector& projector;  ///< of the model reached
  const std::vector<Family>& families;
  const std::vector<FamilyTest>& tests;      ///< at the model reached
  const std::vector<std::size_t>& accepted;  ///< families, in the order in which they were added
  const std::vector<Eigen::MatrixXd>& accepted_columns;
  const std::vector<ScanVariable>& variables;
  const std::vector<GenericTest>& generic_given;
  const std::vector<GenericTest>& generic_reached;
  int threads = 1;
};

DiagnosisFigures diagnosis_figures(const FigureSource& source);

}  // namespace volcal

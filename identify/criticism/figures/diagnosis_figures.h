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

/// Added-variable plot of the leading effect, whitened: in standard deviations of the noise.
struct AddedVariableFigure {
  std::string label;  ///< empty: no effect is visible at all
  std::string unit;   ///< edge, of the slope
  double si_per_unit = 1.0;
  bool accepted = false;  ///< false: the strongest candidate of those that were not added
  double slope = 0.0;     ///< amplitude, SI
  double u = 0.0;
  std::vector<double> driver;  ///< drawn observations; per SI unit of the amplitude
  std::vector<double> residual;
  BinnedMean mean;  ///< of all observations
};

/// An observation that is drawn.
struct DrawnObservation {
  std::size_t setup = 0;
  std::int64_t source_line = 0;
  bool angle = false;
  bool held_out = false;
  double noise = 0.0;  ///< standard deviation, all parts of the noise
  double given = 0.0;  ///< residual
  double reached = 0.0;
  Eigen::Vector3d point_w = Eigen::Vector3d::Zero();  ///< nominal functional point
  Eigen::Vector3d direction_w =
      Eigen::Vector3d::Zero();  ///< displacement of the point that it feels, per unit
};

/// Residuals against a recorded variable: the drawn observations, and means of all: of lengths, of angles,
/// and the displacements of the functional point along X, Y, Z that the lengths ask for. An effect on the
/// machine often has no mean in the lengths, beams from several sides feeling it with different signs.
struct VariableFigure {
  std::string name;                     ///< as ScanVariable, or "setup", "station", "tool"
  std::vector<std::string> categories;  ///< of setup, station and tool; the abscissa is their index
  std::vector<double> drawn;            ///< per drawn observation
  BinnedMean given[5], reached[5];      ///< lengths, angles, X, Y, Z
};

/// Mean displacement of the functional point in a part of the work volume that the residuals ask for. Only
/// directions that the readings there see well.
struct ResidualVector {
  Eigen::Vector3d point_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d given_w = Eigen::Vector3d::Zero();
  Eigen::Vector3d reached_w = Eigen::Vector3d::Zero();
  double u = 0.0;  ///< root of the summed variances of the components, noise taken as independent
  std::size_t observations = 0;
};

/// log10 p (family-wise, at most 0) of the generic scan for every pair of variables; the diagonal is one
/// variable alone. The smaller of polynomial and kernel; 0 where nothing was tested.
struct GenericMap {
  std::vector<std::string> variables;
  std::vector<Eigen::MatrixXd> given, reached;  ///< per direction of kScanDirections
};

struct DiagnosisFigures {
  AddedVariableFigure leading;
  std::vector<DrawnObservation> observations;  ///< at most 2,500, an even choice
  std::size_t observation_count = 0;           ///< of which they were chosen
  std::vector<VariableFigure> variables;
  std::vector<ResidualVector> vectors;
  GenericMap generic;
  std::vector<Autocorrelation> autocorrelation;  ///< per instrument, of the model reached
};

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

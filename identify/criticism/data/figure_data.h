#pragma once
/// What the pages of a diagnosis draw, as plain data. SI; sizes are bounded whatever the number of readings,
/// and the same for any number of threads. "Given" is the model that was criticised, "reached" the one with
/// the effects that the diagnosis added.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace volcal {

/// Means of a value over bins of an abscissa. Empty bins are left out.
struct BinnedMean {
  std::vector<double> centre;
  std::vector<double> mean;
  std::vector<double> noise;  ///< standard deviation that noise alone gives the mean, correlation counted
  std::vector<std::size_t> count;
};

/// Autocorrelation of residuals of one instrument within its sequences, at growing lags.
struct Autocorrelation {
  std::size_t group = 0;
  std::vector<int> lag;     ///< in readings, in the order of time
  std::vector<double> gap;  ///< s, mean time between the two of a pair; NaN without times
  std::vector<std::size_t> pairs;
  std::vector<double> residual;  ///< of the residuals, each in its own standard deviation
  std::vector<double> expected;  ///< by the noise model
  std::vector<double> whitened;  ///< after the filter of the noise model
};

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

}  // namespace volcal

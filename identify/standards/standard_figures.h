#pragma once
/// The standards' own figures of a campaign, from its readings and from a model's predictions side by side:
/// ISO 230-2 for displacement along one axis and for the angle of a rotary axis, ISO 230-6 along diagonals,
/// ISO 230-4 for circles of a ball-bar, ISO 230-7 for an axis that turns alone, ISO 230-3 for drift at rest,
/// and volumetric figures for measured error vectors. m and rad.

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/errors/volume/volumetric.h"
#include "volcal/identify/result/result.h"
#include "volcal/identify/standards/iso230_2.h"
#include "volcal/identify/standards/iso230_3.h"
#include "volcal/identify/standards/iso230_4.h"
#include "volcal/identify/standards/iso230_6.h"
#include "volcal/identify/standards/iso230_7.h"
#include "volcal/model/description/campaign.h"
#include "volcal/model/description/finding.h"

namespace volcal {

/// The same figures of the readings and of the model at the same commanded positions.
template <class Figures>
struct SideBySide {
  Figures readings;
  Figures model;
};

struct AxisLineTest {
  std::string setup;
  AxisName axis = AxisName::X;
  std::string place;  ///< positions of the other linear axes: "Y 100, Z -135 mm"
  SideBySide<PositioningFigures> figures;
  std::vector<Finding> notes;
};

struct DiagonalTest {
  std::string setup;
  std::vector<AxisName> axes;  ///< two: face, three: body diagonal
  SideBySide<DiagonalFigures> figures;
  std::vector<Finding> notes;
};

/// Body diagonals, or face diagonals of one plane, of the whole campaign.
struct DiagonalGroup {
  std::vector<AxisName> axes;
  SideBySide<DiagonalSummary> summary;
};

struct CircleTest {
  std::string setup;
  AxisName first = AxisName::X;
  AxisName second = AxisName::Y;
  double radius = 0.0;
  Eigen::Vector3d centre_w = Eigen::Vector3d::Zero();
  SideBySide<CircularFigures> figures;
  std::vector<Finding> notes;
  std::size_t setup_index = 0;         ///< in the campaign
  std::vector<std::size_t> rows = {};  ///< of the setup, in the order of the file
  /// Radial deviations at these rows, both about the readings' centre: their difference is the residual.
  SideBySide<std::vector<CircleReading>> radial = {};
};

struct PointsTest {
  std::string setup;
  SideBySide<VolumetricFigures> figures;
  VolumetricFigures difference;  ///< readings minus model
  std::vector<Finding> notes;
};

/// Angular positioning of a rotary axis: angles in place of lengths, rad.
struct RotaryPositioningTest {
  std::string setup;
  AxisName axis = AxisName::C;
  std::string place;  ///< positions of the other axes
  SideBySide<PositioningFigures> figures;
  std::vector<Finding> notes;
};

enum class ErrorMotion {
  RadialFixed,     ///< along a direction that does not turn
  RadialRotating,  ///< along a direction that turns with the axis
  Axial,
  Tilt  ///< about a direction that does not turn
};

/// One error motion of an axis that turns alone.
struct ErrorMotionTest {
  std::string setup;  ///< of a tilt by two spheres: both
  AxisName axis = AxisName::C;
  ErrorMotion motion = ErrorMotion::RadialFixed;
  int direction = 0;  ///< 0 to 2, of the body that carries the axis; of RadialRotating the one at angle 0
  SideBySide<ErrorMotionFigures> figures;
  SideBySide<std::vector<RotationReading>> plots = {};  ///< about their centre
  std::vector<Finding> notes = {};

  bool is_angle() const { return motion == ErrorMotion::Tilt; }
};

/// Lowest and highest temperature beside a drift, degC.
struct TemperatureRange {
  std::string channel;
  double low = 0.0;
  double high = 0.0;
};

/// One displacement or tilt over time, nothing moving.
struct DriftTest {
  std::string setup;
  std::string quantity;  ///< "X" displacement, "A" tilt, as directions of the setup's frame; "beam"
  bool angle = false;
  SideBySide<DriftFigures> figures;
  SideBySide<std::vector<DriftReading>> plots = {};
  std::vector<TemperatureRange> temperatures = {};
  std::vector<Finding> notes = {};
};

struct StandardFigures {
  std::vector<AxisLineTest> lines;
  std::vector<RotaryPositioningTest> rotary_lines = {};
  std::vector<ErrorMotionTest> error_motions = {};
  std::vector<DriftTest> drifts = {};
  std::vector<DiagonalTest> diagonals;
  std::vector<DiagonalGroup> diagonal_groups;
  std::vector<CircleTest> circles;
  std::vector<PointsTest> points;
  std::vector<Finding> not_recognised;  ///< setups of these instruments that are no such test, and why
};

/// `records`: one per observation, any order. Readings without a record are left out of both sides.
StandardFigures standard_figures(const Campaign& campaign, std::span<const ResidualRecord> records);

}  // namespace volcal

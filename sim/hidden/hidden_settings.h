#pragma once
/// How the kinds of hidden effects read their settings. All errors are InputError at the effect's place.

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "volcal/sim/hidden/hidden_effects.h"

namespace volcal::sim {

using StateNumber = std::function<double(const MachineState& state)>;
using OccasionTest = std::function<bool(const Occasion& occasion)>;
using ReadingTest = std::function<bool(const Occasion& occasion, std::size_t channel)>;

class HiddenSettings {
 public:
  /// `role`: how messages introduce the effect.
  HiddenSettings(const HiddenEffect& effect, double amplitude, const HiddenContext& context,
                 const char* role = "hidden effect ")
      : effect_(effect), amplitude_(amplitude), context_(context), role_(role) {}

  double amplitude() const { return amplitude_; }
  bool has(const std::string& stem) const { return effect_.options.has(stem); }

  double number(const std::string& stem, double otherwise) const;
  double number(const std::string& stem) const;
  double positive(const std::string& stem) const;
  double positive(const std::string& stem, double otherwise) const;
  int power() const;                                                  ///< 1 to 3; 1 when absent
  Eigen::Vector3d direction(const Eigen::Vector3d& otherwise) const;  ///< unit vector
  Eigen::Vector3d vector(const std::string& stem, const Eigen::Vector3d& otherwise) const;
  std::string text(const std::string& stem, const std::string& otherwise) const;
  std::vector<double> numbers(const std::string& stem) const;  ///< none where the key is absent

  ErrorSymbol symbol() const;
  LocationSymbol location_symbol() const;  ///< squareness of the datum, or of a rotary axis
  AxisName axis(const std::string& stem) const;
  AxisName linear_axis(const std::string& stem) const;
  std::vector<AxisName> linear_axes(const std::string& stem) const;  ///< "X Y Z"; two or more
  /// An axis other than the symbol's own: otherwise the effect is one of the 21 functions.
  AxisName other_axis(const std::string& stem) const;
  std::size_t tool() const;

  double travel(AxisName axis) const { return context_.machine.axis(axis).travel(); }
  double home(AxisName axis) const { return context_.machine.axis(axis).home; }
  StateNumber position(AxisName axis) const;                      ///< commanded, m or rad
  StateNumber share(AxisName axis) const;                         ///< u
  StateNumber share_or_one(const std::string& stem) const;        ///< 1 when the key is absent
  StateNumber excess_temperature(const std::string& stem) const;  ///< dT
  /// degC, of the channel that expressions write so: "T_air"
  StateNumber written_temperature(const std::string& written) const;
  const TemperatureChannel& channel(const std::string& stem) const;

  const Machine& machine() const { return context_.machine; }

  /// Of that name.
  OccasionTest at_station(const std::string& station) const;
  OccasionTest at_setup(const std::string& setup) const;
  /// Of such a column, as "azimuth_deg"; of that setup unless it is empty.
  ReadingTest of_column(const std::string& column, const std::string& setup) const;
  /// Occasions that the optional keys `setup`, `station` and `tool` leave.
  OccasionTest where() const;

  Eigen::Vector3d middle_of_travel() const;  ///< machine coordinates, of the linear axes

  /// At the effect's place, to be thrown later.
  InputError error(const std::string& problem, const std::string& remedy) const;
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;

 private:
  std::string required_text(const std::string& stem) const;

  const HiddenEffect& effect_;
  double amplitude_;
  const HiddenContext& context_;
  const char* role_;
};

double hours(const MachineState& state);
/// Positioning error of an axis, as EXX for X.
ErrorSymbol positioning_of(AxisName axis);

/// Pieces of schemas that kinds share.
KeySchema symbol_key();
KeySchema axis_key(const std::string& key, const std::string& help, bool required = true);
KeySchema text_key(const std::string& key, const std::string& help, bool required = true);
KeySchema number_key(const std::string& key, const std::string& help, bool required = true);
KeySchema vector_key(const std::string& key, const std::string& help, bool required = false);
std::vector<KeySchema> place_keys();  ///< setup, station

std::vector<HiddenKind> hidden_drive_kinds();
std::vector<HiddenKind> hidden_thermal_kinds();
std::vector<HiddenKind> hidden_structure_kinds();
std::vector<HiddenKind> hidden_rotary_kinds();
std::vector<HiddenKind> hidden_instrument_kinds();
std::vector<HiddenKind> hidden_unlisted_kinds();
std::vector<HiddenKind> hidden_unlisted_time_kinds();

}  // namespace volcal::sim

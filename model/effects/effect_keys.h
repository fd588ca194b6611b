#pragma once
/// Keys, checks and drivers that several effects share.

#include <Eigen/Core>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "volcal/model/description/unknowns.h"
#include "volcal/model/effects/effect.h"

namespace volcal {

/// What an effect reads its table from: the keys' values, and the place that messages name.
struct EffectTable {
  const EffectSpec& spec;
  SourcePlace place;

  EffectTable(const EffectSpec& effect, const std::string& model_file)
      : spec(effect), place{model_file, effect.source_line} {}
  std::string text(const std::string& key, const std::string& remedy) const;
  ErrorSymbol symbol() const;
  AxisName axis(const std::string& key) const;
  double number(const std::string& stem, double otherwise) const {
    return spec.options.number(stem).value_or(otherwise);
  }
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy) const;
};

KeySchema symbol_key(const std::string& help);
/// Amplitude of whatever unit `key` ends with, believed between 1e-6 and 1e4 of it.
KeySchema amplitude_key(const std::string& key, const std::string& help);
/// Keys "amplitude_um_<per>" and "amplitude_urad_<per>" (without "_<per>" when empty) for every `per`.
std::vector<KeySchema> motion_amplitude_keys(std::initializer_list<std::string> per, const std::string& help);
/// Key of an amplitude that acts on `symbol`: "amplitude_urad_per_K".
std::string motion_amplitude_key(ErrorSymbol symbol, const std::string& per,
                                 const std::string& stem = "amplitude");
std::vector<KeySchema> joined(std::initializer_list<std::vector<KeySchema>> parts);

/// Every temperature channel of the campaign, every station with more than one reading, every tool in use.
std::vector<std::string> temperature_channels(const Campaign& campaign);
std::vector<std::string> station_names(const Campaign& campaign);
std::vector<std::string> tools_in_use(const Campaign& campaign);
/// "a, b, c"; "none" when there are none.
std::string listed_names(const std::vector<std::string>& names);
/// Station of a setup; empty for instruments that have none.
std::string station_of(const Setup& setup);
/// With a laser: its length scale and its dead path can be wrong.
bool measures_lengths(const Setup& setup);
bool has_time(const Campaign& campaign);
/// First and last time, s; 0, 0 without times.
std::pair<double, double> time_span(const Campaign& campaign);

/// s, from which growth and drift of a setup's readings count.
double clock_start(const SetupView& view);

void check_axis(const Campaign& campaign, AxisName axis, const std::string& what, const SourcePlace& place);
void check_channel(const Campaign& campaign, const std::string& channel, const SourcePlace& place);
void check_time(const Campaign& campaign, const std::string& what, const SourcePlace& place);
void check_station(const Campaign& campaign, const std::string& station, const SourcePlace& place);
void check_tool(const Campaign& campaign, const std::string& tool, const SourcePlace& place);
void check_setup(const Campaign& campaign, const std::string& setup, const SourcePlace& place);

/// Squareness turns the direction of travel by e_component x e_axis: one displacement of the axis, the sign
/// times its position.
struct SquarenessMotion {
  ErrorSymbol symbol;
  double sign = 1.0;
};
SquarenessMotion motion_of_squareness(LocationSymbol location);

/// The same for every reading of a setup.
Eigen::VectorXd constant(const SetupView& view, double value);
/// Per reading of a setup: commanded position less home, m or rad.
Eigen::VectorXd positions_from_home(const SetupView& view, AxisName axis);
/// Direction of approach -1, 0 (unknown), 1.
Eigen::VectorXd directions(const SetupView& view, AxisName axis);
/// s of the campaign's clock; `unknown` where not recorded.
Eigen::VectorXd times(const SetupView& view, double unknown = 0.0);
/// Nominal displacement along the beam of a displacement setup, m, from its first reading, with its sign.
Eigen::VectorXd beam_displacements(const SetupView& view);
/// Temperature less 20 degC; 0 where the channel was not recorded.
Eigen::VectorXd temperature_excess(const SetupView& view, const std::string& channel);

EffectSpec effect_spec(const std::string& kind,
                       std::initializer_list<std::pair<std::string, OptionValue>> options);

}  // namespace volcal

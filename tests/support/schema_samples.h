#pragma once
/// Input files made from the schemas of everything registered: one setup per instrument with every key, one
/// effect per kind, one function per basis. They seed the fuzzers and the mutation test, and a new plug-in is
/// covered without touching either.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/effect_campaign.h"
#include "volcal/model/description/units.h"
#include "volcal/model/effects/registry.h"
#include "volcal/model/functions/registry.h"
#include "volcal/model/instruments/registry.h"
#include "volcal/sim/hidden/hidden_effects.h"

namespace volcal::testing {

inline std::string sample_machine() {
  return "format = \"volcal-machine-1\"\nname = \"sample\"\nstructure = \"w C' A' X' b Y Z t\"\n"
         "[datum]\nprimary = \"X\"\nsecondary = \"Y\"\n"
         "[axes.X]\ntravel_mm = [0, 500]\nhome_mm = 0\nreference_point_mm = [0, -200, 0]\n"
         "expansion_um_per_m_K = 11.5\nexpansion_sigma_um_per_m_K = 0.5\ntemperature = \"X\"\n"
         "[axes.Y]\ntravel_mm = [0, 400]\nhome_mm = 0\n[axes.Z]\ntravel_mm = [-300, 0.0]\nhome_mm = 0\n"
         "[axes.A]\ntravel_deg = [-110, 30]\nhome_deg = 0\ncentre_mm = [250, 200, -350]\n"
         "[axes.C]\ntravel_deg = [0, 360]\nhome_deg = 0\ncentre_mm = [250, 200, -400]\n"
         "[tools.long]\noffset_mm = [0, 0, -150.5]\noffset_sigma_um = 2\n[tools.none]\noffset_mm = [0, 0, "
         "0]\n";
}

inline std::string sample_value(const KeySchema& key, bool symbol) {
  switch (key.type) {
    case KeyType::Text:
      return symbol ? "\"EXX\"" : "\"" + (key.choices.empty() ? "P1" : key.choices.front()) + "\"";
    case KeyType::Boolean:
      return "true";
    case KeyType::Vector3:
      return unit_of_key(key.key).suffix.empty() ? "[1, 0, 0]" : "[-350.0, -300.0, -250.0]";
    case KeyType::Numbers:
      return "[1.0]";
    case KeyType::Number:
      break;
  }
  return key.plausible_min > 1.0 ? std::to_string(key.plausible_min) : "1.0";
}

inline std::string sample_setup(const InstrumentSchema& schema) {
  std::string text = "[[setups]]\nname = \"" + schema.name + "\"\ninstrument = \"" + schema.name +
                     "\"\ndata = \"" + schema.name + ".csv\"\ntool = \"long\"\nrepeatability_um = 0.5\n";
  for (const KeySchema& key : schema.keys) text += key.key + " = " + sample_value(key, false) + "\n";
  text += "noise = { ";
  for (const KeySchema& key : schema.noise_keys)
    text += (text.ends_with("{ ") ? "" : ", ") + key.key + " = 0.5";
  return text + " }\n";
}

inline std::string sample_campaign() {
  std::string text =
      "format = \"volcal-campaign-1\"\nmachine = \"machine.toml\"\n[noise]\nrepeatability_um = 0.5\n";
  for (const Instrument* instrument : instruments()) text += sample_setup(instrument->schema());
  return text;
}

/// Every section of a study, one hidden effect per kind with every key.
inline std::string sample_study() {
  std::string text =
      "format = \"volcal-study-1\"\nmachine = \"machine.toml\"\nseed = 7\npause_s = 60\n"
      "[truth]\nkind = \"random\"\nvolumetric_rms_um = [15.5, 21.5]\nwave_scale = 0.5\n"
      "[truth.locations_urad]\nEC0Y = 12.5\n[truth.reversals_um]\nEXX = 3\n[truth.expansions.X]\n"
      "expansion_um_per_m_K = 10\ntemperature = \"X\"\n"
      "[[temperatures]]\nchannel = \"X\"\nstart_degC = 20.5\ndrift_K_per_hour = 0.1\nperiod_s = 600\n"
      "[compensation]\nleast_increment_um = 1\nwrong_tool_length_mm = 0.05\n"
      "[validation]\npoints = 40\ntools = [\"long\"]\n";
  for (const char* instrument : {"laser-tracer", "laser-tracker"}) {
    text += std::string("[[measurements]]\nkind = \"") + instrument +
            "\"\ngrid = [3, 4, 5]\njitter = 0.25\nnoise = { constant_um = 0.5, wander_um = 0.5 }\n"
            "[[measurements.stations]]\nname = \"P1\"\nposition_mm = [-350, -300, -250]\n"
            "[[measurements.runs]]\nstation = \"P1\"\ntool = \"long\"\n";
  }
  text +=
      "[[measurements]]\nkind = \"ball-bar-circles\"\nplanes = [\"XY\"]\nradius_mm = 100\n"
      "[[measurements]]\nkind = \"axis-lines\"\naxes = [\"X\"]\npoints = 11\n";
  for (const char* kind : {"diagonals", "straightness-lines", "squares", "angle-lines", "point-grid"})
    text += std::string("[[measurements]]\nkind = \"") + kind + "\"\nreading_s = 2\n";
  for (const sim::HiddenKind& kind : sim::hidden_kinds()) {
    text += "[[hidden]]\nkind = \"" + kind.kind + "\"\nrms_um = 0.5\n";
    for (const KeySchema& key : kind.keys)
      text += key.key + " = " + sample_value(key, key.key == "symbol") + "\n";
  }
  return text;
}

inline std::string sample_points() {
  return "x_mm,y_mm,z_mm,a_deg,c_deg,dir_x,line,run\n0,0,0,0,0,1,0,0\n250.5,-1e2,3,-10,90,0,1,0\n500,400,-"
         "300,0,360,-1,1,"
         "2\n";
}

/// Readings of one column set of an instrument; positions run along the body diagonal.
inline std::string sample_csv(const std::vector<ColumnSchema>& columns) {
  std::string text = "time_s,line,run,x_mm,y_mm,z_mm,a_deg,c_deg,dir_x,feed_mm_min,T_X_degC";
  for (const ColumnSchema& column : columns) text += "," + column.column;
  text += "\n";
  for (int i = 0; i < 8; ++i) {
    const std::string n = std::to_string(i);
    text += n + ",0,1," + std::to_string(50 * i) + "," + std::to_string(40 * i) + ",-" +
            std::to_string(30 * i) + ",0,0," + (i % 2 ? "1" : "-1") + ",1000,20." + n;
    for (const ColumnSchema& column : columns) {
      const bool is_direction = unit_of_key(column.column).suffix.empty();
      text += "," + std::to_string(is_direction ? 1.0 / std::sqrt(3.0) : 0.25 * (i % 3) + 0.5);
    }
    text += "\n";
  }
  return text;
}

/// "[1.0, 1.0, 1.0]"
inline std::string ones(std::size_t count) {
  std::string text = "[";
  for (std::size_t i = 0; i < count; ++i) text += i > 0 ? ", 1.0" : "1.0";
  return text + "]";
}

/// An effect with every key that applies to it.
inline std::string sample_effect(const EffectKind& kind, const EffectSpec& spec) {
  const std::unique_ptr<Effect> effect = kind.make(spec, "model.toml");
  std::string text = "[[effects]]\nkind = \"" + spec.kind + "\"\n";
  for (const KeySchema& key : kind.schema().keys) {
    const auto is_key = [&](const auto& item) { return item.key == key.key; };
    const auto words = spec.options.text(key.key);
    if (key.type == KeyType::Text && words) text += key.key + " = \"" + *words + "\"\n";
    if (key.type == KeyType::Number && key.required)
      text += key.key + " = " + sample_value(key, false) + "\n";
    if (const auto numbers = spec.options.numbers(key.key)) {
      std::string list;
      for (const double number : *numbers) list += (list.empty() ? "" : ", ") + std::to_string(number);
      text += key.key + " = [" + list + "]\n";
    } else if (key.type == KeyType::Numbers && std::ranges::any_of(effect->amplitudes(), is_key)) {
      text += key.key + " = " + ones(effect->amplitudes().size()) + "\n";
    } else if (std::ranges::any_of(effect->amplitudes(), is_key) ||
               std::ranges::any_of(effect->shapes(), is_key)) {
      text += key.key + " = " + sample_value(key, false) + "\n";
    }
  }
  return text;
}

inline std::string sample_model() {
  std::string text =
      "format = \"volcal-model-1\"\n[functions]\ndefault = { basis = \"bspline\", degree = 3, knots = "
      "\"auto\" }\n"
      "EXX = { degree = 2, knots = 4 }\nEYX = { knots_mm = [0, 100, 250, 500], coefficients_um = [0, 1, 2, "
      "3, 4, 5] }\n"
      "EAC = { knots_deg = [0, 90, 360] }\n";
  const std::vector<std::string> symbols = {"EZX", "EAY", "EBC", "ECC", "EZC", "EXC"};
  std::size_t next = 0;
  for (const BasisKind* kind : basis_kinds()) {
    if (next == symbols.size() || kind->name == "bspline") continue;
    const std::string symbol = kind->linear_axes ? symbols[next] : "EYC";
    text +=
        symbol + " = { basis = \"" + std::string(kind->name) + "\"" +
        (kind->degree_max > 0 ? ", degree = " + std::to_string(kind->degree_max < 5 ? kind->degree_max : 5)
                              : "") +
        " }\n";
    ++next;
  }
  text += "[locations]\nEC0Y_urad = 12.5\nEA0Z = \"zero\"\nEX0C_um = 3\n";
  const Campaign campaign = testing_support::five_axis_effect_campaign();
  for (const EffectKind* kind : effect_kinds()) {
    text += sample_effect(*kind, kind->examples(campaign).front());
  }
  return text;
}

}  // namespace volcal::testing

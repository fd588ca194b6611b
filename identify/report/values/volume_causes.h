#pragma once
/// What the error in the volume comes from once a diagnosis has named what was missing: the found effects one
/// by one beside positioning, straightness, squareness and angles (error_budget.h).

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/criticism/data/diagnosis_data.h"
#include "volcal/identify/result/result.h"

namespace volcal {

struct VolumeCause {
  std::string name;         ///< "positioning", "reversal EXX"
  bool found = false;       ///< by the diagnosis
  double rms = 0.0;         ///< displacement of the functional point over the volume, m
  std::optional<double> u;  ///< standard uncertainty of it, m; empty where it is not known
  double share = 0.0;       ///< of the mean square of the whole; negative: cancels part of the others
  std::optional<EffectName> effect = {};  ///< of the model, where the cause is one
};

struct VolumeCauses {
  std::string tool;
  double total_rms = 0.0;
  std::vector<VolumeCause> causes;         ///< largest first
  std::vector<std::string> not_in_volume;  ///< found effects that do not move the machine
};

/// `given`: the fit that was diagnosed; its error functions keep their values. `added`: what the diagnosis
/// adds to the model. For the machine's first tool.
VolumeCauses volume_causes(const FitResult& given, std::span<const EffectFinding> added);

}  // namespace volcal

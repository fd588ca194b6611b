#pragma once
/// A model that a diagnosis offers, as a file beside it.

#include <string>

#include "volcal/model/description/model_spec.h"

namespace volcal {

struct OfferedModel {
  std::string file;   ///< "extended.toml", "alternative-1-2.toml"
  std::string about;  ///< what stands at the file's head
  ModelSpec model;
};

}  // namespace volcal

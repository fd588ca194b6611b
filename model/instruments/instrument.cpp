#include "volcal/model/instruments/instrument.h"

#include <numeric>
#include <utility>

#include "volcal/model/description/errors.h"

namespace volcal {

void SetupContext::fail(const std::string& problem, const std::string& remedy) const {
  throw InputError({campaign_file, setup.source_line}, "setup \"" + setup.name + "\": " + problem, remedy);
}

void BoundSetup::local_nuisance(std::size_t /*row*/, int* index) const {
  std::iota(index, index + local_size_, 0);
}

double BoundSetup::noise_constant(const Options& noise, int /*channel*/) const {
  return noise.number("constant").value_or(0.0);
}

void BoundSetup::add_nuisance(NuisanceBlock block) {
  local_size_ += block.size();
  nuisance_.push_back(std::move(block));
}

}  // namespace volcal

#pragma once
/// Signed means of the residuals beside their RMS: an offset of a setup or of one direction of approach does
/// not show in an RMS.

#include <span>
#include <string>

#include "volcal/identify/standards/comparison.h"

namespace volcal {

/// By direction of approach and by setup, one or two models; empty where there is nothing but one setup. Of
/// more setups than `most` those with the largest mean over RMS.
std::string signed_means_text(std::span<const Comparison* const> models, std::size_t most);

}  // namespace volcal

/// Rotary axes: error motions, axis lines, and the error over the positions of two axes.

#include "volcal/identify/report/page.h"
#include "volcal/identify/report/rotary_json.h"

namespace volcal::report {

Json rotary_axes_page(const PageInput& input) {
  const auto pictures = rotary_pictures(input.result, input.campaign);
  if (!pictures) return nullptr;
  Json model = rotary_json(*pictures);
  model["name"] = "result";
  return {{"models", Json::array({std::move(model)})}};
}

}  // namespace volcal::report

#pragma once
/// Pictures of rotary axes as pages of reports and the workbench draw them; um, urad, mm, deg.

#include "volcal/identify/report/page.h"
#include "volcal/identify/report/values/rotary_pictures.h"

namespace volcal::report {

Json rotary_json(const RotaryPictures& pictures);

}  // namespace volcal::report

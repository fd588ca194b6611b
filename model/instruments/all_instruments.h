#pragma once
/// One accessor per instrument file, for the registration list.

#include "volcal/model/instruments/instrument.h"

namespace volcal {

const Instrument& laser_tracer();
const Instrument& laser_tracker();
const Instrument& ball_bar();
const Instrument& displacement();
const Instrument& straightness();
const Instrument& angle();
const Instrument& volumetric_points();

}  // namespace volcal

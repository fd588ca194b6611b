#include "volcal/identify/words/effect_meanings.h"

#include <algorithm>
#include <array>

namespace volcal {
namespace {

constexpr auto kMeanings = std::to_array<EffectMeaning>({
    {"reversal", "An axis stops at two different places, depending on the side from which it comes.",
     "backlash of screw, nut or gear; friction that winds up the drive; loose couplings or bearings; a "
     "backlash compensation in the control that is missing or wrong; a scale that sits far from the "
     "guideway"},
    {"position-reversal", "The play at reversal is not the same everywhere on the travel.",
     "a ball screw that is worn where it is used most; guideways or wipers that are tighter at one end; a "
     "screw that winds up by the more the farther the nut is from its bearing"},
    {"curved-reversal",
     "The play at reversal is larger or smaller in the middle of the travel than at its ends.",
     "a ball screw that is worn in the middle; a long screw that sags; guideways that are tight at both "
     "ends"},
    {"thermal-reversal", "The play at reversal changes with a temperature.",
     "preload of nut or bearings that changes as they warm; grease that stiffens in the cold; a screw that "
     "lengthens between fixed bearings"},
    {"pre-travel",
     "After an axis has turned round it takes a way to settle: its error fades the farther it travels on.",
     "seals, wipers or covers that stick before they slide; friction that winds up the drive; a hydrostatic "
     "or plain guideway that lifts as it moves"},
    {"common-reversal", "Several axes stop at two different places by the same amount.",
     "one setting of backlash compensation or friction in the control for all axes; drives of one make at "
     "one "
     "preload; a reflector or probe that follows its carrier late; settling that is not waited for"},
    {"lead-error", "The position repeats its error with every turn of the ball screw.",
     "a screw that wobbles because it or its bearing is not centred; a coupling or motor encoder that sits "
     "off centre; a bent screw"},
    {"growing-lead-error",
     "The position repeats its error with every turn of the ball screw, and the error grows along the "
     "travel.",
     "a bent screw; a screw whose free end whips; a bearing seat out of line at one end"},
    {"rack-error", "The position repeats its error with every turn of the pinion on its rack.",
     "a pinion that is not centred on its shaft; a gear box or motor encoder that sits off centre; racks "
     "that were joined at a wrong pitch, where the period is a rack's length"},
    {"encoder-subdivision", "The position repeats its error within every signal period of the scale.",
     "a dirty scale; a reading head at a wrong distance or angle; signals whose offset, gain or phase was "
     "not adjusted; wrong interpolation in the control"},
    {"worm-error", "The angle of a rotary axis repeats its error with every turn of its worm or pinion.",
     "a worm or pinion that is not centred in its bearings; a worn or badly meshed pair; a motor's encoder "
     "that sits off centre"},
    {"ring-eccentricity", "The angle of a rotary axis is wrong by one wave a turn.",
     "an encoder ring or wheel that is not centred on the axis; one reading head where two would cancel it"},
    {"screw-heating", "An axis becomes longer the longer it has been moving: its ball screw warms up.",
     "fast traverses on an axis that is measured by its motor's encoder; too much preload of nut or "
     "bearings; too little grease; a screw cooler that is off"},
    {"scale-expansion",
     "An axis becomes longer as it warms: its positions are wrong in proportion to the distance from home.",
     "a scale or screw that follows the workshop's temperature; a thermal expansion coefficient that is "
     "missing or wrong in the control; a temperature sensor that sits elsewhere than the scale"},
    {"common-expansion", "All axes become longer alike as the machine warms.",
     "scales of one material at one temperature; a reference temperature or coefficient that the control has "
     "wrong for all axes; a length scale of the instrument that follows that temperature"},
    {"common-growth", "All axes become longer alike after the first reading, fast at first and then slower.",
     "a machine that was switched on shortly before it was measured; coolant or hall that reach another "
     "temperature; an instrument that warms up"},
    {"thermal-drift", "An error motion shifts with a temperature, as the structure bends.",
     "a column or ram that warms on one side by motor, sun or draught; a hydraulic unit or cabinet beside "
     "the column; a hall whose temperature is layered"},
    {"spindle-growth", "The spindle pushes the tool out as it warms up, fast at first and then ever slower.",
     "heat of the spindle bearings or motor; measuring before the spindle was warm; a spindle cooler that is "
     "off or set wrongly"},
    {"tool-expansion", "Spindle or tool grow with a temperature.",
     "heat of the spindle; coolant or air at another temperature than the machine; a long tool or holder "
     "that follows the workshop's temperature"},
    {"squareness-drift", "Two axes turn against each other slowly while the campaign is measured.",
     "a column or crossbeam that warms on one side; a machine that settles on its feet; a workpiece or "
     "fixture that loads one side"},
    {"axis-coupling",
     "An error motion of one axis changes with the position of another: the machine bends as it moves, and "
     "is not a rigid body.",
     "the weight of a moving column, table or ram on guideways that give way; an unsupported overhang; "
     "levelling or foundation that lets the bed twist; clamps that strain the structure"},
    {"product-coupling",
     "An error motion changes with two other axes at once, as their product: the machine twists as it moves.",
     "a ram that leans out of a column which moves itself; a table off its centre on a bed that twists; "
     "levelling at one corner"},
    {"triple-coupling",
     "An error motion changes with the product of three positions: the machine bends the more, the farther "
     "several axes are out at once.",
     "a ram that bends out of a saddle which is itself far out; an overhang on a crossbeam; a heavy head on "
     "a long ram"},
    {"tool-load", "An error motion differs between tools: the machine gives way under a heavy or long one.",
     "a heavy tool, head or reflector holder; a spindle or quill that sags when it is out; weak clamping of "
     "the head"},
    {"tilt-load",
     "An error motion changes as a table or head tilts: its weight pulls on what carries it in another "
     "direction.",
     "a cradle or head whose centre of gravity is off its axis; a column or ram that yields; a balance that "
     "is weak or out of adjustment"},
    {"cradle-coupling",
     "An error motion of a rotary axis, once per turn, grows as another rotary axis tilts it.",
     "a table bearing that yields under its weight when it stands on edge; a workpiece out of balance; a "
     "clamp that lets go"},
    {"length-scale", "All lengths of an instrument are too long or too short in proportion.",
     "a wrong air temperature, pressure or humidity in the wavelength's compensation; a sensor that is not "
     "where the beam is; a wavelength or scale entered wrongly"},
    {"dead-path",
     "All lengths from one station drift together with the air or with time: the part of the beam that is "
     "not measured changes.",
     "a dead path that was not compensated; a station or mount that warms up; a reference that was set long "
     "before the readings"},
    {"station-drift", "A station moves slowly while it measures.",
     "a tripod or mount that settles or warms up; a magnetic base on a warm surface; an instrument that had "
     "not reached its temperature; a soft floor"},
    {"station-event", "A station was moved at one moment and stayed where it then stood.",
     "somebody touched the tripod or a cable; a door, crane or vehicle shook the floor; a clamp slipped"},
    {"tool-offset", "A tool, or its reflector, is not where the machine file says.",
     "a tool length or radius entered wrongly; a reflector seated otherwise than in its drawing; a nest that "
     "is worn or dirty"},
    {"tool-clamping", "The tool sat otherwise in one set-up than in the others.",
     "chips or dirt in the taper; a worn pull stud or too little clamping force; a reflector that was put "
     "back turned; a tool that was not clamped in the same orientation"},
    {"ball-bar-length", "All circles of the ball-bar are too large or too small by the same amount.",
     "the bar was calibrated at another temperature; a seat or an extension was changed after calibration; a "
     "worn ball or cup"},
    {"servo-mismatch",
     "Circles become ellipses at 45 degrees whose direction turns with the sense of the path: one axis "
     "follows its command later than the other.",
     "position gains of the two axes that differ; feedforward set for one axis only; an axis that carries "
     "more load than its drive was tuned for"},
    {"following-error", "An axis is late on its path, by the more the faster it moves.",
     "a low position gain; feedforward switched off or mistuned; friction or a load that the drive was not "
     "tuned for"},
    {"lagged-temperature",
     "An error motion follows a temperature, but hours late: a heavy part takes time to warm.",
     "the bed, column or table following the workshop's temperature; sun or a heater on one side; coolant "
     "that warms the structure slowly"},
    {"lagged-expansion", "Spindle or tool grow with a temperature, but late.",
     "a spindle housing that warms through; a tool holder that takes up heat from the bearings; coolant at "
     "another temperature than the machine"},
    {"temperature-rate",
     "An error motion follows how fast a temperature changes: the structure bends while its skin is warmer "
     "than its core.",
     "a hall door, sun or heating that comes on; coolant that starts; a thick casting with thin ribs"},
    {"tool-temperature-rate",
     "Spindle or tool move while a temperature changes, and return when it is steady.",
     "a spindle housing whose skin warms before its core; a spindle cooler that switches; coolant that "
     "starts"},
    {"foundation-tilt",
     "The whole machine tilts against the floor while axes move or time passes, which instruments on the "
     "floor see as an error.",
     "machine feet that are loose or badly levelled; a thin or cracked floor; a vehicle, crane or heavy "
     "workpiece beside the machine; an instrument whose stand settles"},
    {"beam-misalignment",
     "The interferometer reads too little, by the more the longer the travel: its beam is not parallel to "
     "the motion (cosine error).",
     "a beam that was not aligned over the whole travel; a reflector or splitter that was knocked; a beam "
     "that was set by eye"},
    {"encoder-eccentricity", "An angle of the laser tracker is wrong by one wave per turn.",
     "a scale that sits off centre in the tracker's head; a tracker that was dropped or is due for service; "
     "a compensation file of another tracker"},
    {"run-offset", "One run differs from all others by a constant.",
     "a zero that was set anew or lost; a reflector or probe that was touched between runs; a warm-up "
     "between runs; a run read with another offset in the control"},
    {"probe-lobing", "The touch probe triggers sooner in some directions of contact than in others.",
     "a probe that rests on three supports; a long or heavy stylus; a trigger force that is set too high; a "
     "stylus ball that is out of round or off centre"},
    {"custom", "What was written in the model file explains the readings.",
     "those that its author had in mind"},
    {"empirical",
     "Something acts that no name of the catalogue explains: the readings alone draw it as a smooth "
     "function.",
     "read them off the picture: what changes there, and nowhere else"},
});

}  // namespace

const EffectMeaning* find_meaning(std::string_view kind) {
  const auto found = std::ranges::find(kMeanings, kind, &EffectMeaning::kind);
  return found == kMeanings.end() ? nullptr : &*found;
}

}  // namespace volcal

#include <nlohmann/json.hpp>

#include "volcal/identify/report/text/comparison_report.h"
#include "volcal/identify/standards/rotary_test_names.h"
#include "volcal/identify/text/json_text.h"
#include "volcal/identify/words/finding_json.h"
#include "volcal/model/description/units.h"
#include "volcal/model/observation/channels.h"

namespace volcal {
namespace {

using Json = nlohmann::ordered_json;

Json micro(const std::optional<double>& value) { return value ? Json(*value / kMicro) : Json(nullptr); }
Json micro(double value) { return value / kMicro; }
Json micro(const Eigen::Vector3d& v) { return {v.x() / kMicro, v.y() / kMicro, v.z() / kMicro}; }

Json written_size(const ResidualSize& size) {
  return {{"n", size.count}, {"mean", micro(size.mean)}, {"rms", micro(size.rms)}, {"max", micro(size.max)}};
}

Json written_cell(const ComparisonCell& cell) {
  Json json = {{"label", cell.label},
               {"observations", cell.observations},
               {"chi2", cell.chi2},
               {"dof", cell.dof},
               {"reduced_chi2", cell.reduced_chi2()}};
  if (cell.lengths.count > 0) json["lengths_um"] = written_size(cell.lengths);
  if (cell.angles.count > 0) json["angles_urad"] = written_size(cell.angles);
  json["probability"] = cell.probability;
  json["significant"] = cell.significant;
  json["stands_out"] = cell.stands_out;
  return json;
}

Json unidirectional_json(const UnidirectionalFigures& figures, const std::string& unit) {
  return {{"A_" + unit, micro(figures.accuracy)},
          {"E_" + unit, micro(figures.systematic)},
          {"R_" + unit, micro(figures.repeatability)}};
}

Json positioning_json(const PositioningFigures& figures, const std::string& unit) {
  return {{"targets", figures.targets.size()},
          {"A_" + unit, micro(figures.accuracy)},
          {"E_" + unit, micro(figures.systematic)},
          {"M_" + unit, micro(figures.mean_bidirectional)},
          {"R_" + unit, micro(figures.repeatability)},
          {"B_" + unit, micro(figures.reversal)},
          {"mean_B_" + unit, micro(figures.mean_reversal)},
          {"positive", unidirectional_json(figures.positive, unit)},
          {"negative", unidirectional_json(figures.negative, unit)}};
}

Json path_json(const std::optional<CircularPath>& path) {
  if (!path) return nullptr;
  return {{"G_um", micro(path->circular_deviation)},
          {"Fmax_um", micro(path->radial_max)},
          {"Fmin_um", micro(path->radial_min)},
          {"centring", path->centring == Centring::LeastSquares ? "least squares" : "instrument"},
          {"readings", path->readings}};
}

Json circular_json(const CircleTest& test, const CircularFigures& figures) {
  Json reversals = Json::array();
  for (const QuadrantReversal& reversal : figures.reversals) {
    const AxisName axis = reversal.axis == 0 ? test.first : test.second;
    reversals.push_back({{"axis", std::string{letter_of(axis)}},
                         {"side", reversal.side},
                         {"sense", reversal.sense > 0 ? "ccw" : "cw"},
                         {"B_um", micro(reversal.value)}});
  }
  return {{"ccw", path_json(figures.counter_clockwise)},
          {"cw", path_json(figures.clockwise)},
          {"Gb_um", micro(figures.bidirectional)},
          {"D_um", micro(figures.mean_radial)},
          {"reversals", reversals}};
}

Json written_volumetric(const VolumetricFigures& figures) {
  return {{"points", figures.points},
          {"range_um", micro(figures.range)},
          {"rms_um", micro(figures.rms)},
          {"max_um", micro(figures.max)}};
}

Json summary_json(const DiagonalSummary& summary) {
  return {{"diagonals", summary.diagonals},
          {"E_d_um", micro(summary.systematic)},
          {"B_d_um", micro(summary.reversal)}};
}

Json error_motion_json(const ErrorMotionFigures& figures, const std::string& unit) {
  return {{"angles", figures.angles},
          {"total_" + unit, micro(figures.total)},
          {"synchronous_" + unit, micro(figures.synchronous)},
          {"asynchronous_" + unit, micro(figures.asynchronous)},
          {"fundamental_" + unit, micro(figures.fundamental)}};
}

Json drift_json(const DriftFigures& figures, const std::string& unit) {
  return {{"duration_s", figures.duration},
          {"range_" + unit, micro(figures.range)},
          {"first_hour_" + unit, micro(figures.first_hour)},
          {"any_hour_" + unit, micro(figures.fastest_in_an_hour)},
          {"change_" + unit, micro(figures.change)}};
}

Json temperatures_json(const DriftTest& test) {
  Json ranges = Json::object();
  for (const TemperatureRange& range : test.temperatures) ranges[range.channel] = {range.low, range.high};
  return ranges;
}

/// Direct tests of rotary axes and drift at rest, where there are any.
void add_rotary_figures(const StandardFigures& figures, Json& json) {
  for (const RotaryPositioningTest& test : figures.rotary_lines) {
    json["iso230_2_rotary"].push_back({{"setup", test.setup},
                                       {"axis", std::string{letter_of(test.axis)}},
                                       {"place", test.place},
                                       {"readings", positioning_json(test.figures.readings, "urad")},
                                       {"model", positioning_json(test.figures.model, "urad")}});
    add_findings("notes", test.notes, json["iso230_2_rotary"].back());
  }
  for (const ErrorMotionTest& test : figures.error_motions) {
    const std::string unit = test.is_angle() ? "urad" : "um";
    json["iso230_7"].push_back({{"setup", test.setup},
                                {"axis", std::string{letter_of(test.axis)}},
                                {"motion", motion_name(test)},
                                {"readings", error_motion_json(test.figures.readings, unit)},
                                {"model", error_motion_json(test.figures.model, unit)}});
    add_findings("notes", test.notes, json["iso230_7"].back());
  }
  for (const DriftTest& test : figures.drifts) {
    const std::string unit = test.angle ? "urad" : "um";
    json["iso230_3"].push_back({{"setup", test.setup},
                                {"drift", drift_name(test)},
                                {"readings", drift_json(test.figures.readings, unit)},
                                {"model", drift_json(test.figures.model, unit)},
                                {"temperatures_degC", temperatures_json(test)}});
    add_findings("notes", test.notes, json["iso230_3"].back());
  }
}

Json figures_json(const StandardFigures& figures) {
  Json json = {{"iso230_2", Json::array()},
               {"iso230_6", Json::array()},
               {"iso230_6_diagonals", Json::array()},
               {"iso230_4", Json::array()},
               {"volumetric", Json::array()}};
  for (const AxisLineTest& test : figures.lines) {
    json["iso230_2"].push_back({{"setup", test.setup},
                                {"axis", std::string{letter_of(test.axis)}},
                                {"place", test.place},
                                {"readings", positioning_json(test.figures.readings, "um")},
                                {"model", positioning_json(test.figures.model, "um")}});
    add_findings("notes", test.notes, json["iso230_2"].back());
  }
  for (const DiagonalTest& test : figures.diagonals) {
    json["iso230_6"].push_back({{"setup", test.setup},
                                {"diagonal", test.figures.readings.name},
                                {"readings", positioning_json(test.figures.readings.positioning, "um")},
                                {"model", positioning_json(test.figures.model.positioning, "um")}});
    add_findings("notes", test.notes, json["iso230_6"].back());
  }
  for (const DiagonalGroup& group : figures.diagonal_groups) {
    json["iso230_6_diagonals"].push_back({{"axes", letters_of(group.axes)},
                                          {"readings", summary_json(group.summary.readings)},
                                          {"model", summary_json(group.summary.model)}});
  }
  for (const CircleTest& test : figures.circles) {
    json["iso230_4"].push_back({{"setup", test.setup},
                                {"plane", std::string{letter_of(test.first), letter_of(test.second)}},
                                {"radius_mm", test.radius * kPerMilli},
                                {"readings", circular_json(test, test.figures.readings)},
                                {"model", circular_json(test, test.figures.model)}});
    add_findings("notes", test.notes, json["iso230_4"].back());
  }
  for (const PointsTest& test : figures.points) {
    json["volumetric"].push_back({{"setup", test.setup},
                                  {"readings", written_volumetric(test.figures.readings)},
                                  {"model", written_volumetric(test.figures.model)},
                                  {"difference", written_volumetric(test.difference)}});
    add_findings("notes", test.notes, json["volumetric"].back());
  }
  add_rotary_figures(figures, json);
  add_findings("not_recognised", figures.not_recognised, json);
  return json;
}

Json worst_json(const Campaign& campaign, const ComparedModel& model) {
  Json worst = Json::array();
  for (const std::size_t i : model.comparison.worst) {
    const ResidualRecord& record = model.records[i];
    const Setup& setup = campaign.setups[record.setup];
    const auto channel = static_cast<std::size_t>(record.channel);
    const bool angle = is_angle_channel(setup, channel);
    worst.push_back({{"setup", setup.name},
                     {"line", record.source_line},
                     {"column", channel_column(setup, channel)},
                     {angle ? "residual_urad" : "residual_um", micro(record.residual())},
                     {angle ? "sigma_urad" : "sigma_um", micro(record.sigma)},
                     {"standardized", record.residual() / record.sigma},
                     {"w", record.w},
                     {"flagged", record.flagged},
                     {"removed", record.removed}});
  }
  return worst;
}

Json breakdowns_json(const Comparison& comparison) {
  Json breakdowns = Json::object();
  for (const Breakdown& breakdown : comparison.breakdowns) {
    Json cells = Json::array();
    for (const ComparisonCell& cell : breakdown.cells) cells.push_back(written_cell(cell));
    breakdowns[breakdown.by.name()] = std::move(cells);
  }
  return breakdowns;
}

Json model_json(const Campaign& campaign, const ComparedModel& model) {
  Json json = {{"name", model.name},
               {"where_it_fails", failure_sentence(model)},
               {"total", written_cell(model.comparison.total)},
               {"removed", model.comparison.removed},
               {"cells_tested", model.comparison.cells},
               {"by", breakdowns_json(model.comparison)},
               {"worst_readings", worst_json(campaign, model)},
               {"standards", figures_json(model.figures)}};
  if (model.screening) {
    json["scans"] = {{"tests", model.screening->tests},
                     {"contradict", model.screening->contradicts},
                     {"leading", model.screening->leading},
                     {"log10_p", model.screening->log10_p},
                     {"rms_um", model.screening->rms * kPerMicro}};
  }
  return json;
}

}  // namespace

std::string comparison_json(const Campaign& campaign, std::span<const ComparedModel> models,
                            std::span<const HeldOutModel> heldout) {
  Json list = Json::array();
  for (const ComparedModel& model : models) list.push_back(model_json(campaign, model));
  Json json = {{"format", "volcal-comparison-1"}, {"campaign", campaign.file}, {"models", list}};
  add_notes(campaign.notes, json);
  if (!heldout.empty()) json["held_out"] = Json::array();
  for (const HeldOutModel& model : heldout) {
    json["held_out"].push_back({{"name", model.name},
                                {"fitted_without_them", model.fitted},
                                {"total", written_cell(model.comparison.total)},
                                {"by", breakdowns_json(model.comparison)}});
  }
  return json_text(json, 2) + '\n';
}

}  // namespace volcal

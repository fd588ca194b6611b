/// What the tables take away: in the volume by computation, by type of compensation, of rotary axes; what
/// readings have shown before and, where there are any, with the tables active; and the errors that were
/// identified.

#include "volcal/identify/errors/error_tables.h"
#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/page.h"
#include "volcal/identify/report/values/error_range.h"

namespace volcal::report {
namespace {

Json left_row(const std::string& name, const ErrorLeft& left) {
  return {{"name", name}, {"rms", rounded_micrometres(left.rms)}, {"max", rounded_micrometres(left.max)}};
}

Json expected_row(const std::string& name, double rms) {
  return {{"name", name}, {"rms", rounded_micrometres(rms)}, {"max", nullptr}};
}

Json pose_left_row(const std::string& name, const PoseErrorLeft& left) {
  Json row = left_row(name, left);
  row["axis"] = rounded(left.axis_rms * kPerMicro, 4);
  row["axis_max"] = rounded(left.axis_max * kPerMicro, 4);
  return row;
}

Json volume_left_rows(const MadeTables& tables) {
  const VolumeCheck& check = tables.check;
  Json rows = Json::array();
  rows.push_back(left_row("before", check.before));
  rows.push_back(left_row("ideal " + tables.options.type.linear().name(), check.ideal));
  rows.push_back(left_row("tables as the controller reads them", check.exported));
  if (check.identification_u > 0.0)
    rows.push_back(expected_row("expected on the machine", check.expected_rms()));
  if (check.over_conditions)
    rows.push_back(left_row("tables, ends of the campaign's conditions", *check.over_conditions));
  if (check.fixed)
    rows.push_back(
        left_row("of it along " + check.fixed->axes_text() + ", where no axis moves", check.fixed->error));
  if (tables.all_axes) {
    rows.push_back(pose_left_row("before, poses of all axes", tables.all_axes->before));
    rows.push_back(pose_left_row("tables, poses of all axes", tables.all_axes->exported));
    if (tables.all_axes->identification_u > 0.0)
      rows.push_back(
          expected_row("expected on the machine, poses of all axes", tables.all_axes->expected_rms()));
  }
  return rows;
}

Json part_left_rows(const VolumeCheck& check) {
  Json rows = Json::array();
  for (const PartLeft& part : check.parts) {
    rows.push_back({{"type", CompensationType(part.part).name()},
                    {"before", rounded_micrometres(part.before.rms)},
                    {"after", rounded_micrometres(part.exported.rms)},
                    {"max_after", rounded_micrometres(part.exported.max)}});
  }
  return rows;
}

Json rotary_left_rows(const MadeTables& tables) {
  Json rows = Json::array();
  if (!tables.rotary_check) return rows;
  const auto add = [&](const char* name, const RotaryLeft& left) {
    rows.push_back({{"name", name},
                    {"rms", rounded_micrometres(left.rms)},
                    {"max", rounded_micrometres(left.max)},
                    {"axis", rounded(left.axis_rms * kPerMicro, 4)}});
  };
  add("before", tables.rotary_check->before);
  add("ideal", tables.rotary_check->ideal);
  add("tables as the controller reads them", tables.rotary_check->exported);
  if (tables.rotary_check->identification_u > 0.0)
    rows.push_back(expected_row("expected on the machine", tables.rotary_check->expected_rms()));
  return rows;
}

Json measured_row(const char* when, const MeasuredError& measured) {
  const auto size = [](const ErrorSize& each) -> Json {
    if (each.count == 0) return nullptr;
    return {{"count", each.count},
            {"rms", rounded(each.rms * kPerMicro, 4)},
            {"max", rounded(each.max * kPerMicro, 4)}};
  };
  return {{"when", when},
          {"campaign", measured.campaign},
          {"active", measured.active_compensations},
          {"setups", measured.setups},
          {"lengths", size(measured.sizes.lengths)},
          {"angles", size(measured.sizes.angles)}};
}

Json identified_rows(const FitResult& result) {
  const auto table = error_table(result);
  Json rows = Json::array();
  for (const Observability& error : result.rank.errors) {
    if (is_amplitude(result, error) || !error.symbol.has_symbol()) continue;
    const ErrorRange range = error_range(result, table, error);
    rows.push_back({{"symbol", error.symbol.name()},
                    {"unit", error.symbol.is_angle() ? "µrad" : "µm"},
                    {"visible", error.visible},
                    {"low", rounded(range.low * kPerMicro, 5)},
                    {"high", rounded(range.high * kPerMicro, 5)},
                    {"U95", rounded(range.expanded * kPerMicro, 4)}});
  }
  return rows;
}

}  // namespace

Json certificate_figures_page(const CertificateInput& input) {
  const CertificateView& certificate = input.certificate;
  Json measured = Json::array();
  measured.push_back(measured_row("before", certificate.before));
  if (certificate.after) measured.push_back(measured_row("with the tables", *certificate.after));
  return {{"volume", volume_left_rows(certificate.tables)},
          {"places", certificate.tables.check.places},
          {"poses", certificate.tables.all_axes ? kAllAxesPoses : 0},
          {"parts", part_left_rows(certificate.tables.check)},
          {"rotary", rotary_left_rows(certificate.tables)},
          {"measured", std::move(measured)},
          {"errors", identified_rows(certificate.result)}};
}

}  // namespace volcal::report

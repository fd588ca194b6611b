/// Residuals of every setup, lengths and angles apart, with their signed means.

#include <array>

#include "volcal/identify/report/numbers.h"
#include "volcal/identify/report/values/line_means.h"
#include "volcal/identify/report/values/residual_sample.h"
#include "volcal/model/description/units.h"
#include "volcal/model/observation/channels.h"

namespace volcal::report {
namespace {

constexpr std::size_t kDrawnReadings = 3000;
constexpr int kKindCount = 2;  // lengths, angles

/// By setup and kind.
using MeansOfSetups = std::vector<std::array<LineMean, kKindCount>>;

MeansOfSetups means_of(const Campaign& campaign, const std::vector<ResidualRecord>& records,
                       const std::vector<std::vector<bool>>& is_angle) {
  MeansOfSetups means(campaign.setups.size());
  for (const ResidualRecord& record : records) {
    if (record.removed || record.left_out) continue;
    const std::vector<std::int32_t>& line = campaign.setups[record.setup].readings.line;
    const bool angle = is_angle[record.setup][static_cast<std::size_t>(record.channel)];
    means[record.setup][angle ? 1 : 0].add(record.residual(), record.sigma, record.setup,
                                           line.empty() ? 0 : line[record.row]);
  }
  return means;
}

Json setups_json(const Campaign& campaign, const std::vector<MeansOfSetups>& models) {
  Json rows = Json::array();
  for (std::size_t s = 0; s < campaign.setups.size(); ++s) {
    for (std::size_t kind = 0; kind < kKindCount; ++kind) {
      if (models.front()[s][kind].count() == 0) continue;
      Json of_models = Json::array();
      for (const MeansOfSetups& model : models) {
        const LineMean& mean = model[s][kind];
        of_models.push_back({{"mean", rounded(mean.mean() * kPerMicro, 3)},
                             {"band", rounded(2.0 * mean.standard_u() * kPerMicro, 2)},
                             {"rms", rounded(mean.rms() * kPerMicro, 4)}});
      }
      rows.push_back({{"setup", s},
                      {"name", campaign.setups[s].name},
                      {"instrument", campaign.setups[s].instrument},
                      {"angle", kind == 1},
                      {"count", models.front()[s][kind].count()},
                      {"models", std::move(of_models)}});
    }
  }
  return rows;
}

Json volumetric_json(const VolumetricFigures& figures) {
  return {{"rms", rounded(figures.rms * kPerMicro, 4)},
          {"max", rounded(figures.max * kPerMicro, 4)},
          {"range", rounded_vector(figures.range, kPerMicro, 4)}};
}

/// Error vectors at points, where they were measured.
Json points_json(std::span<const ComparedModel> models) {
  Json rows = Json::array();
  const auto& tests = models.front().figures.points;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const auto add = [&](const std::string& source, const VolumetricFigures& figures) {
      Json row = volumetric_json(figures);
      row["setup"] = tests[i].setup;
      row["source"] = source;
      row["points"] = figures.points;
      rows.push_back(std::move(row));
    };
    add("measured", tests[i].figures.readings);
    for (const ComparedModel& model : models) {
      add(model.name, model.figures.points[i].figures.model);
      add("measured less " + model.name, model.figures.points[i].difference);
    }
  }
  return rows;
}

}  // namespace

Json setup_residuals_page(const ComparisonInput& input) {
  const std::vector<std::vector<bool>> is_angle = angle_channels(input.campaign);
  std::vector<MeansOfSetups> means;
  Json names = Json::array();
  for (const ComparedModel& model : input.models) {
    means.push_back(means_of(input.campaign, model.records, is_angle));
    names.push_back(model.name);
  }
  const std::vector<ResidualRecord>& last = input.models.back().records;
  Json setup = Json::array(), angle = Json::array(), line = Json::array(), sigma = Json::array();
  std::vector<Json> residual(input.models.size(), Json::array());
  const std::vector<std::size_t> drawn = residual_sample(last, kDrawnReadings);
  for (const std::size_t i : drawn) {
    const ResidualRecord& record = last[i];
    setup.push_back(record.setup);
    angle.push_back(is_angle[record.setup][static_cast<std::size_t>(record.channel)] ? 1 : 0);
    line.push_back(record.source_line);
    sigma.push_back(rounded(record.sigma * kPerMicro, 3));
    for (std::size_t m = 0; m < input.models.size(); ++m)
      residual[m].push_back(rounded(input.models[m].records[i].residual() * kPerMicro, 4));
  }
  return {{"models", std::move(names)},
          {"total", last.size()},
          {"drawn", drawn.size()},
          {"setups", setups_json(input.campaign, means)},
          {"points", points_json(input.models)},
          {"records",
           {{"setup", std::move(setup)},
            {"angle", std::move(angle)},
            {"file_line", std::move(line)},
            {"sigma", std::move(sigma)},
            {"residual", residual}}}};
}

}  // namespace volcal::report

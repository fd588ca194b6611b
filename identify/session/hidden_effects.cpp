#include "volcal/identify/session/hidden_effects.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "volcal/identify/solve/normals/datum.h"
#include "volcal/identify/solve/rank_causes.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

constexpr double kPartner = 0.05;  // of the squares of what the effect moves the readings by
constexpr std::size_t kMostPartners = 3;

/// Columns of the model that belong to one error.
struct ErrorColumns {
  MachineError error;
  Eigen::Index first;
  Eigen::Index count;
};

std::vector<ErrorColumns> error_columns(const MeasurementModel& model) {
  const ParameterLayout& layout = model.layout();
  const DatumSpace datum(layout, model.campaign().machine, Eigen::VectorXd::Zero(layout.size));
  std::vector<ErrorColumns> all;
  for (const auto& function : datum.functions())
    all.push_back({function.symbol, function.offset, function.size()});
  for (const auto& block : datum.blocks())
    all.push_back({layout.blocks[block.block].machine_error(), block.offset, block.size});
  return all;
}

Eigen::VectorXd weight_of(const LinearModel& model) {
  const std::vector<double>& sigma = model.problem().data.sigma;
  Eigen::VectorXd weight(static_cast<Eigen::Index>(sigma.size()));
  for (Eigen::Index i = 0; i < weight.size(); ++i)
    weight[i] = 1.0 / sigma[static_cast<std::size_t>(i)];  // 0 where it is left out
  return weight;
}

/// How the model imitates one effect.
class Imitation {
 public:
  Imitation(const ModelState& state, Eigen::VectorXd weight, double squares)
      : state_(state), weight_(std::move(weight)), squares_(squares) {}

  /// What moves the readings as the effect does, largest first.
  std::vector<MachineError> partners(const std::vector<ErrorColumns>& model,
                                     const Eigen::VectorXd& by) const {
    std::vector<std::pair<double, MachineError>> ranked;
    const auto compare = [&](const MachineError& error, const Eigen::VectorXd& moved) {
      const double share = moved.cwiseProduct(weight_).squaredNorm() / squares_;
      if (share > kPartner) ranked.emplace_back(share, error);
    };
    const auto& jacobian = state_.model().problem().jacobian;
    for (const ErrorColumns& each : model)
      compare(each.error, jacobian.middleCols(each.first, each.count) * by.segment(each.first, each.count));
    Eigen::Index at = jacobian.cols();
    for (const AddedEffect& added : state_.added()) {
      compare(MachineError(state_.family_of(added).label()),
              added.columns * by.segment(at, added.columns.cols()));
      at += added.columns.cols();
    }
    std::ranges::sort(ranked, std::greater<>(),
                      [](const auto& each) { return std::pair(each.first, each.second.name()); });
    std::vector<MachineError> partners;
    for (std::size_t i = 0; i < std::min(ranked.size(), kMostPartners); ++i)
      partners.push_back(ranked[i].second);
    return partners;
  }

 private:
  const ModelState& state_;
  Eigen::VectorXd weight_;
  double squares_;
};

}  // namespace

std::vector<Explanation> why_hidden(const ModelState& state, const std::vector<const FamilyTest*>& tests) {
  if (tests.empty()) return {};
  const LinearModel& model = state.model();
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(model.size()), static_cast<Eigen::Index>(tests.size()));
  for (Eigen::Index k = 0; k < moved.cols(); ++k) {
    const FamilyTest& test = *tests[static_cast<std::size_t>(k)];
    moved.col(k) = family_columns(model, state.setting().families[test.family], test.shape).rowwise().sum();
  }
  const Eigen::MatrixXd by = state.projector().imitation(moved);
  const Eigen::VectorXd weight = weight_of(model);
  const std::vector<ErrorColumns> columns = error_columns(model.model());
  std::vector<Explanation> why;
  for (Eigen::Index k = 0; k < moved.cols(); ++k) {
    const std::string label = state.setting().families[tests[static_cast<std::size_t>(k)]->family].label();
    const double squares = moved.col(k).cwiseProduct(weight).squaredNorm();
    if (squares == 0.0) {
      why.push_back(explanation(cause_of_unseen(model.campaign(), MachineError(label))));
      continue;
    }
    const std::vector<MachineError> partners = Imitation(state, weight, squares).partners(columns, by.col(k));
    why.push_back(explanation(partners.empty()
                                  ? Finding{FindingCode::NotVisibleReadingsTooFew, {{"error", label}}}
                                  : cause_exchangeable(model.model(), MachineError(label), partners)));
  }
  return why;
}

}  // namespace volcal

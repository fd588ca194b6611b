#include "volcal/identify/io/exports/gtc_archive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "volcal/identify/numeric/content_hash.h"
#include "volcal/identify/text/json_text.h"

namespace volcal {
namespace {

constexpr const char* kGtcVersion = "https://measurement.govt.nz/gtc/json_1.5.0";

using GtcJson = nlohmann::ordered_json;

bool is_gtc_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

class GtcLeaves {
 public:
  explicit GtcLeaves(const JointValues& joint)
      : joint_(joint), u_(joint.covariance.diagonal().cwiseMax(0.0).cwiseSqrt()) {
    ContentHash hash;
    for (const std::string& name : joint.names) hash.add(std::string_view(name));
    for (const double value : joint.values) hash.add(value);
    for (const double value : joint.covariance.reshaped()) hash.add(value);
    context_ = std::to_string(hash.value());
    for (Eigen::Index i = 0; i < u_.size(); ++i) {
      correlated_.push_back(is_correlated(i));
      if (correlated_.back()) ensemble_ += (ensemble_.empty() ? "\"" : ",\"") + uid(i) + "\"";
    }
  }

  std::string uid(Eigen::Index i) const { return "(" + context_ + ", " + std::to_string(i + 1) + ")"; }

  std::string leaf(Eigen::Index i) const {
    const auto at = static_cast<std::size_t>(i);
    const bool correlated = correlated_[at];
    const GtcJson head = {
        {"CLASS", "LeafNode"}, {"uid", uid(i)}, {"label", joint_.names[at] + " [" + joint_.units[at] + "]"},
        {"u", u_[i]},          {"df", nullptr}, {"independent", !correlated}};
    std::string text = json_text(head, -1);
    if (!correlated) return text;
    std::string correlations = "\"" + uid(i) + "\":1.0";  // GTC takes covariances of functions from it
    for (Eigen::Index j = 0; j < u_.size(); ++j) {
      if (const double r = correlation(i, j); j != i && r != 0.0)
        correlations += ",\"" + uid(j) + "\":" + GtcJson(r).dump();
    }
    text.pop_back();
    return text + ",\"correlation\":{" + correlations + "},\"ensemble\":[" + ensemble_ + "]}";
  }

  GtcJson number(Eigen::Index i) const {
    return {{"CLASS", "ElementaryReal"}, {"x", joint_.values[i]}, {"uid", uid(i)}};
  }

  /// Of the n-th function of the parameters.
  std::string function_uid(Eigen::Index n) const {
    return "(" + context_ + ", " + std::to_string(n + 1) + ", 0)";
  }
  /// A function of the parameters by its components of uncertainty, derivative times u of each parameter.
  GtcJson function(Eigen::Index n, double value, double u, const std::string& label,
                   const Eigen::RowVectorXd& derivatives) const {
    GtcJson independent = empty_vector(), dependent = empty_vector();
    for (Eigen::Index i = 0; i < u_.size(); ++i) {
      const double component = derivatives[i] * u_[i];
      if (component == 0.0) continue;
      GtcJson& components = correlated_[static_cast<std::size_t>(i)] ? dependent : independent;
      components["index"].push_back(uid(i));
      components["value"].push_back(component);
    }
    return {{"CLASS", "IntermediateReal"},
            {"value", value},
            {"label", label},
            {"uid", function_uid(n)},
            {"u_components", independent},
            {"d_components", dependent},
            {"i_components",
             {{"CLASS", "Vector"},
              {"index", GtcJson::array({function_uid(n)})},
              {"value", GtcJson::array({u})}}}};
  }

 private:
  static GtcJson empty_vector() {
    return {{"CLASS", "Vector"}, {"index", GtcJson::array()}, {"value", GtcJson::array()}};
  }

  double correlation(Eigen::Index i, Eigen::Index j) const {
    const double scale = u_[i] * u_[j];
    return scale > 0.0 ? std::clamp(joint_.covariance(i, j) / scale, -1.0, 1.0) : 0.0;
  }

  bool is_correlated(Eigen::Index i) const {
    for (Eigen::Index j = 0; j < u_.size(); ++j) {
      if (j != i && correlation(i, j) != 0.0) return true;
    }
    return false;
  }

  const JointValues& joint_;
  Eigen::VectorXd u_;
  std::vector<bool> correlated_;
  std::string context_;
  std::string ensemble_;  ///< identities of its leaves, as a list of JSON
};

}  // namespace

std::vector<std::string> gtc_tags(const std::vector<std::string>& names) {
  std::vector<std::string> tags;
  std::set<std::string> taken;
  for (const std::string& name : names) {
    std::string tag;
    for (const char c : name) tag += is_gtc_character(c) ? c : '_';
    if (tag.empty() || (tag[0] >= '0' && tag[0] <= '9')) tag.insert(0, 1, '_');
    const std::string stem = tag;
    for (int copy = 2; !taken.insert(tag).second; ++copy) tag = stem + "_" + std::to_string(copy);
    tags.push_back(tag);
  }
  return tags;
}

std::vector<std::string> gtc_row_names(const JointTable& table) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < table.rows.names.size(); ++i) {
    std::string name = table.rows.names[i];
    const double position = table.positions[static_cast<Eigen::Index>(i)];
    if (std::isnan(position)) {
      name += " in tables";
    } else {
      name += (position < 0.0 ? " at minus " : " at ") + fmt::format("{:.10g} ", std::abs(position)) +
              table.position_units[i];
    }
    if (table.directions[i] != 0) name += table.directions[i] > 0 ? " towards plus" : " towards minus";
    names.push_back(name);
  }
  return names;
}

std::string gtc_archive(const JointValues& joint, const JointTable& table) {
  const GtcLeaves leaves(joint);
  const std::vector<std::string> rows = gtc_row_names(table);
  std::vector<std::string> names = joint.names;
  names.insert(names.end(), rows.begin(), rows.end());
  const std::vector<std::string> tags = gtc_tags(names);
  std::string text =
      "{\"CLASS\": \"Archive\",\n\"version\": " + GtcJson(kGtcVersion).dump() + ",\n\"leaf_nodes\": {";
  for (Eigen::Index i = 0; i < joint.values.size(); ++i)
    text += (i ? ",\n" : "\n") + GtcJson(leaves.uid(i)).dump() + ": " + leaves.leaf(i);
  text += "},\n\"tagged_real\": {";
  for (Eigen::Index i = 0; i < joint.values.size(); ++i)
    text += (i ? ",\n" : "\n") + GtcJson(tags[static_cast<std::size_t>(i)]).dump() + ": " +
            json_text(leaves.number(i), -1);
  std::string intermediate;
  for (Eigen::Index n = 0; n < table.rows.values.size(); ++n) {
    const auto at = static_cast<std::size_t>(n);
    const double u = std::sqrt(std::max(0.0, table.rows.covariance(n, n)));
    const std::string label = rows[at] + " [" + table.rows.units[at] + "]";
    text += ",\n" + GtcJson(tags[joint.names.size() + at]).dump() + ": " +
            json_text(leaves.function(n, table.rows.values[n], u, label, table.derivatives.row(n)), -1);
    const GtcJson node = GtcJson::array({label, u, nullptr});
    intermediate += (n ? ",\n" : "\n") + GtcJson(leaves.function_uid(n)).dump() + ": " + json_text(node, -1);
  }
  return text + "},\n\"tagged_complex\": {},\n\"untagged_real\": {},\n\"intermediate_uids\": {" +
         intermediate + "}}\n";
}

}  // namespace volcal

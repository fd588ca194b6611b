#pragma once
/// Parts of result.json: machine, model, parameter layout, covariance. Reading throws std::exception.

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>

#include "volcal/model/description/machine.h"
#include "volcal/model/description/model_spec.h"
#include "volcal/model/observation/parameters.h"

namespace volcal::json_parts {

using Json = nlohmann::ordered_json;

/// Throws std::invalid_argument where a key or a text holds a control character other than a line end: names
/// are shown on terminals and written into tables.
void require_no_control(const Json& json);
/// A number, or its name when it is not finite.
Json number(double value);
double number(const Json& json);
Json vector(const Eigen::Ref<const Eigen::VectorXd>& values);
Eigen::VectorXd vector_from(const Json& json);
ErrorSymbol error_symbol(const Json& json);

Json machine(const Machine& machine);
Machine machine_from(const Json& json);
Json model(const ModelSpec& spec);
ModelSpec model_from(const Json& json);
/// kind and options of an effect, SI.
Json effect(const EffectSpec& effect);
EffectSpec effect_from(const Json& json);
Json layout(const ParameterLayout& layout);
/// Bases are made anew from the identified model.
ParameterLayout layout_from(const Json& json, const Machine& machine, const ModelSpec& spec);

/// Lower triangle, one array per row and line. A covariance is symmetric: the upper triangle is not kept.
std::string covariance_text(const Eigen::MatrixXd& covariance);
Eigen::MatrixXd covariance_from(const Json& json);

}  // namespace volcal::json_parts

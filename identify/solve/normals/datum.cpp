#include "volcal/identify/solve/normals/datum.h"

#include <algorithm>
#include <utility>

#include "volcal/identify/numeric/dense.h"

namespace volcal {

Eigen::MatrixXd datum_constraints(const Basis& basis, ErrorSymbol symbol, const Axis& axis) {
  const FunctionDatum datum = datum_of(symbol);
  if (datum == FunctionDatum::Mean) return moments(basis).zeroth.transpose() / axis.travel();
  Eigen::MatrixXd constraints(datum == FunctionDatum::Home ? 1 : 2, basis.size());
  constraints.row(0) = basis.row(axis.home).transpose();
  if (datum == FunctionDatum::HomeAndSlope) {
    const BasisMoments moment = moments(basis);
    const double middle = 0.5 * (axis.travel_min + axis.travel_max);
    constraints.row(1) =
        (moment.first - middle * moment.zeroth).transpose() / (axis.travel() * axis.travel());
  }
  return constraints;
}

DatumSpace::DatumSpace(const ParameterLayout& layout, const Machine& machine, Eigen::VectorXd base,
                       const std::function<bool(ErrorSymbol)>& function_is_free,
                       const std::function<bool(const ParameterBlock&)>& block_is_free)
    : base_(std::move(base)) {
  for (const FunctionGroup& group : layout.groups) {
    for (int slot = 0; slot < group.count(); ++slot) {
      const ErrorSymbol symbol = group.symbols[static_cast<std::size_t>(slot)];
      if (!function_is_free(symbol)) continue;
      FunctionCoordinates function;
      function.symbol = symbol;
      for (int j = 0; j < group.basis->size(); ++j) function.raw.push_back(group.index(j, slot));
      function.basis = null_space(datum_constraints(*group.basis, symbol, machine.axis(group.axis)));
      function.offset = size_;
      size_ += function.size();
      for (const int index : function.raw) base_[index] = 0.0;
      functions_.push_back(std::move(function));
    }
  }
  for (std::size_t i = 0; i < layout.blocks.size(); ++i) {
    const ParameterBlock& block = layout.blocks[i];
    if (block.is_held || !block_is_free(block)) continue;
    blocks_.push_back({i, block.offset, size_, block.size()});
    size_ += block.size();
    base_.segment(block.offset, block.size()).setZero();
  }
}

DatumSpace::DatumSpace(const ParameterLayout& layout, const Machine& machine, Eigen::VectorXd base)
    : DatumSpace(
          layout, machine, std::move(base), [](ErrorSymbol) { return true; },
          [](const ParameterBlock&) { return true; }) {}

Eigen::VectorXd DatumSpace::raw(const Eigen::VectorXd& reduced) const {
  Eigen::VectorXd raw = base_;
  for (const FunctionCoordinates& function : functions_) {
    const Eigen::VectorXd coefficients = function.basis * reduced.segment(function.offset, function.size());
    for (std::size_t j = 0; j < function.raw.size(); ++j)
      raw[function.raw[j]] = coefficients[static_cast<int>(j)];
  }
  for (const BlockCoordinates& block : blocks_) {
    raw.segment(block.raw_offset, block.size) = reduced.segment(block.offset, block.size);
  }
  return raw;
}

Eigen::VectorXd DatumSpace::reduced(const Eigen::VectorXd& raw) const { return reduce_gradient(raw); }

Eigen::VectorXd DatumSpace::reduce_gradient(const Eigen::VectorXd& raw_gradient) const {
  Eigen::VectorXd reduced(size_);
  for (const FunctionCoordinates& function : functions_) {
    reduced.segment(function.offset, function.size()) =
        function.basis.transpose() * raw_gradient(function.raw);
  }
  for (const BlockCoordinates& block : blocks_) {
    reduced.segment(block.offset, block.size) = raw_gradient.segment(block.raw_offset, block.size);
  }
  return reduced;
}

Eigen::MatrixXd DatumSpace::reduce_rows(const Eigen::MatrixXd& raw_rows) const {
  Eigen::MatrixXd reduced(raw_rows.rows(), size_);
  for (const FunctionCoordinates& function : functions_) {
    reduced.middleCols(function.offset, function.size()).noalias() =
        raw_rows(Eigen::all, function.raw) * function.basis;
  }
  for (const BlockCoordinates& block : blocks_) {
    reduced.middleCols(block.offset, block.size) = raw_rows.middleCols(block.raw_offset, block.size);
  }
  return reduced;
}

std::vector<bool> DatumSpace::touched(const std::vector<int>& raw_parameters) const {
  std::vector<bool> raw(static_cast<std::size_t>(base_.size()), false);
  for (const int index : raw_parameters) raw[static_cast<std::size_t>(index)] = true;
  std::vector<bool> reduced(static_cast<std::size_t>(size_), false);
  const auto mark = [&](int offset, int size) { std::fill_n(reduced.begin() + offset, size, true); };
  for (const FunctionCoordinates& function : functions_) {
    const auto is_touched = [&](int index) { return raw[static_cast<std::size_t>(index)]; };
    if (std::ranges::any_of(function.raw, is_touched)) mark(function.offset, function.size());
  }
  for (const BlockCoordinates& block : blocks_) {
    for (int k = 0; k < block.size; ++k) {
      if (raw[static_cast<std::size_t>(block.raw_offset) + static_cast<std::size_t>(k)])
        mark(block.offset, block.size);
    }
  }
  return reduced;
}

Eigen::MatrixXd DatumSpace::reduce_matrix(const Eigen::MatrixXd& raw_matrix) const {
  return reduce_rows(reduce_rows(raw_matrix).transpose());
}

Eigen::MatrixXd DatumSpace::expand_covariance(const Eigen::MatrixXd& reduced_covariance) const {
  const auto expand_rows = [this](const Eigen::MatrixXd& reduced) {
    Eigen::MatrixXd raw = Eigen::MatrixXd::Zero(base_.size(), reduced.cols());
    for (const FunctionCoordinates& function : functions_) {
      raw(function.raw, Eigen::all) = function.basis * reduced.middleRows(function.offset, function.size());
    }
    for (const BlockCoordinates& block : blocks_) {
      raw.middleRows(block.raw_offset, block.size) = reduced.middleRows(block.offset, block.size);
    }
    return raw;
  };
  return expand_rows(expand_rows(reduced_covariance).transpose());
}

}  // namespace volcal

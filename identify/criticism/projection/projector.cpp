#include "volcal/identify/criticism/projection/projector.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {

Eigen::MatrixXd ProjectedColumns::gram(Eigen::Index begin, Eigen::Index columns) const {
  const auto after = std::ranges::upper_bound(first, begin);
  const auto group = static_cast<std::size_t>(after - first.begin()) - 1;
  const Eigen::Index at = begin - first[group];
  return grams[group].block(at, at, columns, columns);
}

Projector::Projector(const NoiseProblem& problem, const NoiseData& data,
                     std::span<const NoiseParameters> noise, int threads, std::vector<Eigen::Index> parts)
    : whitener_(data, noise),
      threads_(threads),
      base_parameters_(problem.jacobian.cols()),
      parts_(parts.empty() ? std::vector<Eigen::Index>{0, problem.jacobian.rows()} : std::move(parts)),
      whitened_(part_count()),
      precision_(problem.prior_precision.size() > 0
                     ? problem.prior_precision
                     : Eigen::MatrixXd(Eigen::MatrixXd::Zero(base_parameters_, base_parameters_))) {
  use_single_threaded_blas();
  const Eigen::VectorXd mean = problem.prior_mean.size() > 0
                                   ? problem.prior_mean
                                   : Eigen::VectorXd(Eigen::VectorXd::Zero(base_parameters_));
  pull_ = precision_ * mean;
  prior_squares_ = mean.dot(pull_);
  run_parallel(part_count(), threads_, [&](std::size_t part) {
    Eigen::MatrixXd rows(part_rows(part), base_parameters_ + 1);
    rows << problem.jacobian.middleRows(parts_[part], part_rows(part)),
        problem.residual.segment(parts_[part], part_rows(part));
    whitened_[part] = whitener_.whiten_part(static_cast<std::size_t>(parts_[part]), rows);
  });
  if (problem.local && problem.local->columns() > 0) {
    std::vector<std::vector<std::size_t>> order;
    for (std::size_t part = 0; part < part_count(); ++part)
      order.push_back(whitener_.order_of_part(static_cast<std::size_t>(parts_[part]), part_rows(part)));
    local_product_.emplace(problem.local, order);
  }
  factorise();
}

/// Columns are scaled to unit diagonal of A first: they carry different units.
void Projector::factorise() {
  const Eigen::Index count = parameters();
  std::vector<Eigen::MatrixXd> products(part_count());
  run_parallel(part_count(), threads_, [&](std::size_t part) {
    products[part] = Eigen::MatrixXd::Zero(count + 1, count + 1);
    add_gram_upper(whitened_[part], 1.0, products[part]);
  });
  gram_ = std::move(products[0]);
  for (std::size_t part = 1; part < part_count(); ++part) gram_ += products[part];
  symmetrise_from_upper(gram_);
  residual_squares_ = gram_(count, count);
  Eigen::MatrixXd normal = gram_.topLeftCorner(count, count);
  normal.topLeftCorner(base_parameters_, base_parameters_) += precision_;
  scale_ = normal.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  normal = scale_.asDiagonal() * normal * scale_.asDiagonal();
  auto lower = cholesky_lower(normal);
  if (!lower) {
    normal.diagonal().array() += 1e-12;  // what neither readings nor priors determine stays where it is
    lower = cholesky_lower(normal);
    if (!lower) throw std::runtime_error("the model's columns are not independent");
  }
  lower_ = std::move(*lower);
  Eigen::MatrixXd right = gram_.col(count).head(count);
  right.col(0).head(base_parameters_) += pull_;
  right = scale_.asDiagonal() * right;
  solve_lower(lower_, right);
  rotated_ = right;
}

Projector::PartialProducts Projector::zero_products(Eigen::Index columns) const {
  PartialProducts products;
  products.with_others.setZero(parameters() + 1 - local_columns(), columns);
  if (local_product_) {
    for (Eigen::Index column = 0; column < columns; column += kColumnBlock)
      products.with_local.push_back(local_product_->zero_sums());
  }
  return products;
}

Eigen::MatrixXd Projector::add_products(std::size_t part, const Eigen::MatrixXd& rows,
                                        PartialProducts& products) const {
  const auto first = static_cast<std::size_t>(parts_[part]);
  const auto others = whitened_[part].rightCols(parameters() + 1 - local_columns());
  Eigen::MatrixXd whitened;
  if (!local_product_) {
    whitened = whitener_.whiten_part(first, rows);
  } else {
    whitened.resize(others.rows(), rows.cols());
    Eigen::MatrixXd weighed;
    for (Eigen::Index column = 0; column < rows.cols(); column += kColumnBlock) {
      const Eigen::Index count = std::min(kColumnBlock, rows.cols() - column);
      whitener_.weigh_part(first, rows.middleCols(column, count), whitened.middleCols(column, count),
                           weighed);
      local_product_->add(part, weighed,
                          products.with_local[static_cast<std::size_t>(column / kColumnBlock)]);
    }
  }
  add_transposed_product(others, whitened, products.with_others);
  return whitened;
}

Eigen::MatrixXd Projector::combined(const PartialProducts& products, Eigen::Index columns) const {
  Eigen::MatrixXd all(parameters() + 1, columns);
  all.bottomRows(products.with_others.rows()) = products.with_others;
  for (Eigen::Index column = 0; column < columns && local_product_; column += kColumnBlock) {
    const Eigen::Index count = std::min(kColumnBlock, columns - column);
    local_product_->combine(products.with_local[static_cast<std::size_t>(column / kColumnBlock)],
                            all.block(0, column, local_columns(), count));
  }
  return all;
}

ProjectedColumns Projector::project(const CandidateColumns& candidates) const {
  ProjectedColumns out;
  Eigen::Index at = 0;
  for (const Eigen::Index width : candidates.groups) {
    out.first.push_back(at);
    out.grams.emplace_back(Eigen::MatrixXd::Zero(width, width));
    at += width;
  }
  PartialProducts partial = zero_products(candidates.count);
  Eigen::MatrixXd rows;
  for (std::size_t part = 0; part < part_count(); ++part) {
    rows.resize(part_rows(part), candidates.count);
    candidates.fill(part, rows);
    const Eigen::MatrixXd whitened = add_products(part, rows, partial);
    for (std::size_t group = 0; group < out.grams.size(); ++group) {
      add_gram_upper(whitened.middleCols(out.first[group], candidates.groups[group]), 1.0, out.grams[group]);
    }
  }
  const Eigen::MatrixXd products = combined(partial, candidates.count);
  Eigen::MatrixXd explained = scale_.asDiagonal() * products.topRows(parameters());
  solve_lower(lower_, explained);
  out.score = products.bottomRows(1).transpose() - explained.transpose() * rotated_;
  out.norm.resize(candidates.count);
  for (std::size_t group = 0; group < out.grams.size(); ++group) {
    const Eigen::Index first = out.first[group], width = candidates.groups[group];
    out.norm.segment(first, width) = out.grams[group].diagonal().cwiseSqrt();
    add_gram_upper(explained.middleCols(first, width), -1.0, out.grams[group]);
    symmetrise_from_upper(out.grams[group]);
  }
  return out;
}

ProjectedColumns Projector::project(const Eigen::MatrixXd& columns) const {
  return project({columns.cols(), {columns.cols()}, [&](std::size_t part, Eigen::Ref<Eigen::MatrixXd> rows) {
                    rows = columns.middleRows(parts_[part], part_rows(part));
                  }});
}

Eigen::MatrixXd Projector::imitation(const Eigen::MatrixXd& columns) const {
  PartialProducts partial = zero_products(columns.cols());
  for (std::size_t part = 0; part < part_count(); ++part)
    add_products(part, columns.middleRows(parts_[part], part_rows(part)), partial);
  Eigen::MatrixXd rotated = scale_.asDiagonal() * combined(partial, columns.cols()).topRows(parameters());
  solve_lower(lower_, rotated);
  return scale_.asDiagonal() * lower_.triangularView<Eigen::Lower>().transpose().solve(rotated).eval();
}

void Projector::accept(const Eigen::MatrixXd& columns) {
  const Eigen::Index before = parameters();
  for (std::size_t part = 0; part < part_count(); ++part) {
    const Eigen::MatrixXd added = whitener_.whiten_part(static_cast<std::size_t>(parts_[part]),
                                                        columns.middleRows(parts_[part], part_rows(part)));
    Eigen::MatrixXd& all = whitened_[part];
    all.conservativeResize(Eigen::NoChange, all.cols() + added.cols());
    all.rightCols(1) = all.col(before).eval();
    all.middleCols(before, added.cols()) = added;
  }
  factorise();
}

Eigen::VectorXd Projector::solution() const {
  return scale_.cwiseProduct(lower_.triangularView<Eigen::Lower>().transpose().solve(rotated_));
}

Eigen::VectorXd Projector::weighed_residual() const {
  const Eigen::VectorXd at = solution();
  Eigen::VectorXd whitened = Eigen::VectorXd::Zero(parts_.back());
  for (std::size_t part = 0; part < part_count(); ++part) {
    const Eigen::VectorXd left = whitened_[part].rightCols(1) - whitened_[part].leftCols(at.size()) * at;
    const auto order = whitener_.order_of_part(static_cast<std::size_t>(parts_[part]), part_rows(part));
    for (std::size_t i = 0; i < order.size(); ++i)
      whitened[static_cast<Eigen::Index>(order[i])] = left[static_cast<Eigen::Index>(i)];
  }
  return whitener_.whiten_transposed(std::move(whitened));
}

Eigen::MatrixXd Projector::rotated_rows(const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd rotated = scale_.asDiagonal() * rows.transpose();
  solve_lower(lower_, rotated);
  return rotated;
}

Eigen::VectorXd Projector::prediction_variance(const Eigen::MatrixXd& rows) const {
  return rotated_rows(rows).colwise().squaredNorm();
}

Eigen::MatrixXd Projector::accepted_covariance() const {
  const Eigen::Index count = accepted();
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(parameters(), count);
  unit.bottomRows(count).setIdentity();
  solve_lower(lower_, unit);
  const Eigen::MatrixXd inverse = unit.transpose() * unit;
  const auto scale = scale_.tail(count).asDiagonal();
  return scale * inverse * scale;
}

double Projector::residual_squares() const {
  return residual_squares_ + prior_squares_ - rotated_.squaredNorm();
}

}  // namespace volcal

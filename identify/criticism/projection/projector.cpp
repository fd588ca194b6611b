#include "volcal/identify/criticism/projection/projector.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/numeric/parallel.h"

namespace volcal {
namespace {

constexpr Eigen::Index kMostNumbersAtOnce = Eigen::Index{1} << 25;  // 256 MiB of products of several parts

/// Of so many parts those whose products, so many numbers each, wait to be added up.
std::size_t parts_at_once(Eigen::Index numbers, std::size_t parts) {
  const Eigen::Index most =
      std::max<Eigen::Index>(kMostNumbersAtOnce / std::max<Eigen::Index>(numbers, 1), 1);
  return std::clamp<std::size_t>(parts, 1, static_cast<std::size_t>(most));
}

}  // namespace

Eigen::MatrixXd ProjectedColumns::gram(Eigen::Index begin, Eigen::Index columns) const {
  const auto after = std::ranges::upper_bound(first, begin);
  const auto group = static_cast<std::size_t>(after - first.begin()) - 1;
  const Eigen::Index at = begin - first[group];
  return grams[group].block(at, at, columns, columns);
}

Projector::Projector(const NoiseProblem& problem, const NoiseData& data,
                     std::span<const NoiseParameters> noise, int threads, std::vector<Eigen::Index> parts)
    : whitener_(std::make_shared<const Whitener>(data, noise)),
      threads_(threads),
      base_parameters_(problem.jacobian.cols()),
      parts_(parts.empty() ? std::vector<Eigen::Index>{0, problem.jacobian.rows()} : std::move(parts)),
      jacobian_(problem.jacobian),
      accepted_(part_count()),
      precision_(problem.prior_precision.size() > 0
                     ? problem.prior_precision
                     : Eigen::MatrixXd(Eigen::MatrixXd::Zero(base_parameters_, base_parameters_))) {
  use_single_threaded_blas();
  const Eigen::VectorXd mean = problem.prior_mean.size() > 0
                                   ? problem.prior_mean
                                   : Eigen::VectorXd(Eigen::VectorXd::Zero(base_parameters_));
  pull_ = precision_ * mean;
  prior_squares_ = mean.dot(pull_);
  set_local(problem);
  whiten_model(problem.residual);
  factorise();
}

void Projector::set_local(const NoiseProblem& problem) {
  if (!problem.local || problem.local->columns() == 0) return;
  std::vector<std::vector<std::size_t>> order;
  for (std::size_t part = 0; part < part_count(); ++part)
    order.push_back(whitener_->order_of_part(static_cast<std::size_t>(parts_[part]), part_rows(part)));
  local_product_ = std::make_shared<const LocalProduct>(problem.local, order);
}

/// The residual last. Of the model all columns, unless most of them vanish.
Projector::PartRows Projector::whitened_with(const Eigen::MatrixXd& residual, std::size_t part) const {
  const auto rows = jacobian_.middleRows(parts_[part], part_rows(part));
  PartRows model;
  for (Eigen::Index column = 0; column < base_parameters_; ++column) {
    if (!rows.col(column).isZero(0.0)) model.column.push_back(column);
  }
  if (2 * static_cast<Eigen::Index>(model.column.size()) >= base_parameters_) {
    model.column.resize(static_cast<std::size_t>(base_parameters_));
    std::iota(model.column.begin(), model.column.end(), Eigen::Index{0});
  }
  const auto count = static_cast<Eigen::Index>(model.column.size());
  model.rows.resize(residual.rows(), count + 1);
  const auto first = static_cast<std::size_t>(parts_[part]);
  if (count == base_parameters_) {
    whitener_->whiten_part(first, rows, model.rows.leftCols(count));
  } else {
    whitener_->whiten_part(first, rows(Eigen::all, model.column).eval(), model.rows.leftCols(count));
  }
  model.rows.rightCols(1) = residual;
  return model;
}

/// Upper triangle; the residual stands behind the model's columns.
void Projector::add_to_gram(const PartRows& part, const Eigen::MatrixXd& gram) {
  const auto count = static_cast<Eigen::Index>(part.column.size());
  if (count == base_parameters_) {
    gram_ += gram;
    return;
  }
  const auto place = [&](Eigen::Index k) {
    return k < count ? part.column[static_cast<std::size_t>(k)] : base_parameters_;
  };
  for (Eigen::Index k = 0; k <= count; ++k) {
    for (Eigen::Index i = 0; i <= k; ++i) gram_(place(i), place(k)) += gram(i, k);
  }
}

/// Without local columns and the residual, numbered among the others.
Projector::PartRows Projector::others_of(const PartRows& part) const {
  PartRows others;
  const auto local = std::ranges::lower_bound(part.column, local_columns());
  for (auto column = local; column != part.column.end(); ++column)
    others.column.push_back(*column - local_columns());
  others.rows = part.rows.middleCols(local - part.column.begin(), part.column.end() - local);
  return others;
}

/// Their products, and what of them is kept. Products are added up in the order of the parts.
void Projector::whiten_model(const Eigen::VectorXd& residual) {
  const Eigen::Index width = base_parameters_ + 1;
  std::vector<PartRows> others(part_count());
  std::vector<Eigen::MatrixXd> residuals(part_count()), products(parts_at_once(width * width, part_count()));
  gram_.setZero(width, width);
  for (std::size_t begin = 0; begin < part_count(); begin += products.size()) {
    const std::size_t count = std::min(products.size(), part_count() - begin);
    std::vector<PartRows> whitened(count);
    run_parallel(count, threads_, [&](std::size_t i) {
      const std::size_t part = begin + i;
      residuals[part] = whitened_part(part, residual);
      whitened[i] = whitened_with(residuals[part], part);
      const Eigen::MatrixXd& rows = whitened[i].rows;
      products[i].setZero(rows.cols(), rows.cols());
      add_gram_upper(rows, 1.0, products[i]);
      others[part] = others_of(whitened[i]);
      accepted_[part].resize(rows.rows(), 0);
    });
    for (std::size_t i = 0; i < count; ++i) add_to_gram(whitened[i], products[i]);
  }
  symmetrise_from_upper(gram_);
  residual_squares_ = gram_(base_parameters_, base_parameters_);
  others_ = std::make_shared<const std::vector<PartRows>>(std::move(others));
  residual_ = std::make_shared<const std::vector<Eigen::MatrixXd>>(std::move(residuals));
}

Projector Projector::with_residual(const Eigen::VectorXd& residual) const {
  Projector other = *this;
  other.replace_residual(residual);
  other.rotate_residual();
  return other;
}

/// And its products with the columns of the model and those that were accepted.
void Projector::replace_residual(const Eigen::VectorXd& residual) {
  const Eigen::Index count = parameters();
  std::vector<Eigen::MatrixXd> whitened(part_count());
  const Eigen::MatrixXd products = products_of(
      residual, [&](std::size_t part, Eigen::MatrixXd rows) { whitened[part] = std::move(rows); });
  residual_squares_ = 0.0;
  for (const Eigen::MatrixXd& rows : whitened) residual_squares_ += rows.squaredNorm();
  gram_.col(count).head(count) = products.col(0).head(count);
  gram_.row(count).head(count) = products.col(0).head(count).transpose();
  gram_(count, count) = residual_squares_;
  residual_ = std::make_shared<const std::vector<Eigen::MatrixXd>>(std::move(whitened));
}

/// Columns are scaled to unit diagonal of A first: they carry different units.
void Projector::factorise() {
  const Eigen::Index count = parameters();
  Eigen::MatrixXd normal = gram_.topLeftCorner(count, count);
  normal.topLeftCorner(base_parameters_, base_parameters_) += precision_;
  scale_ = normal.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  normal = scale_.asDiagonal() * normal * scale_.asDiagonal();
  auto lower = cholesky_lower(normal);
  is_regular_ = lower.has_value();
  if (!lower) {
    normal.diagonal().array() += 1e-12;  // what neither readings nor priors determine stays where it is
    lower = cholesky_lower(normal);
    if (!lower) throw std::runtime_error("the model's columns are not independent");
  }
  lower_ = std::move(*lower);
  rotate_residual();
}

void Projector::rotate_residual() {
  const Eigen::Index count = parameters();
  Eigen::MatrixXd right = gram_.col(count).head(count);
  right.col(0).head(base_parameters_) += pull_;
  right = scale_.asDiagonal() * right;
  solve_lower(lower_, right);
  rotated_ = right;
}

/// The factor once the last columns were accepted: [C 0; c D] with c = (C^-1 b)^T and D D^T what they are
/// apart from the model. False: nothing of them is, or the factor is none of A alone.
bool Projector::extend_factor(Eigen::Index more) {
  if (!is_regular_) return false;
  const Eigen::Index before = lower_.cols(), count = before + more;
  const Eigen::VectorXd scale =
      gram_.diagonal().segment(before, more).cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  Eigen::MatrixXd across = scale_.asDiagonal() * gram_.block(0, before, before, more) * scale.asDiagonal();
  solve_lower(lower_, across);
  Eigen::MatrixXd apart = scale.asDiagonal() * gram_.block(before, before, more, more) * scale.asDiagonal();
  add_gram_upper(across, -1.0, apart);
  symmetrise_from_upper(apart);
  const auto own = cholesky_lower(apart);
  if (!own) return false;
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(count, count);
  lower.topLeftCorner(before, before) = lower_;
  lower.bottomLeftCorner(more, before) = across.transpose();
  lower.bottomRightCorner(more, more) = *own;
  lower_ = std::move(lower);
  scale_.conservativeResize(count);
  scale_.tail(more) = scale;
  rotate_residual();
  return true;
}

Projector::PartialProducts Projector::zero_products(Eigen::Index columns) const {
  PartialProducts products;
  products.with_others.setZero(other_columns(), columns);
  products.with_residual.setZero(1, columns);
  products.with_accepted.setZero(accepted(), columns);
  if (local_product_) {
    for (Eigen::Index column = 0; column < columns; column += kColumnBlock)
      products.with_local.push_back(local_product_->zero_sums());
  }
  return products;
}

void Projector::add_products_with(const PartRows& others, const Eigen::MatrixXd& whitened,
                                  Eigen::MatrixXd& products) const {
  if (static_cast<Eigen::Index>(others.column.size()) == other_columns()) {
    add_transposed_product(others.rows, whitened, products);
    return;
  }
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(others.rows.cols(), whitened.cols());
  add_transposed_product(others.rows, whitened, own);
  products(others.column, Eigen::all) += own;
}

Eigen::MatrixXd Projector::add_products(std::size_t part, const Eigen::MatrixXd& rows,
                                        PartialProducts& products) const {
  const auto first = static_cast<std::size_t>(parts_[part]);
  const PartRows& others = (*others_)[part];
  Eigen::MatrixXd whitened;
  if (!local_product_) {
    whitened = whitener_->whiten_part(first, rows);
  } else {
    whitened.resize(others.rows.rows(), rows.cols());
    Eigen::MatrixXd weighed;
    for (Eigen::Index column = 0; column < rows.cols(); column += kColumnBlock) {
      const Eigen::Index count = std::min(kColumnBlock, rows.cols() - column);
      whitener_->weigh_part(first, rows.middleCols(column, count), whitened.middleCols(column, count),
                            weighed);
      local_product_->add(part, weighed,
                          products.with_local[static_cast<std::size_t>(column / kColumnBlock)]);
    }
  }
  if (!others.column.empty()) add_products_with(others, whitened, products.with_others);
  add_transposed_product((*residual_)[part], whitened, products.with_residual);
  if (accepted() > 0) add_transposed_product(accepted_[part], whitened, products.with_accepted);
  return whitened;
}

Eigen::MatrixXd Projector::combined(const PartialProducts& products, Eigen::Index columns) const {
  Eigen::MatrixXd all(parameters() + 1, columns);
  all.middleRows(local_columns(), other_columns()) = products.with_others;
  all.middleRows(base_parameters_, accepted()) = products.with_accepted;
  all.bottomRows(1) = products.with_residual;
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
    if (part_rows(part) == 0) continue;
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

Eigen::MatrixXd Projector::products_of(const Eigen::MatrixXd& columns,
                                       const std::function<void(std::size_t, Eigen::MatrixXd)>& visit) const {
  const Eigen::Index height = parameters() + 1;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(height, columns.cols());
  std::vector<Eigen::MatrixXd> products(parts_at_once(height * columns.cols(), part_count()));
  for (std::size_t begin = 0; begin < part_count(); begin += products.size()) {
    const std::size_t count = std::min(products.size(), part_count() - begin);
    run_parallel(count, threads_, [&](std::size_t i) {
      const std::size_t part = begin + i;
      PartialProducts partial = zero_products(columns.cols());
      visit(part, add_products(part, columns.middleRows(parts_[part], part_rows(part)), partial));
      products[i] = combined(partial, columns.cols());
    });
    for (std::size_t i = 0; i < count; ++i) sum += products[i];
  }
  return sum;
}

Eigen::MatrixXd Projector::imitation(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd rotated =
      scale_.asDiagonal() *
      products_of(columns, [](std::size_t, const Eigen::MatrixXd&) {}).topRows(parameters());
  solve_lower(lower_, rotated);
  return scale_.asDiagonal() * lower_.triangularView<Eigen::Lower>().transpose().solve(rotated).eval();
}

Eigen::MatrixXd Projector::whitened_part(std::size_t part, const Eigen::MatrixXd& columns) const {
  return whitener_->whiten_part(static_cast<std::size_t>(parts_[part]),
                                columns.middleRows(parts_[part], part_rows(part)));
}

void Projector::accept(const Eigen::MatrixXd& columns) {
  const Eigen::Index before = parameters(), more = columns.cols();
  if (more == 0) return;
  std::vector<Eigen::MatrixXd> added(part_count());
  const Eigen::MatrixXd products =
      products_of(columns, [&](std::size_t part, Eigen::MatrixXd rows) { added[part] = std::move(rows); });
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(more, more);
  for (std::size_t part = 0; part < part_count(); ++part) {
    add_gram_upper(added[part], 1.0, own);
    Eigen::MatrixXd& all = accepted_[part];
    all.conservativeResize(Eigen::NoChange, all.cols() + more);
    all.rightCols(more) = added[part];
  }
  const Eigen::Index count = before + more;
  Eigen::MatrixXd gram(count + 1, count + 1);
  gram.topLeftCorner(before, before) = gram_.topLeftCorner(before, before);
  gram.col(count).head(before) = gram_.col(before).head(before);
  gram(count, count) = gram_(before, before);
  gram.block(0, before, before, more) = products.topRows(before);
  gram.block(before, before, more, more) = own;
  gram.col(count).segment(before, more) = products.row(before).transpose();
  symmetrise_from_upper(gram);
  gram_ = std::move(gram);
  if (!extend_factor(more)) factorise();
}

Eigen::VectorXd Projector::solution() const {
  return scale_.cwiseProduct(lower_.triangularView<Eigen::Lower>().transpose().solve(rotated_));
}

Eigen::MatrixXd Projector::left_of_part(std::size_t part, const Eigen::MatrixXd& whitened,
                                        const Eigen::MatrixXd& at) const {
  const Eigen::MatrixXd imitated =
      jacobian_.middleRows(parts_[part], part_rows(part)) * at.topRows(base_parameters_);
  Eigen::MatrixXd left = whitened - whitener_->whiten_part(static_cast<std::size_t>(parts_[part]), imitated);
  if (accepted() > 0) left -= accepted_[part] * at.bottomRows(accepted());
  return left;
}

void Projector::put_in_place(std::size_t part, const Eigen::MatrixXd& rows, Eigen::MatrixXd& all) const {
  const auto order = whitener_->order_of_part(static_cast<std::size_t>(parts_[part]), part_rows(part));
  for (std::size_t i = 0; i < order.size(); ++i)
    all.row(static_cast<Eigen::Index>(order[i])) = rows.row(static_cast<Eigen::Index>(i));
}

Eigen::VectorXd Projector::weighed_residual() const {
  const Eigen::VectorXd at = solution();
  Eigen::MatrixXd whitened = Eigen::MatrixXd::Zero(parts_.back(), 1);
  run_parallel(part_count(), threads_, [&](std::size_t part) {
    put_in_place(part, left_of_part(part, (*residual_)[part], at), whitened);
  });
  return whitener_->whiten_transposed(whitened.col(0));
}

Eigen::MatrixXd Projector::weighed_projection(const Eigen::MatrixXd& columns) const {
  const Eigen::MatrixXd at = imitation(columns);
  Eigen::MatrixXd weighed = Eigen::MatrixXd::Zero(parts_.back(), columns.cols());
  run_parallel(part_count(), threads_, [&](std::size_t part) {
    put_in_place(part, left_of_part(part, whitened_part(part, columns), at), weighed);
  });
  for (Eigen::Index k = 0; k < weighed.cols(); ++k)
    weighed.col(k) = whitener_->whiten_transposed(weighed.col(k));
  return weighed;
}

Eigen::MatrixXd Projector::rotated_rows(const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd rotated = scale_.asDiagonal() * rows.transpose();
  solve_lower(lower_, rotated);
  return rotated;
}

Eigen::MatrixXd Projector::last_directions(Eigen::Index count) const {
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(parameters(), count);
  unit.bottomRows(count).setIdentity();
  return scale_.asDiagonal() * lower_.triangularView<Eigen::Lower>().transpose().solve(unit).eval();
}

Eigen::VectorXd Projector::prediction_variance(const Eigen::MatrixXd& rows) const {
  return rotated_rows(rows).colwise().squaredNorm();
}

Eigen::MatrixXd Projector::accepted_covariance() const {
  const Eigen::Index count = accepted();
  const Eigen::MatrixXd unit = lower_.bottomRightCorner(count, count)
                                   .triangularView<Eigen::Lower>()
                                   .solve(Eigen::MatrixXd::Identity(count, count));
  const Eigen::MatrixXd inverse = unit.transpose() * unit;
  const auto scale = scale_.tail(count).asDiagonal();
  return scale * inverse * scale;
}

double Projector::residual_squares() const {
  return residual_squares_ + prior_squares_ - rotated_.squaredNorm();
}

}  // namespace volcal

#include "volcal/model/observation/gradient_sums.h"

#include <algorithm>

namespace volcal {
namespace {

constexpr std::size_t kFunctionsOfFreeAxis = kAllComponents.size();

/// kCount: `count` if known.
template <std::size_t kCount>
void add_work_at(const std::uint32_t* position, int size, const double* const* work, std::size_t count,
                 double* sums) {
  if constexpr (kCount > 0) count = kCount;
  for (int i = 0; i < size;) {
    const std::uint32_t here = position[i];
    double sum[kFunctionsOfFreeAxis] = {};
    for (; i < size && position[i] == here; ++i) {
      for (std::size_t slot = 0; slot < count; ++slot) sum[slot] += work[slot][i];
    }
    for (std::size_t slot = 0; slot < count; ++slot) sums[here * count + slot] += sum[slot];
  }
}

}  // namespace

GradientSums::GradientSums(const MeasurementModel& model)
    : model_(&model), others_(Eigen::VectorXd::Zero(model.layout().size)) {
  std::size_t size = 0;
  for (std::size_t g = 0; g < model.layout().groups.size(); ++g) {
    gathered_begin_.push_back(size);
    size += model.tables().positions(g) * static_cast<std::size_t>(model.layout().groups[g].count());
  }
  gathered_.assign(size, 0.0);
}

void GradientSums::set_zero() {
  std::ranges::fill(gathered_, 0.0);
  others_.setZero();
}

void GradientSums::add(const GradientSums& other) {
  for (std::size_t i = 0; i < gathered_.size(); ++i) gathered_[i] += other.gathered_[i];
  others_ += other.others_;
}

void GradientSums::add_at_positions(std::size_t group, const std::uint32_t* position, int size,
                                    const double* const* work) {
  const auto count = static_cast<std::size_t>(model_->layout().groups[group].count());
  double* const sums = gathered_.data() + gathered_begin_[group];
  if (count == kFunctionsOfFreeAxis) {
    add_work_at<kFunctionsOfFreeAxis>(position, size, work, count, sums);
  } else {
    add_work_at<0>(position, size, work, count, sums);
  }
}

Eigen::VectorXd GradientSums::gradient() const {
  Eigen::VectorXd gradient = others_;
  const double* sums = gathered_.data();
  for (std::size_t g = 0; g < model_->layout().groups.size(); ++g) {
    const FunctionGroup& group = model_->layout().groups[g];
    const int support = group.basis->support(), count = group.count();
    for (std::size_t position = 0; position < model_->tables().positions(g); ++position, sums += count) {
      const double* const basis = model_->tables().values(g, support, position);
      double* const to = gradient.data() + group.index(model_->tables().start(g, position), 0);
      for (int j = 0; j < support; ++j) {
        for (int slot = 0; slot < count; ++slot) to[j * count + slot] += basis[j] * sums[slot];
      }
    }
  }
  return gradient;
}

}  // namespace volcal

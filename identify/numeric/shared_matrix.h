#pragma once
/// A matrix that its copies share: a model's columns, of which a campaign of 10^5 readings has hundreds of
/// megabytes, stand in several objects that differ in little else. Reads like any matrix; changing it is
/// said, and leaves the copies as they were.

#include <Eigen/Core>
#include <memory>
#include <new>
#include <utility>

namespace volcal {

class SharedMatrix : public Eigen::Map<const Eigen::MatrixXd> {
 public:
  using View = Eigen::Map<const Eigen::MatrixXd>;

  SharedMatrix() : SharedMatrix(Eigen::MatrixXd()) {}
  /// Takes the matrix, or copies it.
  explicit SharedMatrix(Eigen::MatrixXd matrix)
      : SharedMatrix(std::make_shared<Eigen::MatrixXd>(std::move(matrix))) {}
  SharedMatrix(const SharedMatrix& other) = default;
  ~SharedMatrix() = default;
  SharedMatrix& operator=(const SharedMatrix& other) {
    show(other.matrix_);
    return *this;
  }
  SharedMatrix& operator=(Eigen::MatrixXd matrix) {
    show(std::make_shared<Eigen::MatrixXd>(std::move(matrix)));
    return *this;
  }

  /// As a matrix that functions take without copying it.
  const Eigen::MatrixXd& whole() const { return *matrix_; }
  /// `change(matrix)`, on a copy where others share it.
  template <class Change>
  void edit(const Change& change) {
    auto own = matrix_.use_count() == 1 ? matrix_ : std::make_shared<Eigen::MatrixXd>(*matrix_);
    change(*own);
    show(std::move(own));
  }

 private:
  explicit SharedMatrix(std::shared_ptr<Eigen::MatrixXd> matrix)
      : View(matrix->data(), matrix->rows(), matrix->cols()), matrix_(std::move(matrix)) {}
  /// A view is led elsewhere by making it anew (Eigen, The Map class, Changing the mapped array).
  void show(std::shared_ptr<Eigen::MatrixXd> matrix) {
    matrix_ = std::move(matrix);
    new (static_cast<View*>(this)) View(matrix_->data(), matrix_->rows(), matrix_->cols());
  }

  std::shared_ptr<Eigen::MatrixXd> matrix_;
};

}  // namespace volcal

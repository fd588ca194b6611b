#pragma once
/// Products of the catalogue's columns with a model, kept: once further columns are taken into the model, the
/// scores of all effects follow from them without another projection.
///
/// With a~ the accepted columns and g~ those of a family after projection off the model before (projector.h),
/// and c = g~^T a~,
///
///   g'^T g' = g~^T g~ - c (a~^T a~)^-1 c^T,    g'^T r' = g~^T r~ - c (a~^T a~)^-1 a~^T r~
///
/// (Frisch and Waugh 1933, Econometrica 1, 387). c takes one product with g itself, not with the model:
/// g~^T a~ = g^T Sigma^-1 (a - J x), x the imitation of a. Equal to a projection anew but for rounding: in
/// units of |g_w|^2 and |g_w| |r_w| by some 1e-12 (tests/identify/criticism/catalogue/family_products_test).
/// Memory: a few numbers a column.

#include <memory>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"

namespace volcal {

/// Immutable and cheap to copy.
class FamilyProducts {
 public:
  /// Of all families at all their shapes, off the model of `projector`. The same for any number of threads.
  FamilyProducts(const LinearModel& model, const std::vector<Family>& families, const Projector& projector,
                 int threads);
  /// With families that stand behind those that are known.
  FamilyProducts with_more(const LinearModel& model, const std::vector<Family>& families,
                           const Projector& projector, int threads) const;
  /// Once `projector`, off whose model these are, accepts columns.
  FamilyProducts accepting(const Eigen::MatrixXd& columns, const LinearModel& model,
                           const std::vector<Family>& families, const Projector& projector,
                           int threads) const;

  /// Tests from the family `from` on, each at its best shape, in the order of families.
  std::vector<FamilyTest> tests(const std::vector<Family>& families, const Projector& projector, int threads,
                                std::size_t from = 0) const;

 private:
  /// Families that are projected together, and the columns of all their shapes.
  struct Block {
    std::vector<std::size_t> family;
    Eigen::Index columns = 0;
    std::shared_ptr<const ProjectedColumns> products;
  };

  FamilyProducts() = default;
  static std::vector<Block> blocks(const std::vector<Family>& families, std::size_t from);
  void add(std::vector<Block> more, const LinearModel& model, const std::vector<Family>& families,
           const Projector& projector, int threads);

  std::vector<Block> blocks_;
  std::size_t count_ = 0;  ///< of families
};

}  // namespace volcal

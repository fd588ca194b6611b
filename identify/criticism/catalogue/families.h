#pragma once
/// Named hypotheses: every effect of the catalogue that could act in a campaign, as columns of its readings.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/criticism/projection/linear_model.h"
#include "volcal/identify/criticism/projection/projector.h"
#include "volcal/identify/criticism/projection/score_statistics.h"

namespace volcal {

/// A candidate. `symbol` is set instead of an effect when the family is the resolution of an error function:
/// more of the function itself, a change of the model and no effect.
struct Family {
  EffectSpec spec;
  std::shared_ptr<const Effect> effect;
  std::optional<ErrorSymbol> resolution;
  std::vector<Eigen::VectorXd> scan;  ///< shapes to look at; one when the shape is known
  /// Of an error that the model leaves out: how many of the first amplitudes may stand alone, ascending, the
  /// last all of them. The shape of a test says how many do: those of the greatest gain.
  std::vector<Eigen::Index> orders = {};

  std::string label() const;
  EffectName name() const;
  Eigen::Index amplitudes() const;
  /// An error of the machine that the model holds at zero (left_out.h).
  bool is_left_out() const;
  /// The amplitudes act on different things (components of a displacement), so that each may be absent; the
  /// sine and cosine of a period are one thing.
  bool independent_components() const;
  /// Of each |amplitude|, SI, what a model file takes; empty: nothing is said.
  Eigen::VectorXd largest_amplitudes() const;
};

/// Without the model's own effects; with the errors that the model leaves out (left_out.h), and last `own`,
/// effects that the user thinks of. Throws InputError where one of these cannot act in the campaign.
std::vector<Family> families(const LinearModel& model, std::span<const EffectSpec> own = {});

/// The last of these alone.
std::vector<Family> own_families(const LinearModel& model, std::span<const EffectSpec> own);

/// Columns at one of the shapes.
Eigen::MatrixXd family_columns(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape);

/// Those of one setup's rows.
void family_columns(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape,
                    std::size_t setup, Eigen::Ref<Eigen::MatrixXd> out);
/// Adds their transpose times `rows` of that setup (LinearModel::add_products).
void add_family_products(const LinearModel& model, const Family& family, const Eigen::VectorXd& shape,
                         std::size_t setup, const Eigen::Ref<const Eigen::MatrixXd>& rows,
                         Eigen::Ref<Eigen::MatrixXd> sum);

/// A family at a shape.
struct Hypothesis {
  std::size_t family = 0;
  Eigen::VectorXd shape;
};
/// Columns of hypotheses side by side, each a group.
CandidateColumns columns_of(const LinearModel& model, const std::vector<Family>& families,
                            std::vector<Hypothesis> hypotheses);

/// The test of a family at its best shape.
struct FamilyTest {
  std::size_t family = 0;
  Eigen::VectorXd shape;
  ScoreTest score;
  double multiplicity = 1.0;  ///< of the shapes that were tried: by how much p grows
  double log10_p = 0.0;       ///< with the multiplicity, for this family alone
  double gain = 0.0;          ///< LM - dof ln n: what the extended BIC compares; scanned shapes count as dof,
                              ///< and of independent components only those that raise it
};

/// Of a family's columns at a shape, which begin at `first`. Nothing is visible where an amplitude comes out
/// larger than a model file takes, and of amplitudes that are one thing where one alone is not seen: a wave
/// without its sine has no phase. `largest`: of the family.
ScoreTest family_score(const Family& family, const ProjectedColumns& projected, Eigen::Index first,
                       const Eigen::VectorXd& largest);

/// What a family moves the readings by, at the shape and the amplitudes of its test; all observations, m or
/// rad.
Eigen::VectorXd displacement(const LinearModel& model, const Family& family, const FamilyTest& test);

/// Takes a test to a shape with its score; the multiplicity stays.
void update_test(FamilyTest& test, const Family& family, const Eigen::VectorXd& shape, const ScoreTest& score,
                 const Projector& projector);

/// Tests of all families, in their order, the same for any number of threads. Blocks of columns bound the
/// memory: 2 kB per observation and thread, and those of the widest scan.
std::vector<FamilyTest> test_families(const LinearModel& model, const std::vector<Family>& families,
                                      const Projector& projector, int threads);

}  // namespace volcal

#pragma once
/// The search for missing effects: the leading one of the catalogue is added while it stands out of the
/// noise, as well as that is known (noise_freedom.h: names and scans alike), and no generic test does
/// better; then every added one must stand against all others again. Several powers of one driver on one
/// target are no name, nor is what explains less than it leaves or what varies (amplitude_constancy.h): such
/// are left out again, or a rival that stands takes their place. Where nothing stands out, effects are looked
/// for that a wander has taken up, or that would stand out were the noise better known (joint_noise.h). A
/// search for one step climbs as well, so that what it names stands beside all the rest, and then keeps the
/// first.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "volcal/identify/criticism/catalogue/families.h"
#include "volcal/identify/criticism/scans/amplitude_constancy.h"
#include "volcal/identify/criticism/scans/generic_scan.h"
#include "volcal/identify/criticism/search/ladder.h"
#include "volcal/identify/noise/noise_estimate.h"

namespace volcal {

struct SearchOptions {
  int threads = 1;    ///< at least 1
  int most = 8;       ///< effects added
  bool climb = true;  ///< false: in the end one effect is kept
  std::vector<std::string> leave_out;
  std::function<void(const std::string& stage, double done)> progress;
};

/// An effect that is in the model.
struct AddedEffect {
  FamilyTest test;                 ///< against a model with the other effects
  Eigen::MatrixXd columns;         ///< of its amplitudes, then of its shape where that is smooth
  std::vector<FamilyTest> rivals;  ///< that the readings do not tell from it, best first
};

class EffectSearch {
 public:
  /// `heldout`: observations that judge and never choose. Readings that the fit removed are taken up into
  /// `model` when the model with the added effects explains them.
  EffectSearch(LinearModel& model, std::vector<bool> heldout, SearchOptions options);

  void run();

  const std::vector<Family>& families() const { return families_; }
  const std::vector<AddedEffect>& added() const { return added_; }
  /// At the model reached.
  const std::vector<FamilyTest>& tests() const { return tests_; }
  const std::vector<GenericTest>& generic() const { return generic_; }
  /// Those of `generic()` that are above the noise, as well as that is known.
  std::vector<const GenericTest*> outstanding_scans() const;
  /// At the given model.
  const std::vector<FamilyTest>& first_tests() const { return first_tests_; }
  const std::vector<GenericTest>& first_generic() const { return first_generic_; }
  const std::vector<ScanVariable>& variables() const { return variables_; }
  const std::vector<LadderStep>& ladder() const { return ladder_; }
  const Projector& projector() const { return *projector_; }
  const std::vector<NoiseParameters>& noise() const { return noise_; }
  /// With intervals, from all readings.
  NoiseEstimate noise_with_uncertainty() const;
  /// The model reached, from all readings: those that were held out have judged by now.
  std::unique_ptr<Projector> projector_of_all_readings() const;

  /// Effects found after the one that was kept.
  bool more_is_known() const { return more_is_known_; }
  /// Families that stood out and are no names, and why.
  const std::map<std::size_t, std::string>& given_up() const { return given_up_; }

  bool is_added(std::size_t family) const;
  double family_wise_log10_p(const FamilyTest& test) const;
  double family_wise_log10_p(const GenericTest& test) const;
  /// A test at its own level that is family-wise at the risk.
  double log10_level() const;

 private:
  /// Of the model without any effect.
  struct FirstNoise {
    NoiseEstimate estimate;
    std::vector<SmoothingTerm> smoothing;
  };

  void start();
  void find_noise();
  std::unique_ptr<Projector> projector_without(const std::set<std::size_t>& left_out) const;
  std::unique_ptr<Projector> projector_of(const NoiseData& data, const std::vector<NoiseParameters>& noise,
                                          const std::set<std::size_t>& left_out = {}) const;
  NoiseProblem problem_with_added() const;
  NoiseOptions noise_options() const;
  void test();
  std::vector<FamilyTest> refined_tests(const Projector& projector) const;
  void climb();
  void find_outstanding();
  std::vector<std::size_t> families_above() const;
  std::vector<std::size_t> doubtful_scans() const;
  const FamilyTest* outstanding() const;
  bool something_stands_out() const;
  bool add_leading();
  bool add_several();
  const FamilyTest* best_by_the_variables_of_a_scan() const;
  std::vector<FamilyTest> added_tests() const;
  bool explain_together(std::size_t first) const;
  std::vector<FamilyTest> absorbed_by_drift(const NoiseProblem& problem) const;
  std::vector<FamilyTest> above_doubtful_noise() const;
  bool add_hidden_in_noise();
  /// What a scan has seen at another noise.
  struct ScanBesideNoise {
    std::size_t scan;  ///< of `generic_`
    GenericTest test;
    Eigen::VectorXd moved;
  };
  std::vector<ScanBesideNoise> scans_absorbed_by_drift(const NoiseProblem& problem) const;
  void find_scans_hidden_in_noise();
  void add(const FamilyTest& test);
  bool refine_shape_of_last();
  Eigen::MatrixXd accept(const FamilyTest& test, Projector& projector) const;
  std::size_t reinstate_outliers();
  void add_step(const std::string& added);
  void restate_ladder();
  void settle(const std::function<void()>& after_a_change);
  bool reconsider(bool may_change);
  bool still_moves(const std::vector<std::string>& drivers) const;
  bool leaves_more(const AddedEffect& effect) const;
  std::string rejection_reason(std::size_t added) const;
  bool lies_beyond_its_scan(std::size_t added) const;
  Eigen::Index first_column(std::size_t added) const;
  ConstancyTest constancy_of(const Family& family, const Eigen::MatrixXd& columns, Eigen::Index first,
                             const Projector& projector) const;
  double constancy_of_rival(std::size_t added, const FamilyTest& rival) const;
  void find_no_names();
  void drop_inconsistent_rivals();
  const FamilyTest* standing_rival(std::size_t added) const;
  void reject();
  void recheck(const std::set<std::size_t>& stood);
  void keep(const std::vector<FamilyTest>& tests);
  void keep_one_step();
  void add_again(const std::vector<FamilyTest>& tests);
  bool may_be_added(const FamilyTest& test) const;
  /// Stands out of noise that is taken as known.
  bool is_above(const FamilyTest& test) const;
  const FamilyTest* leading(const std::vector<FamilyTest>& tests, std::size_t but) const;
  bool generic_does_better(const FamilyTest& best) const;
  struct Evidence {
    double gain = 0.0;
    double log10_p = 0.0;  ///< family-wise
  };
  bool does_better(const GenericTest& scan, const Evidence& names, double more_gain, double share) const;
  bool scans_are_silent() const;

  LinearModel& model_;
  std::vector<bool> heldout_;
  SearchOptions options_;
  std::vector<Family> families_;
  std::vector<ScanVariable> variables_;
  std::vector<ScanVariable> constancy_variables_;
  std::optional<NoiseEstimate> noise_estimate_;
  std::optional<FirstNoise> first_noise_;
  std::vector<NoiseParameters> noise_;
  std::unique_ptr<Projector> projector_;
  std::vector<FamilyTest> tests_;
  std::vector<std::size_t> outstanding_;  ///< of `tests_`: above the noise, best first
  std::vector<FamilyTest> first_tests_;
  std::vector<GenericTest> generic_;
  std::vector<bool> scan_stands_out_;  ///< of `generic_`: above the noise, as well as that is known
  std::vector<GenericTest> first_generic_;
  std::vector<AddedEffect> added_;
  std::map<std::size_t, std::string> given_up_;     ///< no names; reason
  std::set<std::size_t> dropped_;                   ///< not significant beside the others
  std::set<std::set<std::size_t>> tried_together_;  ///< added when several more were tried in vain
  bool more_is_known_ = false;
  std::vector<LadderStep> ladder_;
  std::vector<std::vector<SmoothingTerm>> smoothing_of_steps_;
  std::optional<double> heldout_loglik_;
  double log10_families_ = 0.0;
  double log10_generic_ = 0.0;
};

}  // namespace volcal

#pragma once
/// All tests of one model state, and which of them exceed the noise.
///
/// In: a model state. Out: score tests of every effect of the catalogue, the scans without a catalogue, and
/// which exceed their family-wise risk (thresholds.h), by chi-squared and by F with the degrees of freedom of
/// the noise (noise_freedom.h; Satterthwaite 1946, Biometrics Bull. 2, 110). SI; probabilities in log10.
/// Valid at the noise of the state. The same for any number of threads.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "volcal/identify/criticism/catalogue/family_products.h"
#include "volcal/identify/criticism/data/search_rules.h"
#include "volcal/identify/criticism/scans/generic_scan.h"
#include "volcal/identify/criticism/scans/scan_variables.h"

namespace volcal {

class ModelState;

/// What is the same for all states of a search.
struct SearchSetting {
  /// `heldout`: observations that judge and never choose; `leave_out`: kinds that are not looked for; `own`:
  /// effects that the user thinks of, tested beside the catalogue.
  SearchSetting(const LinearModel& model, std::vector<bool> heldout,
                const std::vector<std::string>& leave_out, int threads, std::span<const EffectSpec> own = {});
  /// The same with more effects that the user thinks of, behind the others.
  SearchSetting with_more(const LinearModel& model, std::span<const EffectSpec> more) const;

  std::vector<Family> families;
  std::vector<ScanVariable> variables;            ///< of the scans
  std::vector<ScanVariable> constancy_variables;  ///< and the travel since turning (amplitude_constancy.h)
  std::vector<bool> heldout;
  std::size_t own;              ///< number of effects that the user thinks of
  int threads;                  ///< at least 1
  double log10_families = 0.0;  ///< log10 of the number of families
  SearchRules rules;            ///< all, but for a study

  double family_wise_log10_p(const FamilyTest& test) const;
  /// A test at its own level that is family-wise at the risk.
  double log10_level() const;
  /// Exceeds noise that is taken as known.
  bool exceeds(const FamilyTest& test) const;
  /// Noncentrality of the smallest effect that such a test finds with the power of the thresholds.
  double detectable_noncentrality(int dof) const;

 private:
  void set_level();

  std::vector<double> detectable_;  ///< by dof, from 1
};

struct ModelTests {
  std::vector<FamilyTest> families;    ///< in the order of the setting's
  std::vector<GenericTest> scans;      ///< polynomials, kernels, waves
  std::vector<std::size_t> exceeding;  ///< of `families`, best first, as well as the noise is known
  std::vector<bool> scan_exceeds;      ///< of `scans`, as well as the noise is known

  double log10_scans() const;
  double family_wise_log10_p(const GenericTest& scan) const;
  std::vector<const GenericTest*> exceeding_scans() const;
  bool any_scan_exceeds() const;
};

ModelTests tests_of(const ModelState& state);
/// With tests of the families that were made of the state before.
ModelTests tests_of(const ModelState& state, std::vector<FamilyTest> families);

/// Tests of the families alone, shapes refined where they could matter.
std::vector<FamilyTest> refined_tests(const SearchSetting& setting, const LinearModel& model,
                                      const Projector& projector);

/// The same with the products that they were made of, from which those of a further effect follow.
struct CatalogueTests {
  FamilyProducts products;
  std::vector<FamilyTest> families;

  explicit CatalogueTests(const ModelState& state);
  CatalogueTests(FamilyProducts of, const ModelState& state);
  /// Of a state to which an effect was added at the same noise and smoothing; `before` is that without it.
  CatalogueTests of_next(const ModelState& before, const ModelState& next) const;
  /// Of a state with more effects of the user's own: those that were known stay as they are.
  CatalogueTests with_more(const ModelState& with_them) const;
};

}  // namespace volcal

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

#include "volcal/identify/criticism/catalogue/families.h"
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

  std::vector<Family> families;
  std::vector<ScanVariable> variables;            ///< of the scans
  std::vector<ScanVariable> constancy_variables;  ///< and the travel since turning (amplitude_constancy.h)
  std::vector<bool> heldout;
  std::size_t own;        ///< number of effects that the user thinks of
  int threads;            ///< at least 1
  double log10_families;  ///< log10 of the number of families

  double family_wise_log10_p(const FamilyTest& test) const;
  /// A test at its own level that is family-wise at the risk.
  double log10_level() const;
  /// Exceeds noise that is taken as known.
  bool exceeds(const FamilyTest& test) const;
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
/// The same where tests of a setting without the last effects of the user's are known, `known` their number.
std::vector<FamilyTest> with_tests_of_own(std::vector<FamilyTest> known, std::span<const EffectSpec> own,
                                          const SearchSetting& setting, const LinearModel& model,
                                          const Projector& projector);

}  // namespace volcal

/// Thousands of damaged files, the same ones on every run: each ends in success or in an InputError. Run
/// under the sanitizers as well; tests/fuzz does the same without end.

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <random>
#include <string>

#include "tests/support/hand_made_diagnosis.h"
#include "tests/support/reader_harness.h"
#include "tests/support/table_samples.h"
#include "volcal/identify/result/result.h"

namespace volcal {
namespace {

constexpr std::array<std::string_view, 40> kTokens = {"nan",
                                                      "-inf",
                                                      "1e999",
                                                      "-1e-320",
                                                      "0",
                                                      "-1",
                                                      "1e308",
                                                      "9223372036854775807",
                                                      "[",
                                                      "]",
                                                      "{",
                                                      "}",
                                                      "[[",
                                                      "]]",
                                                      "\"",
                                                      "\"\"\"",
                                                      "'",
                                                      "=",
                                                      ",",
                                                      ";",
                                                      "\n",
                                                      "\r\n",
                                                      "\t",
                                                      "#",
                                                      "\xEF\xBB\xBF",
                                                      "\xFF\xFE",
                                                      "\xC3\x28",
                                                      ".",
                                                      "true",
                                                      "1979-05-27",
                                                      "auto",
                                                      "zero",
                                                      "\\u0000",
                                                      "_mm",
                                                      "_um",
                                                      "x_mm",
                                                      "0x7F",
                                                      "1_000",
                                                      "+",
                                                      "null"};

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string mutate(std::string text) {
    const std::size_t count = 1 + below(3);
    for (std::size_t i = 0; i < count; ++i) mutate_once(text);
    return text;
  }
  std::size_t below(std::size_t bound) { return bound == 0 ? 0 : random_() % bound; }

 private:
  void mutate_once(std::string& text) {
    const std::size_t at = below(text.size());
    const std::string_view token = kTokens[below(kTokens.size())];
    switch (below(8)) {
      case 0:
        if (!text.empty()) text[at] = static_cast<char>(random_());
        return;
      case 1:
        text.erase(at, 1 + below(8));
        return;
      case 2:
        text.insert(at, token);
        return;
      case 3:
        text.insert(at, text.substr(below(text.size()), below(60)));
        return;
      case 4:
        text.resize(at);
        return;
      case 5:
        replace_number(text, at, token);
        return;
      case 6:
        drop_line(text, at);
        return;
      default:
        text.replace(at, std::min(token.size(), text.size() - at), token);
        return;
    }
  }

  static void replace_number(std::string& text, std::size_t at, std::string_view token) {
    const auto first = text.find_first_of("0123456789", at);
    if (first == std::string::npos) return;
    const auto last = text.find_first_not_of("0123456789.", first);
    text.replace(first, (last == std::string::npos ? text.size() : last) - first, token);
  }

  static void drop_line(std::string& text, std::size_t at) {
    const auto first = text.rfind('\n', at);
    const auto last = text.find('\n', at);
    if (first != std::string::npos && last != std::string::npos && last > first)
      text.erase(first, last - first);
  }

  std::mt19937_64 random_;
};

/// Returns how many of the mutants were accepted.
int try_mutants(const std::string& good, int count, const std::function<bool(const std::string&)>& accepts) {
  EXPECT_TRUE(accepts(good)) << "the sample itself is refused:\n" << good;
  Mutator mutator(20160229);
  int accepted = 0;
  for (int i = 0; i < count; ++i) {
    const std::string mutant = mutator.mutate(good);
    try {
      if (accepts(mutant)) ++accepted;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "mutant " << i << ": " << error.what() << "\n" << mutant;
    }
  }
  return accepted;
}

/// Some mutants are good files still, most are not.
void expect_some_accepted(const std::string& good, bool (*accepts)(const std::string&),
                          int fewer_than = 2000) {
  const int accepted = try_mutants(good, 3000, accepts);
  EXPECT_GT(accepted, 30);
  EXPECT_LT(accepted, fewer_than);
}

TEST(Mutation, Machine) { expect_some_accepted(testing::sample_machine(), testing::accepts_machine); }
TEST(Mutation, Model) { expect_some_accepted(testing::sample_model(), testing::accepts_model); }
TEST(Mutation, Campaign) { expect_some_accepted(testing::sample_campaign(), testing::accepts_campaign); }
TEST(Mutation, Study) { expect_some_accepted(testing::sample_study(), testing::accepts_study); }
TEST(Mutation, PositionsOfARun) {
  expect_some_accepted(testing::sample_points(), testing::accepts_points, 2500);
}

TEST(Mutation, Diagnosis) {
  const std::string good = diagnosis_json(testing::hand_made_diagnosis());
  EXPECT_GT(try_mutants(good, 3000, testing::accepts_diagnosis), 30);
}

TEST(Mutation, ReadingsOfEveryInstrument) {
  const auto all = instruments();
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (std::size_t set = 0; set < all[i]->schema().column_sets.size(); ++set) {
      const auto columns = all[i]->schema().file_columns(set);
      const auto accepts = [&](const std::string& text) { return testing::accepts_readings(text, i, {}); };
      const int accepted = try_mutants(testing::sample_csv(columns), 1000, accepts);
      EXPECT_LT(accepted, 900) << all[i]->schema().name;
    }
  }
}

TEST(Mutation, TablesOfEveryFormat) {
  const auto formats = table_formats();
  for (std::size_t i = 0; i < formats.size(); ++i) {
    const auto accepts = [&](const std::string& text) { return testing::accepts_tables(text, i); };
    const std::string good = testing::packed_files(testing::sample_tables(*formats[i]));
    const int accepted = try_mutants(good, 2000, accepts);
    EXPECT_GT(accepted, 10) << formats[i]->name;
    EXPECT_LT(accepted, 1900) << formats[i]->name;
  }
}

TEST(Mutation, Result) {
  FitResult result;
  result.machine = testing::harness_machine();
  result.identified = parse_model(testing::sample_model(), "model.toml", result.machine);
  ParameterBlock block;
  block.kind = ParameterKind::Location;
  block.name = "EC0Y";
  block.labels = block.units = {""};
  block.si_per_unit = {1e-6};
  block.location = LocationSymbol::parse("EC0Y");
  block.guess = block.prior_mean = block.prior_sigma = Eigen::VectorXd::Zero(1);
  result.layout.blocks = {block};
  result.layout.size = 1;
  result.parameters = Eigen::VectorXd::Constant(1, 12.5e-6);
  result.covariance = Eigen::MatrixXd::Constant(1, 1, 1e-12);
  result.setups.push_back(
      {.name = "S1", .instrument = "laser-tracer", .tool = "long", .reading_unit = "um", .fingerprint = {}});
  result.findings = {verbatim("a message")};
  const int accepted = try_mutants(result_json(result), 3000, testing::accepts_result);
  EXPECT_GT(accepted, 30);
}

}  // namespace
}  // namespace volcal

#include "volcal/identify/words/sentences.h"

#include <array>
#include <stdexcept>

#include "volcal/identify/words/sentence_lists.h"
#include "volcal/model/description/finding_codes.h"

namespace volcal {
namespace {

using Makers = std::array<decltype(SentenceMaker::make), static_cast<std::size_t>(FindingCode::End)>;

std::string verbatim_sentence(const Finding& finding) { return finding.text("text"); }

Makers makers_by_code() {
  Makers makers = {};
  for (const SentenceMaker& maker : sentence_makers())
    makers.at(static_cast<std::size_t>(maker.code)) = maker.make;
  return makers;
}

}  // namespace

std::vector<SentenceMaker> sentence_makers() {
  std::vector<SentenceMaker> all = {{FindingCode::Verbatim, verbatim_sentence}};
  for (const auto& room :
       {campaign_sentences(), noise_sentences(), rank_sentences(), fit_sentences(), criticism_sentences(),
        measurement_sentences(), standards_sentences(), error_sentences()}) {
    all.insert(all.end(), room.begin(), room.end());
  }
  return all;
}

std::string sentence(const Finding& finding) {
  static const Makers makers = makers_by_code();
  const auto make = makers.at(static_cast<std::size_t>(finding.code));
  if (make == nullptr)
    throw std::logic_error("no sentence for the finding " + std::string(to_string(finding.code)));
  return make(finding);
}

std::vector<std::string> sentences(const std::vector<Finding>& findings) {
  std::vector<std::string> all;
  for (const Finding& finding : findings) all.push_back(sentence(finding));
  return all;
}

std::string list_in_words(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " and " : ", ";
    text += words[i];
  }
  return text;
}

}  // namespace volcal

#pragma once
/// The sentences of the rooms, joined in sentences.cpp.

#include <span>
#include <string>

#include "volcal/identify/words/sentences.h"

namespace volcal {

std::span<const SentenceMaker> campaign_sentences();
std::span<const SentenceMaker> fit_sentences();
std::span<const SentenceMaker> noise_sentences();
std::span<const SentenceMaker> rank_sentences();
std::span<const SentenceMaker> criticism_sentences();
std::span<const SentenceMaker> measurement_sentences();
std::span<const SentenceMaker> standards_sentences();
std::span<const SentenceMaker> error_sentences();

/// " at T_column = 20 degC, T_air = 23.1 degC": under which conditions a difference of predictions is so
/// large; empty where it depends on none.
std::string at_conditions(const Finding& finding);

}  // namespace volcal

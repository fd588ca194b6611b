#pragma once
/// The sentences of the rooms, joined in sentences.cpp.

#include <span>

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

}  // namespace volcal

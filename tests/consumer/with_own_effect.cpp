// What a program does that knows a physics of its own: an effect is registered, and fitted like any other.

#include <cmath>
#include <cstdlib>
#include <exception>
#include <iostream>

#include "own_effect.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/campaign/model_reader.h"
#include "volcal/identify/solve/fit.h"
#include "volcal/model/effects/registry.h"

int main(int count, char** arguments) {
  if (count != 3) {
    std::cerr << "usage: with_own_effect CAMPAIGN MODEL\n";
    return EXIT_FAILURE;
  }
  try {
    volcal::register_effect(play_effect());
    const volcal::Campaign campaign = volcal::read_campaign(arguments[1]);
    const volcal::ModelSpec model = volcal::read_model(arguments[2], campaign.machine);
    const volcal::FitResult result = volcal::fit(campaign, model, {});

    const volcal::ParameterBlock& play = *result.layout.find_block("play EXX");
    const double value = result.parameters[play.offset] * 1e6;
    const double u = std::sqrt(result.covariance(play.offset, play.offset)) * 1e6;
    std::cout << "play EXX " << value << " um, u " << u << " um\n";
    const bool found = std::abs(value) > 10.0 * u;
    std::cout << (found ? "with_own_effect: the effect was found\n"
                        : "with_own_effect: the effect was not found\n");
    return found ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}

// What a program of a third party does with the installed library: from a campaign to error tables.

#include <cstdlib>
#include <exception>
#include <iostream>

#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/io/results/result_folder.h"
#include "volcal/identify/solve/evaluate.h"
#include "volcal/identify/solve/fit.h"

int main(int count, char** arguments) {
  if (count != 4) {
    std::cerr << "usage: consumer CAMPAIGN OTHER_CAMPAIGN RESULT\n";
    return EXIT_FAILURE;
  }
  try {
    const volcal::Campaign campaign = volcal::read_campaign(arguments[1]);
    volcal::FitOptions options;
    options.noise = volcal::NoisePolicy::White;
    const volcal::FitResult result = volcal::fit(campaign, volcal::ModelSpec{}, options);
    volcal::write_result_folder(result, campaign, arguments[3]);

    const volcal::Campaign unseen = volcal::read_campaign(arguments[2]);
    const volcal::ValidationFigures figures = volcal::validate(unseen, result).figures;
    std::cout << campaign.reading_count() << " readings, status " << to_string(result.status)
              << "; RMS before " << figures.rms_before * 1e6 << " um, after " << figures.rms_after * 1e6
              << " um\n";
    const bool better = figures.rms_after < 0.05 * figures.rms_before;
    std::cout << (better ? "consumer: volcal works\n" : "consumer: the errors were not found\n");
    return better ? EXIT_SUCCESS : EXIT_FAILURE;
  } catch (const std::exception& error) {  // bad input: file, line, problem and remedy
    std::cerr << "error: " << error.what() << "\n";
    return EXIT_FAILURE;
  }
}

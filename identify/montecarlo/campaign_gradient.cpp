#include "volcal/identify/montecarlo/campaign_gradient.h"

namespace volcal {

CampaignGradient::CampaignGradient(const MeasurementModel& model, const Whitener& whitener)
    : model_(model), whitener_(whitener) {}

CampaignGradient::Workspace::Workspace(const CampaignGradient& gradient)
    : levers(gradient.model_.make_levers()),
      blocks(gradient.model_.blocks().size()),
      sums(gradient.model_.model()) {}

Eigen::VectorXd CampaignGradient::at(const Eigen::VectorXd& parameters, const Eigen::VectorXd& readings,
                                     Workspace& work) const {
  const TabulatedFunctions tabulated = model_.model().tabulate(parameters);
  work.errors.resize(readings.size());
  Eigen::Index observation = 0;
  for (std::size_t b = 0; b < work.blocks.size(); ++b) {
    const ReadingBlock& block = model_.blocks()[b];
    model_.linearize(block, parameters, tabulated, work.levers, work.blocks[b]);
    const LinearizationLanes& reading = work.blocks[b].reading;
    for (int i = 0; i < block.size; ++i) {
      for (int channel = 0; channel < reading.channels(); ++channel, ++observation)
        work.errors[observation] = reading.predicted(channel)[i] - readings[observation];
    }
  }
  work.errors = whitener_.weigh(work.errors);
  work.sums.set_zero();
  observation = 0;
  for (std::size_t b = 0; b < work.blocks.size(); ++b) {
    const ReadingBlock& block = model_.blocks()[b];
    const int channels = work.blocks[b].reading.channels();
    Lanes error[kMaxChannels] = {};
    for (int i = 0; i < block.size; ++i) {
      for (int channel = 0; channel < channels; ++channel, ++observation)
        error[channel][i] = work.errors[observation];
    }
    model_.find_levers(block, parameters, work.levers);
    model_.add_work(block, work.blocks[b], error, work.levers, work.sums);
  }
  return work.sums.gradient();
}

}  // namespace volcal

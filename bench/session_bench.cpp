// Processor time of what a person does with a session, all threads together: what a machine that others use
// can tell, where times on the wall cannot. And the most memory that the process had until each step was made
// first.
//
//   session_bench CAMPAIGN.toml [--threads N] [--repeats N]

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "measure.h"
#include "volcal/identify/io/campaign/campaign_reader.h"
#include "volcal/identify/numeric/dense.h"
#include "volcal/identify/session/session.h"

namespace volcal::bench {
namespace {

struct SessionArguments {
  std::string campaign;
  int threads = 2;
  int repeats = 9;
};

SessionArguments parse_session(int count, char** values) {
  SessionArguments arguments;
  if (count < 2) throw std::invalid_argument("give a campaign file");
  arguments.campaign = values[1];
  read_options(count, values, 2,
               {{"--threads", into(arguments.threads)}, {"--repeats", into(arguments.repeats)}});
  return arguments;
}

class ProcessorTimes {
 public:
  template <class Work>
  void measure(const std::string& what, const Work& work) {
    const auto wall = std::chrono::steady_clock::now();
    const double begin = processor_seconds();
    work();
    if (!times_.contains(what)) order_.push_back(what);
    Times& times = times_[what];
    if (times.processor.empty()) times.peak = peak_memory();
    times.processor.push_back(1e3 * (processor_seconds() - begin));
    times.wall.push_back(1e3 *
                         std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count());
  }
  void print() {
    fmt::print("  {:28} {:>16} {:>9} {:>9} {:>12} {:>10} {:>3}\n", "", "processor [ms]", "least", "most",
               "wall [ms]", "peak [MB]", "n");
    for (const std::string& what : order_) {
      Times& times = times_[what];
      std::ranges::sort(times.processor);
      std::ranges::sort(times.wall);
      const std::size_t middle = times.processor.size() / 2;
      fmt::print("  {:28} {:16.1f} {:9.1f} {:9.1f} {:12.1f} {:10.0f} {:3}\n", what, times.processor[middle],
                 times.processor.front(), times.processor.back(), times.wall[middle],
                 1e-6 * static_cast<double>(times.peak), times.processor.size());
    }
  }

 private:
  struct Times {
    std::vector<double> processor, wall;  ///< ms
    std::size_t peak = 0;                 ///< bytes, when it was made first
  };
  std::vector<std::string> order_;
  std::map<std::string, Times> times_;
};

/// The first effects of the ranking that can be added.
std::vector<EffectName> leading_effects(Session& session) {
  constexpr std::size_t kLeading = 3;
  std::vector<EffectName> names;
  for (const EffectFinding& each : session.rank()) {
    if (!each.spec.kind.empty() && names.size() < kLeading) names.push_back(each.name);
  }
  if (names.empty()) throw std::runtime_error("nothing can be added to this campaign's model");
  return names;
}

void measure_session(const SessionArguments& arguments) {
  use_single_threaded_blas();
  Campaign campaign = read_campaign(arguments.campaign);
  ProcessorTimes times;
  std::unique_ptr<Session> session;
  times.measure("load", [&] {
    session = std::make_unique<Session>(std::move(campaign), ModelSpec{},
                                        SessionOptions{.threads = arguments.threads, .progress = {}});
  });
  times.measure("first ranking", [&] { session->rank(); });
  const std::vector<EffectName> names = leading_effects(*session);
  for (int k = 0; k < arguments.repeats; ++k) {
    const auto of = [&](int which) { return names[static_cast<std::size_t>(which) % names.size()]; };
    session->go_to(0);
    times.measure("an added effect", [&] { session->add(of(k)); });
    times.measure("the ranking behind it", [&] { session->rank(); });
    times.measure("a refit", [&] { session->take(session->refit()); });
    times.measure("the ranking behind a refit", [&] { session->rank(); });
    session->go_to(0);
    times.measure("preparing refits", [&] { session->take(session->preparation()); });
    session->add(names.front());
    times.measure("a prepared refit", [&] { session->take(session->refit()); });
    times.measure("the ranking behind that", [&] { session->rank(); });
    if (names.size() < 2) continue;
    times.measure("an effect added to a refit", [&] { session->add(names[1]); });
    times.measure("the ranking behind two", [&] { session->rank(); });
  }
  fmt::print("{} readings, {} threads\n", session->linear().size(), arguments.threads);
  times.print();
  fmt::print("  peak memory {:.0f} MB\n", 1e-6 * static_cast<double>(peak_memory()));
}

}  // namespace
}  // namespace volcal::bench

int main(int count, char** values) {
  return volcal::bench::run_program(
      "session_bench", [&] { volcal::bench::measure_session(volcal::bench::parse_session(count, values)); });
}

#include "volcal/identify/session/session_work.h"

#include <utility>

#include "volcal/identify/numeric/interruption.h"

namespace volcal {

void report_stage(const SessionProgress& progress, const std::string& stage, double done) {
  if (progress && !progress(stage, done)) throw SessionStopped("stopped at: " + stage);
}

SessionWork interruptible(SessionWork work) {
  return [work = std::move(work)](const SessionProgress& progress) {
    if (!progress) return work(progress);
    std::string stage = "begin";
    double share = 0.0;
    const SessionProgress followed = [&](const std::string& now, double done) {
      stage = now;
      share = done;
      return progress(now, done);
    };
    const Interruption guard([&] { report_stage(progress, stage, share); });
    return work(followed);
  };
}

}  // namespace volcal

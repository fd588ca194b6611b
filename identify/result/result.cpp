#include "volcal/identify/result/result.h"

namespace volcal {

std::string_view to_string(FitStatus status) {
  switch (status) {
    case FitStatus::Ok:
      return "ok";
    case FitStatus::LackOfFit:
      return "lack_of_fit";
    case FitStatus::RankDeficient:
      return "rank_deficient";
    case FitStatus::NotConverged:
      return "not_converged";
  }
  return "";
}

}  // namespace volcal

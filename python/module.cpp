#include <glog/logging.h>

#include "volcal/python/shared/bindings.h"

PYBIND11_MODULE(_volcal, module) {
  using namespace volcal::python;
  FLAGS_minloglevel = google::GLOG_FATAL;  // what Ceres warns of, the status of the result says
  module.attr("__name__") = "volcal";      // where its classes are found
  module.attr("__version__") = VOLCAL_VERSION;
  define_errors(module);
  define_findings(module);
  define_machine(module);
  define_model(module);
  define_campaign(module);
  define_effects(module);
  define_result(module);
  define_tables(module);
  define_fit(module);
  define_diagnosis(module);
  define_montecarlo(module);
  define_compensation(module);
  define_plan(module);
  define_session(module);
  define_alignment(module);
  define_budget(module);
  define_comparison(module);
  define_trial(module);
}

#include "volcal/python/shared/long_work.h"

#include <dlfcn.h>

#include <algorithm>
#include <memory>

namespace volcal::python {
namespace {

using GetThreads = int (*)();
using SetThreads = void (*)(int);

/// Of OpenBLAS; another BLAS has none.
template <class Function>
Function blas_function(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

/// Changed with the interpreter's lock held.
struct BlasUse {
  int works = 0;  ///< of several Python threads at a time
  int threads_before = 1;
};

BlasUse& blas_use() {
  static BlasUse use;
  return use;
}

void set_blas_threads(int threads) {
  static const auto set_threads = blas_function<SetThreads>("openblas_set_num_threads");
  if (set_threads != nullptr) set_threads(threads);
}

}  // namespace

BlasOnOneThread::BlasOnOneThread() {
  static const auto get_threads = blas_function<GetThreads>("openblas_get_num_threads");
  if (blas_use().works++ > 0 || get_threads == nullptr) return;
  blas_use().threads_before = get_threads();
  set_blas_threads(1);
}

BlasOnOneThread::~BlasOnOneThread() {
  if (--blas_use().works == 0) set_blas_threads(blas_use().threads_before);
}

std::function<void(const std::string& stage, double done)> progress_to(const py::handle& callback) {
  return [callback, furthest = std::make_shared<double>(0.0)](const std::string& stage, double done) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    *furthest = std::max(*furthest, done);
    if (!callback.is_none()) callback(stage, *furthest);
  };
}

}  // namespace volcal::python

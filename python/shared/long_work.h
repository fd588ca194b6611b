#pragma once
/// Work of the library from Python: without the interpreter's lock, with progress, ended by Ctrl-C.

#include <functional>
#include <string>

#include "volcal/python/shared/bindings.h"

namespace volcal::python {

/// Holds BLAS to one thread while volcal works, as its results ask for; numpy shares it, and has its threads
/// back afterwards. Made and ended with the interpreter's lock held.
class BlasOnOneThread {
 public:
  BlasOnOneThread();
  ~BlasOnOneThread();
  BlasOnOneThread(const BlasOnOneThread&) = delete;
  BlasOnOneThread& operator=(const BlasOnOneThread&) = delete;
};

/// What long work calls as its stages begin: raises what a signal raised (KeyboardInterrupt), and calls
/// `callback`, unless it is None, with the stage and the share of the work that is done, 0 to 1, which does
/// not go back where a search begins another step. What that raises ends the work. The caller holds
/// `callback` until the work has ended.
std::function<void(const std::string& stage, double done)> progress_to(const py::handle& callback);

/// Whatever may start threads, which may want to call Python, runs here.
template <class Work>
auto without_lock(const Work& work) {
  const BlasOnOneThread blas;
  const py::gil_scoped_release released;
  return work();
}

}  // namespace volcal::python

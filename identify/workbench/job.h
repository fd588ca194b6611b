#pragma once
/// Work in the thread of the workbench.

#include <functional>
#include <string>

#include "volcal/identify/workbench/workbench.h"

namespace volcal::workbench {

/// What it finds is taken under the lock.
struct Workbench::Job {
  std::string what;
  std::string command;  ///< as it is kept; empty: it changes no model
  bool behind = false;
  std::function<std::function<void()>(const SessionProgress&)> run;
  std::function<void()> first = {};  ///< what others wait for as well, never behind other programs
};

}  // namespace volcal::workbench

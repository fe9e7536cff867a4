// SPDX-License-Identifier: AGPL-3.0-or-later
// Calls long functions from Python. The work runs in a thread of its own, without Python's interpreter lock. Meanwhile
// the calling thread passes progress to Python and checks for Ctrl-C twenty times a second.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/pybind11.h>

#include "core/base/progress.h"

namespace limber::python {

// Calls work(progress) in another thread and waits for its end. Rethrows its exceptions. If `callback` or a signal
// handler raises an exception, cancels the work, and raises that exception when the work has ended.
//   callback  None; a function of (stage: str, fraction: float); or a tqdm bar
void call_long(const pybind11::object& callback, const std::function<void(Progress&)>& work);

template <class Work>
auto call_with_result(const pybind11::object& callback, const Work& work) {
  std::optional<decltype(work(no_progress()))> result;
  call_long(callback, [&](Progress& progress) { result = work(progress); });
  return std::move(*result);
}

// Raises a Python warning of class limber.LimberWarning for each line.
void warn_python(const std::vector<std::string>& lines);

}  // namespace limber::python

// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/python/python_call.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "core/base/parallel.h"

namespace py = pybind11;

namespace limber::python {

namespace {

// Passes the latest progress from the working thread to the calling thread.
class SharedProgress final : public Progress {
 public:
  struct State {
    std::string stage;
    double fraction = 0;
    bool operator==(const State&) const = default;
  };
  State state() {
    const std::lock_guard lock(mutex_);
    return state_;
  }

 protected:
  void on_update(std::string_view stage, double fraction) override {
    const std::lock_guard lock(mutex_);
    state_ = {std::string(stage), fraction};
  }

 private:
  std::mutex mutex_;
  State state_;
};

void show_progress(const py::object& callback, const SharedProgress::State& state) {
  if (callback.is_none()) return;
  if (!py::hasattr(callback, "set_description_str")) {
    callback(state.stage, state.fraction);
    return;
  }
  // Sets the total of a tqdm bar to 1 unless the user has set another.
  if (callback.attr("total").is_none()) callback.attr("total") = 1.0;
  callback.attr("set_description_str")(state.stage, false);
  callback.attr("n") = state.fraction * callback.attr("total").cast<double>();
  callback.attr("refresh")();
}

}  // namespace

void call_long(const py::object& callback, const std::function<void(Progress&)>& work) {
  SharedProgress progress;
  std::exception_ptr failure, raised;
  std::mutex mutex;
  std::condition_variable has_ended;
  bool ended = false;
  {
    const py::gil_scoped_release without_lock;
    std::thread worker([&] {
      try {
        const CancelScope cancels_loops(progress);
        work(progress);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      ended = true;
      has_ended.notify_one();
    });
    SharedProgress::State shown;
    std::unique_lock lock(mutex);
    while (!has_ended.wait_for(lock, std::chrono::milliseconds(50), [&] { return ended; })) {
      lock.unlock();
      if (!raised) {
        const py::gil_scoped_acquire with_lock;
        try {
          if (PyErr_CheckSignals() != 0) throw py::error_already_set();
          if (const SharedProgress::State state = progress.state(); state != shown) {
            shown = state;
            show_progress(callback, state);
          }
        } catch (...) {
          raised = std::current_exception();
          progress.cancel();
        }
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (raised) std::rethrow_exception(raised);
  if (failure) std::rethrow_exception(failure);
}

void warn_python(const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  const py::object category = py::module_::import("limber._limber").attr("LimberWarning");
  for (const std::string& line : lines)
    if (PyErr_WarnEx(category.ptr(), line.c_str(), 1) != 0) throw py::error_already_set();
}

}  // namespace limber::python

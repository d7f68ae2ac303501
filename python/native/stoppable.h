// python/native/stoppable.h
//
// Long work on behalf of Python.
// In:   work that honours a std::stop_token, a time limit.
// Out:  its answer; other Python threads run meanwhile, and Ctrl-C stops it.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <future>
#include <optional>
#include <stop_token>
#include <utility>

namespace lightfit {

template <typename Answer>
struct Stoppable {
  Answer answer;
  bool is_late;  // stopped because the time was over; may have come to its end all the same
};

// Calls work(stop) on a thread of its own, while this one (Python's main thread alone is told of
// signals) looks for Ctrl-C and the clock. What a signal's handler raises is raised here.
template <typename Work>
auto RunStoppable(std::optional<double> timeout_s, const Work& work)
    -> Stoppable<decltype(work(std::stop_token()))> {
  namespace py = pybind11;
  constexpr std::chrono::milliseconds kLookEvery(10);
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  std::stop_source stop;
  auto future = std::async(std::launch::async, [&] { return work(stop.get_token()); });
  std::optional<py::error_already_set> signal;
  bool is_late = false;
  {
    const py::gil_scoped_release others_run;
    while (!signal && !is_late && future.wait_for(kLookEvery) != std::future_status::ready) {
      const std::chrono::duration<double> passed = Clock::now() - begin;
      is_late = timeout_s && passed.count() >= *timeout_s;
      const py::gil_scoped_acquire python;
      if (PyErr_CheckSignals() != 0) signal.emplace();
    }
    if (signal || is_late) stop.request_stop();
    future.wait();
  }
  if (signal) throw py::error_already_set(*signal);
  return {future.get(), is_late};
}

}  // namespace lightfit

// How the module calls what takes long: without Python's lock, on a thread of its own, so that
// Ctrl-C is heard; and what Python raises of an exception.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bench/command/program.h"
#include "bench/output/progress.h"
#include "bench/scene/scene.h"

namespace wobblebench::python {

namespace py = pybind11;

/// What a command would print of an exception and exit with; Python raises BadInput or Failed.
struct Refused {
  bench::Refusal refusal;
};

/// The result of `body`, which may throw as commands do. Throws Refused.
template <class Body>
auto refusing(const Body& body) {
  try {
    return bench::with_late_refusals(body);
  } catch (...) {
    throw Refused{bench::refusal_of(std::current_exception())};
  }
}

/// Counts the calls that are under way: a process that exits meanwhile ends without destroying what
/// they use.
class CallUnderWay {
 public:
  CallUnderWay();
  ~CallUnderWay();
  CallUnderWay(const CallUnderWay&) = delete;
  CallUnderWay& operator=(const CallUnderWay&) = delete;
};

/// Waits without Python's lock until `is_done(50 ms)`. On Ctrl-C calls `stop` and throws
/// py::error_already_set.
void wait_for_call(const std::function<bool()>& is_done, const std::function<void()>& stop);

/// The result of `body`, run on a thread of its own without Python's lock. `body` must own what it
/// uses, and hold no Python object: on Ctrl-C, KeyboardInterrupt is raised at once, and the thread
/// goes on until `body` returns. `stop` makes it return early. Throws Refused.
template <class Body>
auto released(
    Body body, const std::function<void()>& stop = [] {}) {
  using Result = decltype(body());
  std::packaged_task<Result()> task([body = std::move(body)] { return refusing(body); });
  auto future = task.get_future();
  std::thread([task = std::move(task), running = std::make_shared<CallUnderWay>()]() mutable {
    task();
    // What the body owns is destroyed while the call still counts.
    task = {};
  }).detach();
  wait_for_call(
      [&] { return future.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready; },
      stop);
  return future.get();
}

/// Progress that is shown nowhere; warn() collects.
std::unique_ptr<bench::Progress> silent_progress();

/// Python's warnings.warn(), of the category wobblebench.SceneWarning.
void issue_warnings(const std::vector<std::string>& warnings);

/// Text of a JSON document as Python's dicts and lists.
py::dict from_json(const std::string& text);

/// Adds the exceptions and the warning to the module.
void add_exceptions(py::module_& module);

}  // namespace wobblebench::python

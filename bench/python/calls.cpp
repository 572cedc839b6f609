#include "bench/python/calls.h"

#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <utility>

namespace wobblebench::python {

namespace {

std::atomic<int> calls_under_way = 0;

/// Runs before the destructors of our libraries' static objects.
void exit_with_calls_under_way(int status, void*) {
  if (calls_under_way == 0) return;
  std::fflush(nullptr);
  ::_exit(status);
}

PyObject* bad_input = nullptr;
PyObject* failed = nullptr;
PyObject* scene_warning = nullptr;

PyObject* add_type(py::module_& module, const char* name, py::object bases, const char* text) {
  const std::string full = std::string("wobblebench.") + name;
  PyObject* const type = PyErr_NewExceptionWithDoc(full.c_str(), text, bases.ptr(), nullptr);
  if (type == nullptr) throw py::error_already_set();
  module.add_object(name, type);
  return type;
}

}  // namespace

CallUnderWay::CallUnderWay() {
  ++calls_under_way;
}

CallUnderWay::~CallUnderWay() {
  --calls_under_way;
}

void wait_for_call(const std::function<bool()>& is_done, const std::function<void()>& stop) {
  for (;;) {
    {
      const py::gil_scoped_release others_run;
      if (is_done()) return;
    }
    if (PyErr_CheckSignals() == 0) continue;
    stop();
    throw py::error_already_set();
  }
}

std::unique_ptr<bench::Progress> silent_progress() {
  static std::FILE* const nowhere = std::fopen("/dev/null", "we");
  return std::make_unique<bench::Progress>(std::vector<bench::PlannedStep>{},
                                           bench::ProgressOutput{.file = nowhere});
}

void issue_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) {
    if (PyErr_WarnEx(scene_warning, warning.c_str(), 1) != 0) throw py::error_already_set();
  }
}

py::dict from_json(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}

void add_exceptions(py::module_& module) {
  PyObject* const base =
      add_type(module,
               "Error",
               py::reinterpret_borrow<py::object>(PyExc_Exception),
               "What the program would say in one line after \"wobblebench: \".");
  bad_input = add_type(
      module,
      "BadInput",
      py::make_tuple(py::handle(base), py::handle(PyExc_ValueError)),
      "Bad input, for which the program has exit code 2: a line that names file, key, value and "
      "what is allowed.");
  failed = add_type(module,
                    "Failed",
                    py::make_tuple(py::handle(base), py::handle(PyExc_RuntimeError)),
                    "What this machine cannot do, for which the program has exit code 1.");
  scene_warning =
      add_type(module,
               "SceneWarning",
               py::reinterpret_borrow<py::object>(PyExc_UserWarning),
               "What the program would say after \"wobblebench: warning: \", such as an option "
               "that was given and is without effect.");
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(std::move(thrown));
    } catch (const Refused& refused) {
      const auto& [line, code] = refused.refusal;
      PyErr_SetString(code == bench::kBadInput ? bad_input : failed, line.c_str());
    }
  });
  ::on_exit(exit_with_calls_under_way, nullptr);
}

}  // namespace wobblebench::python

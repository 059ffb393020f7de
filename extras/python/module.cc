#include "module.h"

#include <dlfcn.h>
#include <pybind11/functional.h>
#include <signal.h>

#include "harness/base/bundled_files.h"
#include "harness/base/error.h"
#include "harness/base/version.h"
#include "harness/rendering/renderer_failed.h"

namespace touchstone::python {
namespace {

namespace py = pybind11;

void on_interrupt(int) { ask_to_stop(); }

// Only the main thread of Python handles signals.
bool in_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

void report_progress(py::object call) {
  if (call.is_none()) {
    const py::gil_scoped_release free;  // the last report may wait for it
    return watch_progress({});
  }
  // Let go of under the interpreter's lock, whoever drops the watcher.
  const std::shared_ptr<py::object> held(new py::object(std::move(call)), [](py::object* object) {
    const py::gil_scoped_acquire lock;
    delete object;
  });
  const py::gil_scoped_release free;
  watch_progress([held](const std::string& what, std::uint64_t done, std::uint64_t total) {
    const py::gil_scoped_acquire lock;
    try {
      (*held)(what, done, total);
    } catch (py::error_already_set& error) {
      error.discard_as_unraisable("the display of progress");
    }
  });
}

void bind_errors(py::module_& module) {
  static const py::handle error = py::exception<Error>(module, "Error", PyExc_RuntimeError).release();
  static const py::handle bad_data = py::exception<BadData>(module, "BadData", error).release();
  static const py::handle usage = py::exception<UsageError>(module, "UsageError", error).release();
  static const py::handle failed = py::exception<rendering::RendererFailed>(module, "RendererFailed", error).release();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const rendering::RendererFailed& e) {
      PyErr_SetString(failed.ptr(), e.what());
    } catch (const BadData& e) {
      PyErr_SetString(bad_data.ptr(), e.what());
    } catch (const UsageError& e) {
      PyErr_SetString(usage.ptr(), e.what());
    } catch (const Error& e) {
      PyErr_SetString(error.ptr(), e.what());
    }
  });
}

void search_beside_module() {
  Dl_info about{};
  if (::dladdr(reinterpret_cast<void*>(&search_beside_module), &about) != 0 && about.dli_fname != nullptr)
    search_bundled_above(about.dli_fname);
}

}  // namespace

LongWork::LongWork() {
  if (!in_main_thread()) return;
  allow_work();
  before_ = PyOS_setsig(SIGINT, on_interrupt);
  handles_ = true;
}

void LongWork::finish() {
  if (!handles_) return;
  PyOS_setsig(SIGINT, before_);
  handles_ = false;
}

LongWork::~LongWork() { finish(); }

void LongWork::interrupted() {
  allow_work();
  PyErr_SetNone(PyExc_KeyboardInterrupt);
  throw py::error_already_set();
}

}  // namespace touchstone::python

PYBIND11_MODULE(_touchstone, module) {
  using namespace touchstone;
  using namespace touchstone::python;
  module.doc() = "The library of Touchstone; import touchstone instead.";
  bind_errors(module);
  bind_recordings(module);
  bind_surfaces(module);
  bind_rendering(module);
  bind_commands(module);
  module.attr("__version__") = build_info().version;
  module.def("build_info", [] {
    const BuildInfo& info = build_info();
    py::dict out;
    out["version"] = info.version;
    out["commit"] = info.commit;
    out["dirty"] = info.dirty;
    out["compiler"] = info.compiler;
    out["build_type"] = info.build_type;
    out["flags"] = info.flags;
    return out;
  });
  module.def("report_progress", &report_progress, py::arg("call"));
  search_beside_module();
}

// The parts of the Python module `touchstone._touchstone`; the package `touchstone` (the folder beside this) is what
// users import. Nothing here computes: every call is one of the library's, or a command of the program.
#pragma once

#include <pybind11/pybind11.h>

namespace touchstone::python {

// Recordings, trajectories and rendered files.
void bind_recordings(pybind11::module_& module);
// Meshes, their surfaces, synthetic surfaces and trajectories.
void bind_surfaces(pybind11::module_& module);
// Models, renderers and replay.
void bind_rendering(pybind11::module_& module);
// The commands of the program, run in this process.
void bind_commands(pybind11::module_& module);

// While it lives, the interpreter's lock is free, and Ctrl-C in the main thread asks the work to stop. call() throws
// KeyboardInterrupt where it was stopped.
class LongWork {
 public:
  template <class Work>
  static auto call(Work&& work) {
    return LongWork().run(work);
  }

 private:
  LongWork();
  ~LongWork();
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;
  [[noreturn]] static void interrupted();
  void finish();

  template <class Work>
  auto run(Work& work);

  void (*before_)(int) = nullptr;
  bool handles_ = false;
};

}  // namespace touchstone::python

#include "harness/base/progress.h"

namespace touchstone::python {

template <class Work>
auto LongWork::run(Work& work) {
  try {
    auto result = [&] {
      const pybind11::gil_scoped_release free;
      return work();
    }();
    if (!asked_to_stop()) return result;
  } catch (const Stopped&) {
  }
  finish();
  interrupted();
}

}  // namespace touchstone::python

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "harness/recording/recording_file.h"
#include "module.h"

namespace touchstone::python {
using recording::ClockPolicy;
using recording::ColumnUnits;
using recording::InTrajectory;
using recording::Loaded;
using recording::Recording;
using recording::RenderedTrajectory;

namespace {

using Path = std::filesystem::path;

ClockPolicy clock_policy(const std::string& on_duplicate, const std::string& on_gap) {
  ClockPolicy policy;
  policy.on_duplicate = recording::parse_on_duplicate(on_duplicate);
  policy.on_gap = recording::parse_on_gap(on_gap);
  return policy;
}

ColumnUnits units_of(const std::string& length, const std::string& force, const std::string& time,
                     const std::string& torque) {
  return {time, length, force, torque};
}

MotionColumns motion_of(const Doubles& time_s, const Doubles& position_m, const std::optional<Doubles>& orientation) {
  MotionColumns motion{doubles_of(time_s, "time_s"), vectors_of(position_m, "position_m"), {}};
  if (orientation) motion.q_WS = quaternions_of(*orientation, "orientation_xyzw");
  return motion;
}

template <class Value>
void expect_length(const std::vector<Value>& values, std::size_t samples, const char* name) {
  if (values.size() == samples || values.empty()) return;
  throw UsageError(
      fmt::format("{} has {} samples, but time_s has {}; all must have the same number", name, values.size(), samples));
}

template <class T>
using Shared = std::shared_ptr<Loaded<T>>;

template <class T, class Load>
auto loader(Load load) {
  return [load](const Path& path, const std::string& on_duplicate, const std::string& on_gap) {
    const ClockPolicy policy = clock_policy(on_duplicate, on_gap);
    return LongWork::call([&] { return std::make_shared<Loaded<T>>(load(path, policy)); });
  };
}

template <class T, class Save>
auto saver(Save save) {
  return [save](const Loaded<T>& self, const Path& path, const std::string& length, const std::string& force,
                const std::string& time, const std::string& torque) {
    LongWork::call([&] {
      save(path, self.value, units_of(length, force, time, torque));
      return 0;
    });
  };
}

// What the three kinds have in common.
template <class T>
py::class_<Loaded<T>, Shared<T>> bind_kind(py::module_& module, const char* name, const char* doc) {
  py::class_<Loaded<T>, Shared<T>> kind(module, name, doc);
  kind.def("__len__", [](const Loaded<T>& self) { return self.value.size(); })
      .def_readonly("notes", &Loaded<T>::notes, "What was tolerated or changed while reading, one sentence each.")
      .def_readonly("segment_starts", &Loaded<T>::segment_starts,
                    "With on_gap='split': the first sample of each segment, beginning with 0; else empty.")
      .def_property_readonly(
          "median_interval_s", [](const Loaded<T>& self) { return self.clock.median_interval_s; },
          "Median time between samples [s]; 0 where it was not read from a file.");
  return kind;
}

constexpr const char* save_help =
    "Writes CSV (.csv, .csv.gz) or HDF5 (.h5, .hdf5). An existing file is replaced by the whole new one or left as it "
    "is.\nIn SI units what is written is read back to the bit.";

void bind_recording(py::module_& module) {
  auto recording =
      bind_kind<Recording>(module, "Recording",
                           "What a probe measured: arrays of N samples in SI units, in the object's frame. "
                           "The arrays are read-only views of the recording's memory.");
  recording
      .def(py::init([](const Doubles& time_s, const Doubles& position_m, const Doubles& force_N,
                       const std::optional<Doubles>& orientation, const std::optional<Doubles>& torque,
                       const std::string& source) {
             auto out = std::make_shared<Loaded<Recording>>();
             out->value.motion = motion_of(time_s, position_m, orientation);
             out->value.f_W_N = vectors_of(force_N, "force_N");
             if (torque) out->value.torque_W_Nm = vectors_of(*torque, "torque_Nm");
             out->value.source = source;
             const std::size_t samples = out->value.size();
             expect_length(out->value.motion.p_W_m, samples, "position_m");
             expect_length(out->value.f_W_N, samples, "force_N");
             expect_length(out->value.motion.q_WS, samples, "orientation_xyzw");
             expect_length(out->value.torque_W_Nm, samples, "torque_Nm");
             return out;
           }),
           py::arg("time_s"), py::arg("position_m"), py::arg("force_N"), py::kw_only(),
           py::arg("orientation_xyzw") = py::none(), py::arg("torque_Nm") = py::none(), py::arg("source") = "")
      .def_property_readonly(
          "time_s", [](const Shared<Recording>& self) { return view_of(self, self->value.motion.t_s); },
          "(N,) time [s], strictly increasing.")
      .def_property_readonly(
          "position_m", [](const Shared<Recording>& self) { return view_of(self, self->value.motion.p_W_m); },
          "(N, 3) position of the probe's tip [m]; the ball's centre where the tip is a ball.")
      .def_property_readonly(
          "force_N", [](const Shared<Recording>& self) { return view_of(self, self->value.f_W_N); },
          "(N, 3) force on the probe by the object [N].")
      .def_property_readonly(
          "orientation_xyzw", [](const Shared<Recording>& self) { return view_or_none(self, self->value.motion.q_WS); },
          "(N, 4) unit quaternions x, y, z, w from the sensor's frame to the object's; None where not recorded.")
      .def_property_readonly(
          "torque_Nm", [](const Shared<Recording>& self) { return view_or_none(self, self->value.torque_W_Nm); },
          "(N, 3) torque about the tip [Nm]; None where not recorded.")
      .def_property_readonly(
          "source", [](const Loaded<Recording>& self) { return self.value.source; }, "The file that it came from.")
      .def("save", saver<Recording>([](const Path& path, const Recording& value, const ColumnUnits& units) {
             save_recording(path, value, units);
           }),
           save_help, py::arg("path"), py::kw_only(), py::arg("length_unit") = "m", py::arg("force_unit") = "N",
           py::arg("time_unit") = "s", py::arg("torque_unit") = "Nm");
  module.def("load_recording",
             loader<Recording>([](const Path& path, const ClockPolicy& p) { return load_recording(path, p); }),
             py::arg("path"), py::kw_only(), py::arg("on_duplicate") = "refuse", py::arg("on_gap") = "keep",
             "Reads a recording (CSV, also .gz, or HDF5): time, position and force. Raises BadData naming the file, "
             "place, value and what was expected.");
}

void bind_trajectory(py::module_& module) {
  auto trajectory = bind_kind<InTrajectory>(module, "Trajectory", "Positions over time that a virtual probe takes.");
  trajectory
      .def(py::init([](const Doubles& time_s, const Doubles& position_m, const std::optional<Doubles>& orientation) {
             auto out = std::make_shared<Loaded<InTrajectory>>();
             out->value.motion = motion_of(time_s, position_m, orientation);
             expect_length(out->value.motion.p_W_m, out->value.size(), "position_m");
             expect_length(out->value.motion.q_WS, out->value.size(), "orientation_xyzw");
             return out;
           }),
           py::arg("time_s"), py::arg("position_m"), py::kw_only(), py::arg("orientation_xyzw") = py::none())
      .def_property_readonly(
          "time_s", [](const Shared<InTrajectory>& self) { return view_of(self, self->value.motion.t_s); },
          "(N,) time [s], strictly increasing.")
      .def_property_readonly(
          "position_m", [](const Shared<InTrajectory>& self) { return view_of(self, self->value.motion.p_W_m); },
          "(N, 3) position of the tip [m].")
      .def_property_readonly(
          "orientation_xyzw",
          [](const Shared<InTrajectory>& self) { return view_or_none(self, self->value.motion.q_WS); },
          "(N, 4) unit quaternions x, y, z, w; None where not known.")
      .def("save", saver<InTrajectory>([](const Path& path, const InTrajectory& value, const ColumnUnits& units) {
             save_trajectory(path, value, units);
           }),
           save_help, py::arg("path"), py::kw_only(), py::arg("length_unit") = "m", py::arg("force_unit") = "N",
           py::arg("time_unit") = "s", py::arg("torque_unit") = "Nm");
  module.def("load_trajectory",
             loader<InTrajectory>([](const Path& path, const ClockPolicy& p) { return load_trajectory(path, p); }),
             py::arg("path"), py::kw_only(), py::arg("on_duplicate") = "refuse", py::arg("on_gap") = "keep",
             "Reads time and position of a file; other columns are checked and not used.");
}

void bind_rendered(py::module_& module) {
  auto rendered = bind_kind<RenderedTrajectory>(module, "Rendered", "What a renderer made of a trajectory.");
  rendered
      .def_property_readonly(
          "time_s", [](const Shared<RenderedTrajectory>& self) { return view_of(self, self->value.t_s); },
          "(N,) time [s].")
      .def_property_readonly(
          "position_m", [](const Shared<RenderedTrajectory>& self) { return view_of(self, self->value.tip_W_m); },
          "(N, 3) position of the tip [m].")
      .def_property_readonly(
          "contact_m", [](const Shared<RenderedTrajectory>& self) { return view_of(self, self->value.contact_W_m); },
          "(N, 3) surface contact point [m]; the tip itself when free.")
      .def_property_readonly(
          "force_N", [](const Shared<RenderedTrajectory>& self) { return view_of(self, self->value.f_W_N); },
          "(N, 3) force on the probe by the object [N].")
      .def_property_readonly(
          "contact",
          [](const Shared<RenderedTrajectory>& self) {
            return view_of(self, self->value.contact.data(), self->value.size(), 0);
          },
          "(N,) 1 in contact, 0 free.")
      .def_property_readonly(
          "step_us", [](const Shared<RenderedTrajectory>& self) { return view_or_none(self, self->value.cost_us); },
          "(N,) time that each step took [us]; None where steps were not timed.")
      .def("save",
           saver<RenderedTrajectory>([](const Path& path, const RenderedTrajectory& value, const ColumnUnits& units) {
             save_rendered(path, value, units);
           }),
           save_help, py::arg("path"), py::kw_only(), py::arg("length_unit") = "m", py::arg("force_unit") = "N",
           py::arg("time_unit") = "s", py::arg("torque_unit") = "Nm");
  module.def("load_rendered",
             loader<RenderedTrajectory>([](const Path& path, const ClockPolicy& p) { return load_rendered(path, p); }),
             py::arg("path"), py::kw_only(), py::arg("on_duplicate") = "refuse", py::arg("on_gap") = "keep",
             "Reads a rendered file: time, tip, force, surface contact point and contact.");
}

}  // namespace

void bind_recordings(py::module_& module) {
  bind_recording(module);
  bind_trajectory(module);
  bind_rendered(module);
}

}  // namespace touchstone::python

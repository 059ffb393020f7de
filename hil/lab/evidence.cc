#include "hil/lab/evidence.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "harness/base/atomic_file.h"
#include "harness/base/version.h"
#include "hil/lab/analysis.h"

namespace touchstone::hil {

void publish(const Evidence& e, const std::vector<WrenchSample>& samples) {
  for (const auto& m : e.measurements) {
    if (!std::isfinite(m.value)) throw BadData(fmt::format("{}: {} is not finite: no result", e.test, m.name));
    if (e.device.emulated) {
      fmt::print("emulated {} {} = {:.9g}\n", e.test, m.name, m.value);
    } else {
      fmt::print("<CTestMeasurement type=\"numeric/double\" name=\"{}\">{:.9g}</CTestMeasurement>\n", m.name, m.value);
    }
  }
  if (!e.device.emulated) {
    fmt::print("<CTestMeasurement type=\"text/string\" name=\"device\">{} serial {}, {}</CTestMeasurement>\n",
               e.device.id, e.device.serial, e.device.calibration);
  }
  const char* const folder = std::getenv("TOUCHSTONE_HIL_EVIDENCE");
  if (folder == nullptr || *folder == '\0') return;
  // Emulated evidence lies apart: it never enters a hardware report.
  const auto place = std::filesystem::path(folder) / (e.device.emulated ? "emulated" : "hardware");
  std::filesystem::create_directories(place);
  const auto& c = e.counters;
  nlohmann::json json{
      {"schema", "touchstone-hil-evidence/1"},
      {"test", e.test},
      {"emulated", e.device.emulated},
      {"device", e.device.id},
      {"serial", e.device.serial},
      {"firmware", e.device.firmware},
      {"calibration", e.device.calibration},
      {"fixture", e.fixture},
      {"scheduling", scheduling()},
      {"clock", "CLOCK_MONOTONIC"},
      {"commit", build_info().commit},
      {"when",
       fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())))},
      {"counters",
       {{"received", c.received},
        {"lost", c.lost},
        {"repeated", c.repeated},
        {"reordered", c.reordered},
        {"malformed", c.malformed},
        {"device_errors", c.device_errors}}}};
  for (const auto& m : e.measurements) json["measurements"][m.name] = m.value;
  if (!samples.empty()) {
    std::string csv = "t_s,sequence,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,flags\n";
    for (const auto& s : samples) {
      const auto &f = s.wrench.f_N, &t = s.wrench.torque_Nm;
      csv += fmt::format("{:.9f},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{}\n", s.t_s, s.sequence, f.x(), f.y(),
                         f.z(), t.x(), t.y(), t.z(), s.flags);
    }
    write_file(place / (e.test + ".csv"), csv);
    json["samples"] = e.test + ".csv";
  }
  write_file(place / (e.test + ".json"), json.dump(1) + "\n");
}

}  // namespace touchstone::hil

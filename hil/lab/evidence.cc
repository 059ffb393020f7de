#include "lab/evidence.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "harness/base/atomic_file.h"
#include "harness/base/markup.h"
#include "harness/base/version.h"
#include "lab/analysis.h"

namespace touchstone::hil {
namespace {

// What a device says of itself may hold anything.
std::string xml_text(std::string text) {
  for (char& c : text) c = static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f ? '?' : c;
  return escape_xml(text);
}

nlohmann::json pictures_json(const std::vector<Picture>& pictures) {
  auto list = nlohmann::json::array();
  for (const auto& p : pictures) {
    nlohmann::json picture{{"title", p.title}, {"x_label", p.x_label}, {"y_label", p.y_label}};
    for (const auto& c : p.curves)
      picture["curves"].push_back({{"name", c.name}, {"points", c.points}, {"x", c.x}, {"y", c.y}});
    list.push_back(std::move(picture));
  }
  return list;
}

}  // namespace

void Evidence::take(const Finding& finding) {
  test = finding.test + (test.empty() ? "" : "-" + test);
  measurements = finding.measurements;
  limits = finding.limits;
  pictures = finding.pictures;
  runs = finding.runs;
}

void publish(const Evidence& e, const std::vector<WrenchSample>& samples) {
  for (const auto& m : e.measurements) {
    if (!std::isfinite(m.value))
      throw BadData(
          fmt::format("{}: {} is not finite: no result; look at the samples in the evidence, and run the test again",
                      e.test, m.name));
    if (e.device.emulated) {
      fmt::print("emulated {} {} = {:.9g}\n", e.test, m.name, m.value);
    } else {
      fmt::print("<CTestMeasurement type=\"numeric/double\" name=\"{}\">{:.9g}</CTestMeasurement>", m.name, m.value);
    }
  }
  if (!e.device.emulated) {
    const std::pair<const char*, const std::string*> texts[] = {{"device", &e.device.id},
                                                                {"device_serial", &e.device.serial},
                                                                {"device_firmware", &e.device.firmware},
                                                                {"calibration", &e.device.calibration},
                                                                {"sensor", &e.sensor},
                                                                {"fixture", &e.fixture}};
    for (const auto& [name, text] : texts) {
      if (!text->empty())
        fmt::print("<CTestMeasurement type=\"text/string\" name=\"{}\">{}</CTestMeasurement>", name, xml_text(*text));
    }
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
      {"clock", "CLOCK_BOOTTIME"},  // of MonotonicClock
      {"commit", build_info().commit},
      {"dirty", build_info().dirty},
      {"when",
       fmt::format("{:%FT%TZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())))},
      {"counters",
       {{"received", c.received},
        {"lost", c.lost},
        {"repeated", c.repeated},
        {"reordered", c.reordered},
        {"malformed", c.malformed},
        {"strangers", c.foreign_packets},
        {"device_errors", c.device_errors}}}};
  for (const auto& m : e.measurements) json["measurements"][m.name] = m.value;
  for (const auto& limit : e.limits) {
    auto& held = json["limits"][limit.measurement];
    if (std::isfinite(limit.least)) held["least"] = limit.least;
    if (std::isfinite(limit.most)) held["most"] = limit.most;
  }
  if (!e.limits.empty()) json["failures"] = Finding{e.test, e.measurements, e.limits}.failures();
  if (!e.sensor.empty()) json["sensor"] = e.sensor;
  if (!e.dead_man.empty()) json["dead_man"] = e.dead_man;
  json["pictures"] = pictures_json(e.pictures);
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
  if (!e.runs.empty()) {
    std::string ticks = "run,t_s,x_m,y_m,z_m,vx_m_per_s,vy_m_per_s,vz_m_per_s,fx_N,fy_N,fz_N\n",
                wrenches = "run,t_s,sequence,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm,flags\n";
    for (std::size_t run = 0; run < e.runs.size(); ++run) {
      json["runs"].push_back({{"start_s", e.runs[run].start_s},
                              {"trip", to_string(e.runs[run].trip)},
                              {"saturated_ticks", e.runs[run].saturated},
                              {"ticks", e.runs[run].ticks.size()}});
      for (const auto& t : e.runs[run].ticks) {
        const auto &p = t.p_W_m, &v = t.v_W_m_per_s, &f = t.allowed_N;
        ticks += fmt::format("{},{:.9f},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", run, t.t_s,
                             p.x(), p.y(), p.z(), v.x(), v.y(), v.z(), f.x(), f.y(), f.z());
      }
      for (const auto& s : e.runs[run].wrenches) {
        const auto &f = s.wrench.f_N, &t = s.wrench.torque_Nm;
        wrenches += fmt::format("{},{:.9f},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{}\n", run, s.t_s, s.sequence,
                                f.x(), f.y(), f.z(), t.x(), t.y(), t.z(), s.flags);
      }
    }
    write_file(place / (e.test + ".ticks.csv"), ticks);
    write_file(place / (e.test + ".wrenches.csv"), wrenches);
  }
  write_file(place / (e.test + ".json"), json.dump(1) + "\n");
}

}  // namespace touchstone::hil

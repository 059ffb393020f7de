#include "lab/evidence_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/base/error.h"
#include "harness/base/json_reader.h"

namespace touchstone::hil {
using report::Section;
using report::Table;
using report::Tone;

namespace {

using nlohmann::json;

std::string text_of(const json& j, const char* key) { return j.contains(key) ? j.at(key).get<std::string>() : ""; }

Table measurement_table(const json& evidence) {
  Table table;
  table.columns = {"measurement", "value", "at least", "at most", ""};
  const json limits = evidence.value("limits", json::object());
  for (const auto& [name, value] : evidence.at("measurements").items()) {
    const double v = value.get<double>();
    Table::Row row;
    row.cells.push_back({name});
    row.cells.push_back({fmt::format("{:.5g}", v), true});
    const json limit = limits.value(name, json::object());
    bool held = true;
    for (const char* const side : {"least", "most"}) {
      const bool stated = limit.contains(side);
      const double bound = stated ? limit.at(side).get<double>() : 0.0;
      row.cells.push_back({stated ? fmt::format("{:.5g}", bound) : "", true});
      if (stated) held = held && (side[0] == 'l' ? v >= bound : v <= bound);
    }
    row.cells.push_back({limit.empty() ? ""
                         : held        ? "holds"
                                       : "does not hold",
                         false,
                         limit.empty() ? Tone::neutral
                         : held        ? Tone::good
                                       : Tone::warning});
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::LinePlot plot_of(const json& picture) {
  report::LinePlot plot;
  plot.title = picture.at("title").get<std::string>();
  plot.x_label = picture.at("x_label").get<std::string>();
  plot.y_label = picture.at("y_label").get<std::string>();
  constexpr Tone tones[] = {Tone::measured, Tone::reference, Tone::rendered, Tone::error};
  std::size_t n = 0;
  for (const auto& curve : picture.at("curves")) {
    report::Line line;
    line.name = curve.at("name").get<std::string>();
    line.x = curve.at("x").get<std::vector<double>>();
    line.y = curve.at("y").get<std::vector<double>>();
    line.markers = curve.at("points").get<bool>();
    line.tone = tones[n++ % std::size(tones)];
    plot.lines.push_back(std::move(line));
  }
  return plot;
}

Section section_of(const json& e, bool failed) {
  Section section;
  section.title = e.at("test").get<std::string>();
  section.intro = failed ? "Does not keep its limits." : "";
  for (const auto& failure : e.value("failures", json::array()))
    section.blocks.emplace_back(report::TextBlock{failure.get<std::string>(), Tone::warning});
  section.blocks.emplace_back(measurement_table(e));
  for (const auto& picture : e.value("pictures", json::array())) section.blocks.emplace_back(plot_of(picture));
  report::Facts facts;
  for (const char* const key : {"device", "serial", "firmware", "calibration", "sensor", "dead_man", "fixture",
                                "scheduling", "clock", "when", "commit", "samples"}) {
    if (const auto text = text_of(e, key); !text.empty()) facts.rows.emplace_back(key, text);
    if (std::string_view(key) == "commit" && e.value("dirty", false))
      facts.rows.back().second += ", with changes that were not committed";
  }
  for (const auto& [name, count] : e.at("counters").items())
    facts.rows.emplace_back("samples " + name, std::to_string(count.get<std::uint64_t>()));
  section.blocks.emplace_back(std::move(facts));
  return section;
}

}  // namespace

EvidencePage evidence_page(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw BadData(folder.string() +
                  ": no evidence there; run the lab's tests with TOUCHSTONE_HIL_EVIDENCE=FOLDER and give "
                  "FOLDER/hardware or FOLDER/emulated");
  EvidencePage result;
  std::string first, devices;
  for (const auto& file : files) {
    const json e = load_json(file);
    try {
      if (e.at("schema") != "touchstone-hil-evidence/1")
        throw BadData(
            file.string() +
            ": /schema: touchstone-hil-evidence/1 was expected; give the folder that TOUCHSTONE_HIL_EVIDENCE named");
      const bool emulated = e.at("emulated").get<bool>();
      if (first.empty()) {
        first = file.string();
        result.emulated = emulated;
      } else if (emulated != result.emulated) {
        throw BadData(fmt::format(
            "{} is {}, {} is not: emulated and hardware results never stand on one page; give one folder of them",
            emulated ? file.string() : first, "emulated", emulated ? first : file.string()));
      }
      const bool failed = !e.value("failures", json::array()).empty();
      ++result.tests;
      result.failed += failed;
      const auto device = fmt::format("{} serial {}", text_of(e, "device"), text_of(e, "serial"));
      if (devices.find(device) == std::string::npos) devices += (devices.empty() ? "" : ", ") + device;
      result.page.sections.push_back(section_of(e, failed));
    } catch (const json::exception& problem) {
      throw BadData(fmt::format("{}: not evidence of a lab's test: {}; take the file out of the folder", file.string(),
                                problem.what()));
    }
  }
  report::Page& page = result.page;
  page.title = result.emulated ? "EMULATED lab run" : "Hardware in the loop";
  page.subtitle = devices;
  page.headlines = {
      {"tests", std::to_string(result.tests), "", "", Tone::neutral},
      {"out of their limits", std::to_string(result.failed), "", "", result.failed > 0 ? Tone::warning : Tone::good}};
  if (result.emulated) {
    Section warning;
    warning.title = "Emulated";
    warning.blocks.emplace_back(report::TextBlock{
        "Every number here comes from an emulator or a simulation, which encodes how we read a protocol and "
        "how we think "
        "a device behaves. None of it says anything about a real device.",
        Tone::warning});
    page.sections.insert(page.sections.begin(), std::move(warning));
  }
  return result;
}

}  // namespace touchstone::hil

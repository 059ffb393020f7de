#include "harness/report/cdash_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::report {
namespace {

struct PartKind {
  const char* name;
  const char* file;
  const char* element;  // below Site
  const char* row;      // counted anywhere below it
};

constexpr std::array<PartKind, 7> part_kinds{{{"Update", "Update.xml", "", ""},
                                              {"Configure", "Configure.xml", "Configure", ""},
                                              {"Build", "Build.xml", "Build", ""},
                                              {"Test", "Test.xml", "Testing", "Test"},
                                              {"Coverage", "Coverage.xml", "Coverage", "File"},
                                              {"MemCheck", "DynamicAnalysis.xml", "DynamicAnalysis", "Test"},
                                              {"Upload", "Upload.xml", "Upload", "File"}}};

std::size_t rows_of(const pugi::xml_document& document, const PartKind& kind) {
  const auto part = document.child("Site").child(kind.element);
  if (*kind.row == '\0') return 1;
  const auto rows = part.children(kind.row);
  return static_cast<std::size_t>(std::distance(rows.begin(), rows.end()));
}

std::string text_of(const pugi::xml_document& document) {
  std::ostringstream out;
  document.save(out);
  return out.str();
}

// Notes.xml as ctest writes it (Source/CTest: cmCTest::GenerateNotesFile), below the Site of another part.
DashboardPart notes_part(const std::filesystem::path& folder, const pugi::xml_document& other) {
  pugi::xml_document document;
  auto site = document.append_child("Site");
  for (const auto& attribute : other.child("Site").attributes()) site.append_copy(attribute);
  auto notes = site.append_child("Notes");
  DashboardPart part{"Notes", "Notes.xml", "", 0};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  for (const auto& file : files) {
    std::string text = read_file(file);
    std::erase_if(text, [](char c) { return static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t'; });
    if (text.empty()) continue;  // CDash drops a note without text
    auto note = notes.append_child("Note");
    note.append_attribute("Name") = file.filename().c_str();
    const std::time_t now = std::time(nullptr);
    note.append_child("Time").text() = static_cast<long long>(now);
    note.append_child("DateTime").text() = fmt::format("{}", now).c_str();
    note.append_child("Text").text() = text.c_str();
    ++part.rows;
  }
  part.xml = text_of(document);
  return part;
}

std::size_t total_of(const nlohmann::json& build, const char* field) {
  return build.at(field).at("pageInfo").at("total").get<std::size_t>();
}

}  // namespace

DashboardRun load_dashboard_run(const std::filesystem::path& folder) {
  DashboardRun run{folder, {}, {}};
  std::ifstream tag(folder / "Testing" / "TAG");
  std::string stamp;
  std::getline(tag, stamp);
  const auto results = folder / "Testing" / stamp;
  if (stamp.empty() || !std::filesystem::is_directory(results))
    throw BadData(fmt::format("{}: holds no dashboard run (Testing/TAG and its results)", folder.string()));
  pugi::xml_document named;
  const auto add = [&](const PartKind& kind, const std::filesystem::path& file, const std::string& name) {
    DashboardPart part{name, file.filename().string(), read_file(file), 0};
    pugi::xml_document document;
    if (const auto parsed = document.load_string(part.xml.c_str()); !parsed)
      throw BadData(fmt::format("{}: is no XML: {}", file.string(), parsed.description()));
    part.rows = rows_of(document, kind);
    if (document.child("Site").attribute("BuildStamp")) {
      const auto site = document.child("Site");
      run.build = {site.attribute("Name").value(), site.attribute("BuildName").value(),
                   site.attribute("BuildStamp").value()};
      named.reset(document);
    }
    run.parts.push_back(std::move(part));
  };
  for (const PartKind& kind : part_kinds) {
    // Notes go before Upload: a server's quota may make the last part fail.
    if (std::string_view(kind.name) == "Upload" && std::filesystem::is_directory(folder / "notes") &&
        !run.build.stamp.empty()) {
      DashboardPart notes = notes_part(folder / "notes", named);
      if (notes.rows > 0) run.parts.push_back(std::move(notes));
    }
    if (std::filesystem::exists(results / kind.file)) add(kind, results / kind.file, kind.name);
    for (int i = 0; std::string_view(kind.name) == "Coverage"; ++i) {
      const auto log = results / fmt::format("CoverageLog-{}.xml", i);
      if (!std::filesystem::exists(log)) break;
      add(kind, log, fmt::format("CoverageLog-{}", i));
    }
  }
  if (run.build.stamp.empty()) throw BadData(fmt::format("{}: no part names its build", folder.string()));
  return run;
}

std::string remote_fields() {
  return "id stamp startTime site { name } updateStep { id } configure { id } buildErrorsCount "
         "tests(first: 1) { pageInfo { total } } notes(first: 1) { pageInfo { total } } "
         "files(first: 1) { pageInfo { total } } urls(first: 1) { pageInfo { total } } "
         "coverage(first: 1) { pageInfo { total } } dynamicAnalyses(first: 1) { pageInfo { total } }";
}

std::optional<std::size_t> remote_rows(const nlohmann::json& build, const DashboardPart& part) {
  const auto present = [&](const char* field) -> std::optional<std::size_t> {
    if (build.at(field).is_null()) return std::nullopt;
    return part.rows;
  };
  const auto counted = [&](std::size_t total) {
    return total == 0 && part.rows > 0 ? std::nullopt : std::optional(total);
  };
  if (part.name == "Update") return present("updateStep");
  if (part.name == "Configure") return present("configure");
  if (part.name == "Build") {
    const auto& errors = build.at("buildErrorsCount");  // -1 before the part
    return errors.is_number_integer() && errors.get<long>() >= 0 ? std::optional(part.rows) : std::nullopt;
  }
  if (part.name == "Test") return counted(total_of(build, "tests"));
  if (part.name == "MemCheck") return counted(total_of(build, "dynamicAnalyses"));
  if (part.name == "Upload") return counted(total_of(build, "files") + total_of(build, "urls"));
  if (part.name == "Notes") return counted(total_of(build, "notes"));
  // Files without a line to cover leave no row.
  return total_of(build, "coverage") > 0 || part.rows == 0 ? std::optional(part.rows) : std::nullopt;
}

std::string done_xml(const std::string& build_id) {
  return fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Done><buildId>{}</buildId><time>{}</time></Done>\n",
                     build_id, std::time(nullptr));
}

}  // namespace touchstone::report

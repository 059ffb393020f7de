#include "cdash_parts.h"

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

namespace touchstone::dashboard {
namespace {

struct PartFile {
  PartKind kind;
  const char* name;
  const char* file;
  const char* element;  // below Site
  const char* row;      // counted anywhere below it
};

constexpr std::array<PartFile, 7> part_files{
    {{PartKind::update, "Update", "Update.xml", "", ""},
     {PartKind::configure, "Configure", "Configure.xml", "Configure", ""},
     {PartKind::build, "Build", "Build.xml", "Build", ""},
     {PartKind::test, "Test", "Test.xml", "Testing", "Test"},
     {PartKind::coverage, "Coverage", "Coverage.xml", "Coverage", "File"},
     {PartKind::memory_check, "MemCheck", "DynamicAnalysis.xml", "DynamicAnalysis", "Test"},
     {PartKind::upload, "Upload", "Upload.xml", "Upload", "File"}}};

std::size_t rows_of(const pugi::xml_document& document, const PartFile& wanted) {
  const auto part = document.child("Site").child(wanted.element);
  if (*wanted.row == '\0') return 1;
  const auto rows = part.children(wanted.row);
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
  DashboardPart part{PartKind::notes, "Notes", "Notes.xml", "", 0};
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
  const auto& total = build.at(field).at("pageInfo").at("total");
  if (!total.is_number_unsigned())
    throw BadData(
        fmt::format("what the server shows of {} is not what CDash's GraphQL gives: {} in all", field, total.dump()));
  return total.get<std::size_t>();
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
  const auto add = [&](const PartFile& wanted, const std::filesystem::path& file, const std::string& name) {
    DashboardPart part{wanted.kind, name, file.filename().string(), read_file(file), 0};
    pugi::xml_document document;
    if (const auto parsed = document.load_string(part.xml.c_str()); !parsed)
      throw BadData(fmt::format("{}: is no XML: {}", file.string(), parsed.description()));
    part.rows = rows_of(document, wanted);
    if (document.child("Site").attribute("BuildStamp")) {
      const auto site = document.child("Site");
      run.build = {site.attribute("Name").value(), site.attribute("BuildName").value(),
                   site.attribute("BuildStamp").value()};
      named.reset(document);
    }
    run.parts.push_back(std::move(part));
  };
  for (const PartFile& wanted : part_files) {
    // Notes go before Upload: a server's quota may make the last part fail.
    if (wanted.kind == PartKind::upload && std::filesystem::is_directory(folder / "notes") &&
        !run.build.stamp.empty()) {
      DashboardPart notes = notes_part(folder / "notes", named);
      if (notes.rows > 0) run.parts.push_back(std::move(notes));
    }
    if (std::filesystem::exists(results / wanted.file)) add(wanted, results / wanted.file, wanted.name);
    for (int i = 0; wanted.kind == PartKind::coverage; ++i) {
      const auto log = results / fmt::format("CoverageLog-{}.xml", i);
      if (!std::filesystem::exists(log)) break;
      add(wanted, log, fmt::format("CoverageLog-{}", i));
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

std::optional<std::size_t> remote_rows(const nlohmann::json& build, const DashboardPart& part) try {
  const auto present = [&](const char* field) -> std::optional<std::size_t> {
    if (build.at(field).is_null()) return std::nullopt;
    return part.rows;
  };
  const auto counted = [&](std::size_t total) {
    return total == 0 && part.rows > 0 ? std::nullopt : std::optional(total);
  };
  switch (part.kind) {
    case PartKind::update:
      return present("updateStep");
    case PartKind::configure:
      return present("configure");
    case PartKind::build: {
      const auto& errors = build.at("buildErrorsCount");  // -1 before the part
      return errors.is_number_integer() && errors.get<long>() >= 0 ? std::optional(part.rows) : std::nullopt;
    }
    case PartKind::test:
      return counted(total_of(build, "tests"));
    case PartKind::memory_check:
      return counted(total_of(build, "dynamicAnalyses"));
    case PartKind::upload:
      return counted(total_of(build, "files") + total_of(build, "urls"));
    case PartKind::notes:
      return counted(total_of(build, "notes"));
    case PartKind::coverage:
      break;
  }
  // Files without a line to cover leave no row.
  return total_of(build, "coverage") > 0 || part.rows == 0 ? std::optional(part.rows) : std::nullopt;
} catch (const nlohmann::json::exception& error) {
  throw BadData(
      fmt::format("what the server shows of {} is not what CDash's GraphQL gives: {}", part.name, error.what()));
}

std::string done_xml(const std::string& build_id) {
  return fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Done><buildId>{}</buildId><time>{}</time></Done>\n",
                     build_id, std::time(nullptr));
}

}  // namespace touchstone::dashboard

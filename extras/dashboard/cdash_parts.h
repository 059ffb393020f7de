// What a dashboard run left to be sent: the parts that ctest wrote, and what a server shows once it has processed them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::dashboard {

struct BuildName {
  std::string site, name, stamp;
};

// What ctest calls a part, and CDash processes as one.
enum class PartKind { update, configure, build, test, coverage, memory_check, notes, upload };

struct DashboardPart {
  PartKind kind = PartKind::update;
  std::string name;       // Update, Configure, Build, Test, Coverage, CoverageLog-0, MemCheck, Notes, Upload
  std::string file_name;  // as ctest calls the file
  std::string xml;
  std::size_t rows = 0;  // tests, files, notes: how many the server should show; 1 for the others
};

// A run kept by ci/dashboard_outbox.cmake: Testing/ as ctest wrote it, and notes/.
struct DashboardRun {
  std::filesystem::path folder;
  BuildName build;
  std::vector<DashboardPart> parts;  // in the order of sending
};

// Throws BadData naming the file if the run cannot be read or holds nothing to send.
DashboardRun load_dashboard_run(const std::filesystem::path& folder);

// The fields of GraphQL's type Build that remote_rows() needs.
std::string remote_fields();

// How many rows of the part a build shows: nothing where the server does not have the part (yet). Parts that leave no
// countable trace (CoverageLog) show as sent once their coverage is there. Throws BadData for an answer that CDash does
// not give.
std::optional<std::size_t> remote_rows(const nlohmann::json& build, const DashboardPart& part);

// The message that ends a build.
std::string done_xml(const std::string& build_id);

}  // namespace touchstone::dashboard

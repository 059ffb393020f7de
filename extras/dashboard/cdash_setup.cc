#include "cdash_setup.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "harness/base/error.h"

namespace touchstone::dashboard {

std::vector<std::string> set_up_project(CdashConnection& connection, const CdashSetup& wanted) {
  using nlohmann::json;
  const std::string& name = connection.server().project;
  std::vector<std::string> changes;
  try {
    const json project =
        connection
            .graphql(fmt::format("{{ project(name: {}) {{ id fileUploadLimit "
                                 "pinnedTestMeasurements(first: 1000) {{ edges {{ node {{ name }} }} }} }} }}",
                                 graphql_text(name)))
            .at("project");
    if (project.is_null())
      throw BadData(fmt::format("{}: there is no project '{}' that this token may see: make it on the server first",
                                connection.server().url, name));
    const std::string id = project.at("id").get<std::string>();
    for (const auto& group : wanted.groups) {
      const json made = connection.send_form("/api/v1/buildgroup.php",
                                             {{"project", name}, {"newbuildgroup", group}, {"type", "Daily"}});
      // Without the right to do so the server answers nothing at all.
      if (!made.is_object() || !made.contains("id"))
        throw BadData(
            fmt::format("{}: the group '{}' was not made: is the token a full-access one of an administrator of "
                        "'{}'?",
                        connection.server().url, group, name));
      changes.push_back(fmt::format("group {} (number {})", group, made.at("id").dump()));
    }
    if (project.at("fileUploadLimit").get<int>() < wanted.upload_quota_GiB) {
      connection.graphql(
          fmt::format("mutation {{ updateProject(input: {{id: {}, fileUploadLimit: {}}}) {{ message }} }}",
                      graphql_text(id), wanted.upload_quota_GiB));
      changes.push_back(fmt::format("upload quota {} GiB", wanted.upload_quota_GiB));
    }
    std::set<std::string> pinned;
    for (const auto& edge : project.at("pinnedTestMeasurements").at("edges"))
      pinned.insert(edge.at("node").at("name").get<std::string>());
    for (const auto& measurement : wanted.pinned) {
      if (pinned.contains(measurement)) continue;
      connection.graphql(
          fmt::format("mutation {{ createPinnedTestMeasurement(input: {{projectId: {}, name: {}}}) {{ message }} }}",
                      graphql_text(id), graphql_text(measurement)));
      changes.push_back("pinned measurement " + measurement);
    }
  } catch (const json::exception& error) {
    throw BadData(fmt::format("{}: the answer is not what CDash gives: {}", connection.server().url, error.what()));
  }
  return changes;
}

}  // namespace touchstone::dashboard

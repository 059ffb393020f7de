#include "ci/testing/stand_in_builds.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <stdexcept>

namespace touchstone::testing {
namespace {

std::vector<SubmittedTest> read_tests(const std::string& xml) {
  pugi::xml_document document;
  document.load_string(xml.c_str());
  std::vector<SubmittedTest> tests;
  for (const auto& node : document.child("Site").child("Testing").children("Test")) {
    SubmittedTest test{node.child_value("Name"), node.attribute("Status").value(), {}, {}};
    for (const auto& measured : node.child("Results").children("NamedMeasurement")) {
      const std::string name = measured.attribute("name").value();
      const std::string type = measured.attribute("type").value();
      if (type == "numeric/double") test.measurements[name] = measured.child_value("Value");
      if (type.starts_with("image/")) test.pictures.push_back(name);
    }
    tests.push_back(std::move(test));
  }
  return tests;
}

}  // namespace

int SubmittedBuilds::add(const std::string& project, const std::string& site, const std::string& name,
                         const std::string& stamp, const std::string& part, const std::string& xml) {
  const std::lock_guard lock(mutex_);
  const auto same = [&](const SubmittedBuild& b) {
    return b.project == project && b.site == site && b.name == name && b.stamp == stamp;
  };
  auto found = std::ranges::find_if(builds_, same);
  if (found != builds_.end() && found->done) {
    builds_.erase(found);
    ++deleted_;
    found = builds_.end();
  }
  if (found == builds_.end()) {
    builds_.push_back({next_id_++, project, site, name, stamp, {}, {}, false});
    found = std::prev(builds_.end());
  }
  ++found->parts[part];
  if (part == "Testing") {
    for (auto& test : read_tests(xml)) found->tests.push_back(std::move(test));
  }
  return found->id;
}

bool SubmittedBuilds::finish(int id) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(builds_, id, &SubmittedBuild::id);
  if (found == builds_.end()) return false;
  found->done = true;
  ++found->parts["Done"];
  return true;
}

std::vector<SubmittedBuild> SubmittedBuilds::all() const {
  const std::lock_guard lock(mutex_);
  return builds_;
}

int SubmittedBuilds::deleted() const {
  const std::lock_guard lock(mutex_);
  return deleted_;
}

std::string submission_kind(const std::string& xml) {
  pugi::xml_document document;
  if (const auto parsed = document.load_string(xml.c_str()); !parsed) throw std::invalid_argument(parsed.description());
  if (document.child("Done")) return "Done";
  if (document.child("Update")) return "Update";
  for (const char* const kind :
       {"Testing", "Build", "Configure", "Coverage", "CoverageLog", "DynamicAnalysis", "Notes", "Upload"}) {
    if (document.child("Site").child(kind)) return kind;
  }
  return document.child("Site") ? "Start" : "";
}

int done_build_id(const std::string& xml) {
  pugi::xml_document document;
  document.load_string(xml.c_str());
  return document.child("Done").child("buildId").text().as_int(0);
}

nlohmann::json to_json(const SubmittedBuild& build) {
  nlohmann::json tests = nlohmann::json::array();
  for (const auto& test : build.tests) {
    tests.push_back({{"name", test.name},
                     {"status", test.status},
                     {"measurements", test.measurements},
                     {"pictures", test.pictures}});
  }
  return {{"id", build.id},       {"project", build.project}, {"site", build.site}, {"name", build.name},
          {"stamp", build.stamp}, {"parts", build.parts},     {"done", build.done}, {"tests", tests}};
}

}  // namespace touchstone::testing

#include "ci/testing/cdash_model.h"

#include <algorithm>
#include <array>
#include <pugixml.hpp>
#include <stdexcept>

namespace touchstone::testing {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr int most_retries = 4;     // DoneHandler: RETRIES > 4 is the final attempt
constexpr int retry_base_ms = 100;  // QUEUE_RETRY_BASE is 5 s on a real server

json connected(const json& items) { return {{"connection", items}}; }

json measurements_of(const pugi::xml_node& test) {
  json all = json::array();
  for (const auto& measured : test.child("Results").children("NamedMeasurement")) {
    const std::string type = measured.attribute("type").value();
    const std::string name = measured.attribute("name").value();
    // TestingHandler keeps these elsewhere; pictures become images.
    if (type.find("image") != std::string::npos || name == "Execution Time" || name == "Exit Code" ||
        name == "Completion Status" || name == "Command Line")
      continue;
    all.push_back({{"id", std::to_string(all.size() + 1)},
                   {"name", name},
                   {"type", type},
                   {"value", measured.child_value("Value")}});
  }
  return all;
}

double decoded_size(const std::string& base64) {
  const auto digits =
      std::ranges::count_if(base64, [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '/'; });
  return static_cast<double>(digits) * 3.0 / 4.0;
}

}  // namespace

std::string cdash_part_kind(const std::string& xml) {
  constexpr std::array<std::pair<const char*, const char*>, 13> marks{{{"<Update", "Update"},
                                                                       {"<Build", "Build"},
                                                                       {"<Configure", "Configure"},
                                                                       {"<Testing", "Testing"},
                                                                       {"<CoverageLog", "CoverageLog"},
                                                                       {"<Coverage", "Coverage"},
                                                                       {"<report", "CoverageJUnit"},
                                                                       {"<Notes", "Notes"},
                                                                       {"<DynamicAnalysis", "DynamicAnalysis"},
                                                                       {"<Project", "Project"},
                                                                       {"<Upload", "Upload"},
                                                                       {"<testsuite", "TestJUnit"},
                                                                       {"<Done", "Done"}}};
  for (const auto& [mark, kind] : marks) {
    if (xml.find(mark) != std::string::npos) return kind;
  }
  return "";
}

CdashModel::CdashModel()
    : projects_{{.name = "Open",
                 .upload_quota_bytes = 1e9,
                 .groups = {"Nightly", "Continuous", "Experimental", "HIL"},
                 .pinned = {}},
                {.name = "Protected",
                 .is_public = false,
                 .authenticate_submissions = true,
                 .upload_quota_bytes = 1e9,
                 .pinned = {}},
                {.name = "New", .pinned = {}}},
      worker_([this] { work(); }) {}

CdashModel::~CdashModel() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  news_.notify_all();
  worker_.join();
}

void CdashModel::queue(const std::string& connection, int delay_ms) {
  const std::lock_guard lock(mutex_);
  queued_ = connection == "database";
  delay_ms_ = delay_ms;
}

void CdashModel::break_handler(const std::string& kind) {
  const std::lock_guard lock(mutex_);
  broken_ = kind;
}

CdashProject* CdashModel::project(const std::string& name) {
  const auto found = std::ranges::find(projects_, name, &CdashProject::name);
  return found == projects_.end() ? nullptr : &*found;
}

CdashModel::Build* CdashModel::find(int id) {
  const auto found = std::ranges::find(builds_, id, &Build::id);
  return found == builds_.end() ? nullptr : &*found;
}

CdashModel::Build* CdashModel::find(const CdashSubmission& s) {
  const auto found = std::ranges::find_if(builds_, [&](const Build& b) {
    return b.project == s.project && b.site == s.site && b.name == s.build && b.stamp == s.stamp;
  });
  return found == builds_.end() ? nullptr : &*found;
}

CdashModel::Build& CdashModel::add_build(const CdashSubmission& s) {
  Build build;
  build.id = next_build_++;
  build.project = s.project;
  build.site = s.site;
  build.name = s.build;
  build.stamp = s.stamp;
  const auto dash = s.stamp.find('-', s.stamp.find('-') + 1);
  build.type = dash == std::string::npos ? "Experimental" : s.stamp.substr(dash + 1);
  const auto* const in = project(s.project);
  build.group = std::ranges::find(in->groups, build.type) == in->groups.end() ? "Experimental" : build.type;
  // The parts' own times go by seconds; builds of one test follow one another faster, so the number orders them.
  std::array<char, 64> time{};
  std::snprintf(time.data(), time.size(), "%.4s-%.2s-%.2sT%.2s:%.2s:%02d+00:00", s.stamp.c_str(), s.stamp.c_str() + 4,
                s.stamp.c_str() + 6, s.stamp.c_str() + 9, s.stamp.c_str() + 11, build.id % 60);
  build.start_time = time.data();
  builds_.push_back(std::move(build));
  return builds_.back();
}

int CdashModel::submit(CdashSubmission submission) {
  std::unique_lock lock(mutex_);
  if (cdash_part_kind(submission.xml).empty())
    throw std::runtime_error("Could not determine submission file type for: 'inbox/file.xml'");
  Build* build = find(submission);
  if (build == nullptr) {
    build = &add_build(submission);
    pending_[build->id] = 0;
  }
  submission.build_id = build->id;
  const int id = build->id;
  if (pending_.contains(id)) ++pending_[id];  // a build that is done has no row
  if (queued_) {
    jobs_.emplace_back(Clock::now() + std::chrono::milliseconds(delay_ms_), std::move(submission));
    news_.notify_all();
  } else {
    process(std::move(submission));
  }
  return id;
}

void CdashModel::process(CdashSubmission submission) {
  const std::string kind = cdash_part_kind(submission.xml);
  if (kind == broken_) throw std::runtime_error("handler failed");
  if (kind != "Done") {
    handle_part(submission, kind);
    return;
  }
  if (!handle_done(submission)) return;
  if (pending_.contains(submission.build_id)) ++pending_[submission.build_id];
  ++submission.retries;
  if (queued_) {
    const auto delay = std::chrono::milliseconds(retry_base_ms * (1 << submission.retries));
    jobs_.emplace_back(Clock::now() + delay, std::move(submission));
  } else {
    process(std::move(submission));  // without a queue there is no later
  }
}

// True: to be queued again.
bool CdashModel::handle_done(CdashSubmission& submission) {
  pugi::xml_document document;
  document.load_string(submission.xml.c_str());
  const int id = document.child("Done").child("buildId").text().as_int(0);
  Build* const build = find(id);
  if (build == nullptr) throw std::runtime_error("No query results for model [App\\Models\\Build]");
  const bool waits = pending_.contains(id) && pending_[id] > 1;
  if (!waits) {
    build->done = true;
    ++build->parts["Done"];
    pending_.erase(id);
    return false;
  }
  --pending_[id];
  return submission.retries <= most_retries;
}

void CdashModel::handle_part(const CdashSubmission& submission, const std::string& kind) {
  pugi::xml_document document;
  document.load_string(submission.xml.c_str());
  const auto site = document.child("Site");
  if (kind == "Upload") {  // before any change: the transaction is rolled back
    for (const auto& file : site.child("Upload").children("File")) {
      const std::string name = file.attribute("filename").value();
      if (name.find('.', name.rfind('/') == std::string::npos ? 0 : name.rfind('/')) == std::string::npos)
        throw std::runtime_error("Undefined array key \"extension\"");
    }
  }
  Build* build = find(submission);
  if (build != nullptr && build->done) {  // RemoveIfDone
    pending_.erase(build->id);
    std::erase_if(builds_, [id = build->id](const Build& b) { return b.id == id; });
    ++deleted_;
    build = nullptr;
  }
  if (build == nullptr) build = &add_build(submission);
  ++build->parts[kind];
  const auto element = site.child(kind.c_str());
  if (kind == "Update")
    build->update = {
        {"id", "1"}, {"status", ""}, {"command", ""}, {"revision", document.child("Update").child_value("Revision")}};
  if (kind == "Update" && build->update["revision"] == "") build->update["revision"] = nullptr;
  if (kind == "Configure")
    build->configure = {{"id", "1"}, {"returnValue", element.child("ConfigureStatus").text().as_int()}};
  if (kind == "Build") {
    build->errors = std::max(build->errors, 0);
    build->warnings = std::max(build->warnings, 0);
    for (const auto& error [[maybe_unused]] : element.children("Error")) ++build->errors;
    for (const auto& warning [[maybe_unused]] : element.children("Warning")) ++build->warnings;
  }
  if (kind == "Testing") {
    for (const auto& test : element.children("Test"))
      build->tests.push_back({{"id", std::to_string(next_test_++)},
                              {"name", test.child_value("Name")},
                              {"status", std::string(test.attribute("Status").value()) == "notrun"   ? "NOT_RUN"
                                         : std::string(test.attribute("Status").value()) == "failed" ? "FAILED"
                                                                                                     : "PASSED"},
                              {"testMeasurements", measurements_of(test)}});
  }
  if (kind == "Notes") {
    for (const auto& note : element.children("Note")) {
      if (*note.child_value("Text") != '\0')
        build->notes.push_back(
            {{"id", "1"}, {"name", note.attribute("Name").value()}, {"text", note.child_value("Text")}});
    }
  }
  if (kind == "Coverage") {
    for (const auto& file : element.children("File"))
      build->coverage.push_back({{"id", "1"}, {"filePath", file.attribute("FullPath").value()}});
  }
  if (kind == "DynamicAnalysis") {
    for (const auto& test : element.children("Test"))
      build->analyses.push_back({{"id", "1"}, {"name", test.child_value("Name")}});
  }
  if (kind == "Upload") {
    for (const auto& file : element.children("File")) {
      const std::string name = file.attribute("filename").value();
      if (decoded_size(file.child_value("Content")) > project(submission.project)->upload_quota_bytes) break;
      (name.ends_with(".url") ? build->urls : build->files).push_back({{"id", "1"}, {"name", name}, {"href", name}});
    }
  }
  if (pending_.contains(build->id)) --pending_[build->id];
}

void CdashModel::work() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    const auto due = std::ranges::min_element(jobs_, {}, [](const auto& job) { return job.first; });
    if (due == jobs_.end()) {
      news_.wait(lock);
    } else if (due->first > Clock::now()) {
      news_.wait_until(lock, due->first);
    } else {
      CdashSubmission job = std::move(due->second);
      jobs_.erase(due);
      try {
        process(std::move(job));
      } catch (const std::runtime_error&) {
        ++failed_;  // the queue's failed_jobs: nobody is told
      }
    }
  }
}

json CdashModel::graphql_project(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const CdashProject* const found = project(name);
  if (found == nullptr) return nullptr;
  json builds = json::array();
  for (const Build& b : builds_) {
    if (b.project != name) continue;
    const auto count = [&](const char* status) {
      return std::ranges::count_if(b.tests, [&](const json& t) { return t["status"] == status; });
    };
    builds.push_back({{"id", std::to_string(b.id)},
                      {"name", b.name},
                      {"stamp", b.stamp},
                      {"buildType", b.type},
                      {"startTime", b.start_time},
                      {"site", {{"id", "1"}, {"name", b.site}}},
                      {"updateStep", b.update},
                      {"configure", b.configure},
                      {"buildErrorsCount", b.errors},
                      {"buildWarningsCount", b.warnings},
                      {"passedTestsCount", count("PASSED")},
                      {"failedTestsCount", count("FAILED")},
                      {"notRunTestsCount", count("NOT_RUN")},
                      {"tests", connected(b.tests)},
                      {"notes", connected(b.notes)},
                      {"files", connected(b.files)},
                      {"urls", connected(b.urls)},
                      {"coverage", connected(b.coverage)},
                      {"dynamicAnalyses", connected(b.analyses)}});
  }
  json pinned = json::array();
  for (const auto& one : found->pinned) pinned.push_back({{"id", one}, {"name", one}, {"position", pinned.size() + 1}});
  return {{"id", std::to_string(found - projects_.data() + 1)},
          {"name", name},
          {"fileUploadLimit", static_cast<int>(found->upload_quota_bytes / 1073741824.0)},
          {"builds", connected(builds)},
          {"pinnedTestMeasurements", connected(pinned)}};
}

json CdashModel::index(const std::string& project, const std::string& day) {
  const std::lock_guard lock(mutex_);
  std::map<std::string, json> groups;
  for (const Build& b : builds_) {
    if (b.project != project || !b.start_time.starts_with(day)) continue;
    groups[b.group].push_back({{"id", b.id}, {"done", b.done}, {"site", b.site}, {"buildname", b.name}});
  }
  json listed = json::array();
  for (const auto& [name, builds] : groups) listed.push_back({{"name", name}, {"builds", builds}});
  return {{"title", project}, {"buildgroups", listed}};
}

json CdashModel::test_graph(int id, const std::string& test, const std::string& measurement) {
  const std::lock_guard lock(mutex_);
  const Build* const build = find(id);
  const auto named = [&](const json& t) { return t["name"] == test; };
  if (build == nullptr || std::ranges::none_of(build->tests, named)) return nullptr;
  json data = json::array();
  for (const Build& other : builds_) {
    if (other.site != build->site || other.project != build->project || other.type != build->type ||
        other.name != build->name)
      continue;
    for (const auto& row : other.tests) {
      for (const auto& measured : row["testMeasurements"]) {
        if (named(row) && measured["name"] == measurement)
          data.push_back({{"buildtestid", std::stoi(row["id"].get<std::string>())},
                          {"x", 1700000000000LL + other.id * 60000LL},
                          {"y", measured["value"]}});
      }
    }
  }
  return json::array({{{"label", measurement}, {"data", data}}});
}

bool CdashModel::mark_done(int id) {
  const std::lock_guard lock(mutex_);
  Build* const build = find(id);
  if (build != nullptr) build->done = true;
  return build != nullptr;
}

json CdashModel::state() {
  const std::lock_guard lock(mutex_);
  json builds = json::array();
  for (const Build& b : builds_) {
    json tests = json::array();
    for (const auto& row : b.tests) {
      json values = json::object();
      for (const auto& measured : row["testMeasurements"])
        values[measured["name"].get<std::string>()] = measured["value"];
      tests.push_back({{"name", row["name"]}, {"status", row["status"]}, {"measurements", values}});
    }
    builds.push_back({{"id", b.id},
                      {"project", b.project},
                      {"site", b.site},
                      {"name", b.name},
                      {"stamp", b.stamp},
                      {"group", b.group},
                      {"parts", b.parts},
                      {"done", b.done},
                      {"tests", tests},
                      {"files", b.files.size() + b.urls.size()},
                      {"notes", b.notes.size()},
                      {"revision", b.update.is_object() ? b.update["revision"] : json()},
                      {"pending", pending_.contains(b.id) ? pending_[b.id] : 0}});
  }
  return {{"builds", builds}, {"deleted", deleted_}, {"failed_jobs", failed_}, {"queued", jobs_.size()}};
}

}  // namespace touchstone::testing

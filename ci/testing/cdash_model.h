// What a CDash 5.3.0 server does with submissions, for tests: written from its sources (tag v5.3.0 of
// github.com/Kitware/CDash, BSD 3-Clause), not from the client that is tested:
//   SubmissionController.php   what is checked in which order; AddBuild, then pending_submissions.numfiles + 1
//   Jobs/ProcessSubmission.php one transaction for each part; numfiles - 1 after it; a handler that throws leaves it up
//   Handlers/*.php             each but Done begins with RemoveIfDone and adds its rows to what is there
//   Handlers/DoneHandler.php   with numfiles > 1 it is queued again, at most five times, then given up
//   Handlers/UploadHandler.php a file without an extension throws; one above the quota ends the upload without a word
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace touchstone::testing {

struct CdashProject {
  std::string name;
  bool is_public = true;
  bool authenticate_submissions = false;
  double upload_quota_bytes = 10.0;  // app/Models/Project.php: the default of a new project
  std::vector<std::string> groups{"Nightly", "Continuous", "Experimental"};
  std::vector<std::string> pinned;
};

struct CdashSubmission {
  std::string project, site, build, stamp, xml;
  int build_id = 0;
  int retries = 0;
};

class CdashModel {
 public:
  CdashModel();
  ~CdashModel();
  CdashModel(const CdashModel&) = delete;
  CdashModel& operator=(const CdashModel&) = delete;

  // QUEUE_CONNECTION: "sync" parses a part before it is answered; "database", the default of a real server, later.
  void queue(const std::string& connection, int delay_ms);
  // The handler of this kind of part throws from now on.
  void break_handler(const std::string& kind);

  // The build's number; throws std::runtime_error where CDash answers 500.
  int submit(CdashSubmission submission);

  CdashProject* project(const std::string& name);
  // The project as GraphQL shows it; null if there is none.
  nlohmann::json graphql_project(const std::string& name);
  // api/v1/index.php: groups and their builds of one day (YYYY-MM-DD).
  nlohmann::json index(const std::string& project, const std::string& day);
  // api/v1/testGraph.php; null: "test not found".
  nlohmann::json test_graph(int build, const std::string& test, const std::string& measurement);
  bool mark_done(int build);
  nlohmann::json state();

 private:
  struct Build {
    int id = 0;
    std::string project, site, name, stamp, type, group, start_time;
    std::map<std::string, int> parts;
    nlohmann::json tests = nlohmann::json::array(), notes = nlohmann::json::array(), files = nlohmann::json::array(),
                   urls = nlohmann::json::array(), coverage = nlohmann::json::array(),
                   analyses = nlohmann::json::array(), update, configure;
    int errors = -1, warnings = -1;
    bool done = false;
  };

  Build* find(int id);
  Build* find(const CdashSubmission& submission);
  Build& add_build(const CdashSubmission& submission);
  void process(CdashSubmission submission);
  void handle_part(const CdashSubmission& submission, const std::string& kind);
  bool handle_done(CdashSubmission& submission);
  void work();

  std::mutex mutex_;
  std::condition_variable news_;
  std::vector<CdashProject> projects_;
  std::vector<Build> builds_;
  std::map<int, int> pending_;  // numfiles by build
  std::deque<std::pair<std::chrono::steady_clock::time_point, CdashSubmission>> jobs_;
  std::string broken_;
  int next_build_ = 1, next_test_ = 1, deleted_ = 0, failed_ = 0, delay_ms_ = 0;
  bool queued_ = false, ending_ = false;
  std::thread worker_;
};

// By the texts that SubmissionUtils::get_xml_type looks for, in its order; "" if it knows none.
std::string cdash_part_kind(const std::string& xml);

}  // namespace touchstone::testing

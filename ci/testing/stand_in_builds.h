// What a dashboard server remembers of its submissions: the builds, the parts that each was sent, and the tests with
// their measurements. Rules as seen of CDash 5.3: a part sent again before Done adds its rows a second time; a part
// sent after Done deletes the build and starts it anew.
#pragma once

#include <map>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace touchstone::testing {

struct SubmittedTest {
  std::string name;
  std::string status;
  std::map<std::string, std::string> measurements;  // numeric ones
  std::vector<std::string> pictures;                // their names
};

struct SubmittedBuild {
  int id = 0;
  std::string project, site, name, stamp;
  std::map<std::string, int> parts;  // how often each was sent since the build began
  std::vector<SubmittedTest> tests;
  bool done = false;
};

class SubmittedBuilds {
 public:
  // Returns the build's number. `part` is the root of what was sent: Testing, Build, Configure, ...
  int add(const std::string& project, const std::string& site, const std::string& name, const std::string& stamp,
          const std::string& part, const std::string& xml);
  // False when there is no such build.
  bool finish(int id);
  [[nodiscard]] std::vector<SubmittedBuild> all() const;
  [[nodiscard]] int deleted() const;

 private:
  mutable std::mutex mutex_;
  std::vector<SubmittedBuild> builds_;
  int next_id_ = 1;
  int deleted_ = 0;
};

// The kind of submission by its root elements; "" when a server would not recognise it. Throws std::invalid_argument
// when the text is not well-formed XML.
std::string submission_kind(const std::string& xml);
int done_build_id(const std::string& xml);

nlohmann::json to_json(const SubmittedBuild& build);

}  // namespace touchstone::testing

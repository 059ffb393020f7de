// A stand-in for a CDash server on loopback, for the tests of the dashboard script: answers as CDash 5.3 was seen to
// (submission, token, MD5, refusals, test graph, GraphQL), keeps what it was sent in a folder, and misbehaves on
// request.
//   cdash_stand_in FOLDER     writes FOLDER/port, then one file per accepted submission; ends at POST /quit
// Projects: Open, and Protected, whose token is "token-of-the-test".
//   POST /behave?mode=ok|error500|malformed|database-down|slow|cut[&count=N]   the next N submissions (default: all)
//   GET /state    the builds as JSON
#include <httplib.h>
#include <openssl/evp.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "ci/testing/stand_in_builds.h"

namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;
using touchstone::testing::SubmittedBuilds;

constexpr int bad_request = 400;
constexpr int forbidden = 403;
constexpr int not_found = 404;
constexpr int server_error = 500;

struct Behaviour {
  std::mutex mutex;
  std::string mode = "ok";
  int count = -1;  // how many more; negative: for ever

  std::string next() {
    const std::lock_guard lock(mutex);
    if (mode == "ok") return mode;
    std::string now = mode;
    if (count > 0 && --count == 0) mode = "ok";
    return now;
  }
};

std::string md5(const std::string& text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_md5(), nullptr);
  std::string hex;
  for (unsigned int i = 0; i < size; ++i) {
    constexpr std::string_view digits = "0123456789abcdef";
    hex += digits[digest[i] >> 4U];
    hex += digits[digest[i] & 15U];
  }
  return hex;
}

void refuse(Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(json{{"status", 1}, {"description", why}}.dump(), "application/json");
}

void answer(Response& response, const std::string& message, int build, const std::string& hash) {
  response.set_content(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<cdash version=\"5.3.0\">\n <status>OK</status>\n <message>" +
          message + "</message>\n <md5>" + hash + "</md5>\n <buildId>" + std::to_string(build) +
          "</buildId>\n</cdash>\n",
      "text/xml");
}

class Server {
 public:
  explicit Server(std::string folder) : folder_(std::move(folder)) {
    server_.Put("/submit.php", [this](const Request& q, Response& r) { submit(q, r); });
    server_.Get("/state", [this](const Request&, Response& r) { state(r); });
    server_.Get("/api/v1/testGraph.php", [this](const Request& q, Response& r) { graph(q, r); });
    server_.Post("/graphql", [this](const Request& q, Response& r) { graphql(q, r); });
    server_.Post("/behave", [this](const Request& q, Response&) {
      const std::lock_guard lock(behaviour_.mutex);
      behaviour_.mode = q.get_param_value("mode");
      behaviour_.count = q.has_param("count") ? std::stoi(q.get_param_value("count")) : -1;
    });
    server_.Post("/quit", [this](const Request&, Response&) { server_.stop(); });
  }

  int run() {
    const int port = server_.bind_to_any_port("127.0.0.1");
    if (port < 0) return 1;
    std::ofstream(folder_ + "/port.part") << port << '\n';
    std::rename((folder_ + "/port.part").c_str(), (folder_ + "/port").c_str());
    return server_.listen_after_bind() ? 0 : 1;
  }

 private:
  void submit(const Request& request, Response& response) {
    const std::string mode = behaviour_.next();
    ++requests_;
    const std::string project = request.get_param_value("project");
    if (project.empty()) return refuse(response, bad_request, "No project specified.");
    if (project != "Open" && project != "Protected")
      return refuse(response, not_found, "The requested project does not exist.");
    if (project == "Protected" && request.get_header_value("Authorization") != "Bearer token-of-the-test") {
      return refuse(response, forbidden, "Invalid Token");
    }
    if (mode == "error500") return refuse(response, server_error, "Internal error.");
    const std::string hash = md5(request.body);
    if (mode == "malformed" || (request.has_param("MD5") && request.get_param_value("MD5") != hash)) {
      return refuse(response, bad_request,
                    "md5 mismatch. expected: " + request.get_param_value("MD5") + ", received: " + hash);
    }
    if (mode == "slow") std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    accept(request, response, mode, project, hash);
    if (mode == "cut") {  // it arrived, the answer does not
      response.body.clear();
      response.set_content_provider(1000, "text/xml",
                                    [](std::size_t, std::size_t, httplib::DataSink&) { return false; });
    }
  }

  void accept(const Request& request, Response& response, const std::string& mode, const std::string& project,
              const std::string& hash) {
    std::string kind;
    try {
      kind = touchstone::testing::submission_kind(request.body);
    } catch (const std::invalid_argument& error) {
      return refuse(response, bad_request, std::string("The XML is malformed: ") + error.what());
    }
    if (kind.empty()) return refuse(response, server_error, "Unrecognised XML.");
    std::ofstream(folder_ + "/" + std::to_string(++files_) + "-" + kind + ".xml", std::ios::binary) << request.body;
    int build = 0;
    if (kind == "Done") {
      build = touchstone::testing::done_build_id(request.body);
      if (!builds_.finish(build)) return refuse(response, bad_request, "Done for a build that does not exist.");
    } else {
      build = builds_.add(project, request.get_param_value("site"), request.get_param_value("build"),
                          request.get_param_value("stamp"), kind, request.body);
    }
    answer(response, mode == "database-down" ? "Database is unavailable." : "", build, hash);
  }

  void state(Response& response) {
    json builds = json::array();
    for (const auto& build : builds_.all()) builds.push_back(to_json(build));
    response.set_content(
        json{{"builds", builds}, {"deleted", builds_.deleted()}, {"requests", requests_.load()}}.dump(1) + "\n",
        "application/json");
  }

  // [{"label": "rms", "data": [{"buildtestid": 1, "x": milliseconds, "y": "0.1"}]}]; here a test's number is its place
  // + 1.
  void graph(const Request& request, Response& response) {
    const auto builds = builds_.all();
    const std::size_t wanted = std::stoul("0" + request.get_param_value("testid"));
    const int build_id = std::stoi("0" + request.get_param_value("buildid"));
    const auto build = std::ranges::find(builds, build_id, &touchstone::testing::SubmittedBuild::id);
    if (build == builds.end() || wanted == 0 || wanted > build->tests.size())
      return refuse(response, not_found, "test not found");
    if (request.get_param_value("type") != "measurement")
      return refuse(response, bad_request, "Invalid type of graph requested.");
    const std::string measurement = request.get_param_value("measurementname");
    json data = json::array();
    for (const auto& other : builds) {
      for (const auto& test : other.tests) {
        const auto value = test.measurements.find(measurement);
        if (test.name != build->tests[wanted - 1].name || value == test.measurements.end()) continue;
        data.push_back(
            {{"buildtestid", other.id * 1000}, {"x", 1700000000000LL + other.id * 60000LL}, {"y", value->second}});
      }
    }
    response.set_content(json::array({json{{"label", measurement}, {"data", data}}}).dump(), "application/json");
  }

  // Answers the one query that `touchstone history` asks, two builds to a page; only its variables are read.
  void graphql(const Request& request, Response& response) {
    constexpr std::size_t page = 2;
    const json asked = json::parse(request.body, nullptr, false);
    if (asked.is_discarded() || !asked.contains("variables")) return refuse(response, bad_request, "Syntax error");
    const auto& variables = asked["variables"];
    const auto builds = builds_.all();
    const std::size_t first = variables["after"].is_string() ? std::stoul(variables["after"].get<std::string>()) : 0;
    json edges = json::array();
    for (std::size_t i = first; i < std::min(first + page, builds.size()); ++i) {
      json tests = json::array();
      for (const auto& test : builds[i].tests) {
        if (test.name != variables["test"]) continue;
        json values = json::array();
        for (const auto& [name, value] : test.measurements) values.push_back({{"name", name}, {"value", value}});
        tests.push_back({{"node", {{"testMeasurements", values}}}});
      }
      const auto minute = std::to_string(10 + builds[i].id % 50);
      edges.push_back({{"node",
                        {{"id", std::to_string(builds[i].id)},
                         {"startTime", "2026-01-01T00:" + minute + ":00+00:00"},
                         {"name", builds[i].name},
                         {"updateStep", {{"revision", "commit" + std::to_string(builds[i].id)}}},
                         {"tests", {{"edges", tests}}}}}});
    }
    const bool more = first + page < builds.size();
    const json connection{{"edges", edges},
                          {"pageInfo", {{"hasNextPage", more}, {"endCursor", std::to_string(first + page)}}}};
    const json project = variables["project"] == "Open" ? json{{"builds", connection}} : json(nullptr);
    response.set_content(json{{"data", {{"project", project}}}}.dump(), "application/json");
  }

  std::string folder_;
  httplib::Server server_;
  Behaviour behaviour_;
  SubmittedBuilds builds_;
  std::atomic<int> requests_{0};
  std::atomic<int> files_{0};
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: cdash_stand_in FOLDER\n";
    return 2;
  }
  return Server(argv[1]).run();
}

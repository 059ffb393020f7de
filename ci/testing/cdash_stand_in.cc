// A stand-in for a CDash 5.3.0 server on loopback, for the tests of the dashboard. Written from its sources (tag v5.3.0
// of github.com/Kitware/CDash, BSD 3-Clause): what submissions do is in cdash_model.h; here are the answers on the wire
//   SubmissionController.php     the order of checks and their texts; resources/views/submission/xml-response.blade.php
//   Middleware/AuthenticateToken.php   api/v1 takes bearer tokens of full access and logs in: the session's cookie
//   config/lighthouse.php        /graphql takes the session only, by POST, and no token
//   TestController.php           testGraph.php: buildid and testname; 404 "test not found"
//   public/api/v1/buildgroup.php, GraphQL/Mutations, BuildController.php   for administrators only
//
//   cdash_stand_in FOLDER     writes FOLDER/port, then one file per submission taken; ends at POST /quit
// Projects: Open; Protected (private, authenticated submissions); New (public, as made: a quota of ten bytes, no HIL).
// Tokens: "token-of-the-test" (full access, administrator), "submit-only".
//   POST /behave?mode=ok|html|error500|malformed|database-down|slow|cut|torn[&count=N]   the next N submissions
//   (default: all)
//     html: a log-in page of a proxy; malformed: damaged on the way; cut: it arrives, the answer does not; torn:
//     neither
//   POST /queue?connection=sync|database[&delay_ms=N]     POST /break?kind=Testing: that handler throws
//   GET /state    the builds as JSON
#include <httplib.h>
#include <openssl/evp.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <iostream>
#include <set>
#include <thread>

#include "ci/testing/cdash_model.h"
#include "ci/testing/graphql_answer.h"

namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;
using touchstone::testing::CdashModel;

constexpr int bad_request = 400;
constexpr int forbidden = 403;
constexpr int not_found = 404;
constexpr int server_error = 500;
constexpr const char* full_access = "token-of-the-test";
constexpr const char* submit_only = "submit-only";

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
  std::string now() {
    const std::lock_guard lock(mutex);
    return mode;
  }
};

std::string md5_of(const std::string& text) {
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

std::string bearer(const Request& request) {
  const std::string header = request.get_header_value("Authorization");
  return header.starts_with("Bearer ") ? header.substr(7) : "";
}

class Server {
 public:
  explicit Server(std::string folder) : folder_(std::move(folder)) {
    server_.Put("/submit.php", [this](const Request& q, Response& r) { submit(q, r); });
    server_.Get("/api/v1/index.php", api([this](const Request& q, Response& r) { index(q, r); }));
    server_.Get("/api/v1/testGraph.php", api([this](const Request& q, Response& r) { graph(q, r); }));
    server_.Post("/api/v1/buildgroup.php", api([this](const Request& q, Response& r) { group(q, r); }));
    server_.Post("/api/v1/build.php", api([this](const Request& q, Response& r) { build(q, r); }));
    server_.Post("/graphql", [this](const Request& q, Response& r) { graphql(q, r); });
    server_.Get("/state", [this](const Request&, Response& r) { state(r); });
    server_.Post("/behave", [this](const Request& q, Response&) {
      const std::lock_guard lock(behaviour_.mutex);
      behaviour_.mode = q.get_param_value("mode");
      behaviour_.count = q.has_param("count") ? std::stoi(q.get_param_value("count")) : -1;
    });
    server_.Post("/queue", [this](const Request& q, Response&) {
      model_.queue(q.get_param_value("connection"), std::stoi("0" + q.get_param_value("delay_ms")));
    });
    server_.Post("/break", [this](const Request& q, Response&) { model_.break_handler(q.get_param_value("kind")); });
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
  using Handler = std::function<void(const Request&, Response&)>;

  // A token of full access logs in and gets a session; away without the database.
  Handler api(Handler inner) {
    return [this, inner = std::move(inner)](const Request& request, Response& response) {
      if (behaviour_.now() == "database-down") return refuse(response, server_error, "Server Error");
      if (bearer(request) == full_access) {
        const std::lock_guard lock(sessions_mutex_);
        const std::string session = "session-" + std::to_string(sessions_.size() + 1);
        sessions_.insert(session);
        response.set_header("Set-Cookie",
                            "cdash_session=" + session + "; expires=never; path=/; httponly; samesite=lax");
      }
      inner(request, response);
    };
  }
  bool session_of(const Request& request) {
    const std::string cookies = request.get_header_value("Cookie");
    const std::lock_guard lock(sessions_mutex_);
    return std::ranges::any_of(sessions_, [&](const std::string& session) {
      const auto at = cookies.find("cdash_session=" + session);
      const auto end = at + 14 + session.size();
      return at != std::string::npos && (end == cookies.size() || cookies[end] == ';');
    });
  }
  bool may_see(const std::string& project, bool logged_in) {
    const auto* const found = model_.project(project);
    return found != nullptr && (found->is_public || logged_in);
  }

  void submit(const Request& request, Response& response) {
    ++requests_;
    const std::string mode = behaviour_.next();
    if (mode == "html") return response.set_content("<!DOCTYPE html><html><title>Log in</title></html>", "text/html");
    if (mode == "torn") return lose_answer(response);
    const std::string project = request.get_param_value("project");
    if (project.empty()) return refuse(response, bad_request, "No project name provided.");
    const std::string expected = request.get_param_value("MD5");
    const std::string received = mode == "malformed" ? md5_of(request.body + "damaged") : md5_of(request.body);
    if (!expected.empty() && expected != received)
      return refuse(response, bad_request, "md5 mismatch. expected: " + expected + ", received: " + received);
    if (mode == "database-down") return answer(response, "Database is unavailable.", 0);
    const auto* const found = model_.project(project);
    if (found == nullptr) return refuse(response, not_found, "The requested project does not exist.");
    if (found->authenticate_submissions && bearer(request) != full_access && bearer(request) != submit_only)
      return refuse(response, forbidden, "Invalid Token");
    if (mode == "error500") return refuse(response, server_error, "Internal error.");
    if (mode == "slow") std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    try {
      const int id = model_.submit({project, request.get_param_value("site"), request.get_param_value("build"),
                                    request.get_param_value("stamp"), request.body});
      const std::string kind = touchstone::testing::cdash_part_kind(request.body);
      std::ofstream(folder_ + "/" + std::to_string(++files_) + "-" + kind + ".xml", std::ios::binary) << request.body;
      answer(response, "", id);
    } catch (const std::runtime_error& error) {
      refuse(response, server_error, error.what());
    }
    if (mode == "cut") lose_answer(response);
  }

  static void answer(Response& response, const std::string& message, int build) {
    response.set_content("<cdash version=\"5.3.0\">\n    <message>" + message +
                             "</message>\n    <status>OK</status>\n" +
                             (build > 0 ? "    <buildId>" + std::to_string(build) + "</buildId>\n" : "") + "</cdash>\n",
                         "text/xml");
  }
  static void lose_answer(Response& response) {
    response.body.clear();
    response.set_content_provider(1000, "text/xml", [](std::size_t, std::size_t, httplib::DataSink&) { return false; });
  }

  void index(const Request& request, Response& response) {
    const std::string project = request.get_param_value("project");
    if (!may_see(project, bearer(request) == full_access || session_of(request)))
      return response.set_content(json{{"requirelogin", 1}}.dump(), "application/json");
    response.set_content(model_.index(project, request.get_param_value("date")).dump(), "application/json");
  }

  void graph(const Request& request, Response& response) {
    if (!request.has_param("buildid")) return refuse(response, bad_request, "\"buildid\" parameter is required.");
    const json found =
        model_.test_graph(std::stoi("0" + request.get_param_value("buildid")), request.get_param_value("testname"),
                          request.get_param_value("measurementname"));
    if (found.is_null()) return refuse(response, not_found, "test not found");
    if (request.get_param_value("type") != "measurement")
      return refuse(response, bad_request, "Invalid type of graph requested.");
    response.set_content(found.dump(), "application/json");
  }

  void group(const Request& request, Response& response) {
    auto* const project = model_.project(request.get_param_value("project"));
    if (project == nullptr) return refuse(response, not_found, "Project does not exist");
    if (bearer(request) != full_access) {  // can_administrate_project: the page simply ends
      response.status = 204;
      return;
    }
    const std::string name = request.get_param_value("newbuildgroup");
    const bool is_new = std::ranges::find(project->groups, name) == project->groups.end();
    if (is_new) project->groups.push_back(name);
    response.set_content(json{{"id", project->groups.size()}, {"name", name}, {"autoremovetimeframe", 0}}.dump(),
                         "application/json");
    response.status = is_new ? 201 : 200;
  }

  void build(const Request& request, Response& response) {
    if (bearer(request) != full_access) return refuse(response, forbidden, "This action is unauthorized.");
    if (!model_.mark_done(std::stoi("0" + request.get_param_value("buildid"))))
      return refuse(response, not_found, "no build");
    response.set_content("[]", "application/json");
  }

  void graphql(const Request& request, Response& response) {
    if (behaviour_.now() == "database-down") return refuse(response, server_error, "Server Error");
    const json asked = json::parse(request.body, nullptr, false);
    if (asked.is_discarded() || !asked.contains("query")) return refuse(response, bad_request, "Syntax error");
    json data = json::object();
    try {
      const auto query = touchstone::testing::parse_graphql(asked["query"], asked.value("variables", json::object()));
      for (const auto& field : query.fields)
        data[field.name] = query.mutation ? mutation(field, session_of(request)) : top(field, session_of(request));
    } catch (const std::exception& error) {
      response.set_content(json{{"errors", json::array({{{"message", error.what()}}})}}.dump(), "application/json");
      return;
    }
    response.set_content(json{{"data", data}}.dump(), "application/json");
  }
  json top(const touchstone::testing::GraphqlField& field, bool logged_in) {
    if (field.name != "project")
      throw std::invalid_argument("Cannot query field \"" + field.name + "\" on type \"Query\".");
    const std::string name = field.arguments.value("name", "");
    if (!may_see(name, logged_in)) return nullptr;
    return touchstone::testing::graphql_value(model_.graphql_project(name), field);
  }
  json mutation(const touchstone::testing::GraphqlField& field, bool logged_in) {
    if (!logged_in) throw std::invalid_argument("This action is unauthorized.");
    const json input = field.arguments.at("input");
    const std::array names{"Open", "Protected", "New"};
    const bool pin = field.name == "createPinnedTestMeasurement";
    const std::string id = input.at(pin ? "projectId" : "id");
    auto* const project = model_.project(names.at(std::stoul(id) - 1));
    if (pin) {
      project->pinned.push_back(input.at("name"));
    } else if (field.name == "updateProject") {
      project->upload_quota_bytes = input.at("fileUploadLimit").get<double>() * 1073741824.0;
    } else {
      throw std::invalid_argument("Cannot query field \"" + field.name + "\" on type \"Mutation\".");
    }
    return {{"message", nullptr}};
  }

  void state(Response& response) {
    json state = model_.state();
    state["requests"] = requests_.load();
    response.set_content(state.dump(1) + "\n", "application/json");
  }

  std::string folder_;
  CdashModel model_;
  httplib::Server server_;
  Behaviour behaviour_;
  std::mutex sessions_mutex_;
  std::set<std::string> sessions_;
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

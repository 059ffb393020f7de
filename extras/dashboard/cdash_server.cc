#include "cdash_server.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "harness/base/error.h"

namespace touchstone::dashboard {
namespace {

using nlohmann::json;

constexpr long first_error_status = 400;
constexpr long status_unauthorized = 401;
constexpr long status_forbidden = 403;

std::string from_environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string token_from_environment() {
  if (auto token = from_environment("TOUCHSTONE_CDASH_TOKEN"); !token.empty()) return token;
  const std::string file = from_environment("TOUCHSTONE_CDASH_TOKEN_FILE");
  if (file.empty()) return "";
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line) || line.empty())
    throw BadData(
        fmt::format("TOUCHSTONE_CDASH_TOKEN_FILE: {}: its first line should hold the token, and cannot be read", file));
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
  return line;
}

std::string joined(const std::vector<std::string>& cookies) {
  std::string all;
  for (const auto& cookie : cookies) all += (all.empty() ? "" : "; ") + cookie;
  return all;
}

}  // namespace

CdashServer cdash_from_environment(CdashServer given) {
  if (given.url.empty()) given.url = from_environment("TOUCHSTONE_CDASH_URL");
  while (given.url.ends_with('/')) given.url.pop_back();
  if (given.project.empty()) given.project = from_environment("TOUCHSTONE_CDASH_PROJECT");
  if (given.project.empty()) given.project = "Touchstone";
  if (given.token.empty()) given.token = token_from_environment();
  return given;
}

std::string graphql_text(std::string_view text) { return json(text).dump(); }

WebRequest CdashConnection::request(const std::string& path) {
  WebRequest request;
  request.url = server_.url + path;
  if (!server_.token.empty()) request.headers.push_back("Authorization: Bearer " + server_.token);
  if (!cookies_.empty()) request.headers.push_back("Cookie: " + cookies_);
  return request;
}

json CdashConnection::checked(const std::string& path, const WebAnswer& answer) const {
  const std::string place = server_.url + path.substr(0, path.find('?'));
  if (answer.outcome != WebOutcome::answered) throw BadData(fmt::format("{}: {}", place, answer.problem));
  if (answer.status >= first_error_status) {
    const bool token = answer.status == status_unauthorized || answer.status == status_forbidden;
    throw BadData(fmt::format("{}: the server answers {}: {}{}", place, answer.status, answer.text.substr(0, 300),
                              token ? " (is the token right, and may it read? TOUCHSTONE_CDASH_TOKEN)" : ""));
  }
  if (answer.text.empty()) return nullptr;
  json document = json::parse(answer.text, nullptr, false);
  if (document.is_discarded())
    throw BadData(
        fmt::format("{}: the answer is not JSON but '{}'; is this a CDash server, and no log-in page before it?", place,
                    answer.text.substr(0, 60)));
  return document;
}

void CdashConnection::begin_session() {
  if (session_ || server_.token.empty()) return;
  session_ = true;
  const std::string path = "/api/v1/index.php?project=" + percent_encoded(server_.project);
  const WebAnswer answer = web_request(request(path));
  // A project that this token may not see is said so by the question itself: only the cookie matters here.
  if (answer.outcome != WebOutcome::answered) throw BadData(fmt::format("{}: {}", server_.url, answer.problem));
  cookies_ = joined(answer.cookies);
}

json CdashConnection::graphql(const std::string& query) {
  begin_session();
  WebRequest asked = request("/graphql");
  asked.headers.emplace_back("Content-Type: application/json");
  asked.headers.emplace_back("X-Requested-With: XMLHttpRequest");
  asked.body = json{{"query", query}}.dump();
  json answer = checked("/graphql", web_request(asked));
  if (answer.contains("errors"))
    throw BadData(fmt::format("{}/graphql: {}", server_.url, answer["errors"].dump().substr(0, 400)));
  if (!answer.contains("data"))
    throw BadData(fmt::format("{}/graphql: the answer has no data: {}", server_.url, answer.dump().substr(0, 200)));
  return answer["data"];
}

json CdashConnection::get(const std::string& path) { return checked(path, web_request(request(path))); }

json CdashConnection::send_form(const std::string& path,
                                const std::vector<std::pair<std::string, std::string>>& fields) {
  WebRequest asked = request(path);
  asked.headers.emplace_back("Content-Type: application/x-www-form-urlencoded");
  std::string body;
  for (const auto& [name, value] : fields)
    body += (body.empty() ? "" : "&") + percent_encoded(name) + "=" + percent_encoded(value);
  asked.body = body;
  return checked(path, web_request(asked));
}

WebAnswer CdashConnection::submit(const std::string& query, const std::string& body) {
  WebRequest asked = request("/submit.php?project=" + percent_encoded(server_.project) + query);
  asked.headers.emplace_back("Content-Type: text/xml");
  asked.headers.emplace_back("Expect:");
  asked.body = body;
  asked.put = true;
  asked.timeout_ms = 600'000;  // pictures and logs of a whole run
  return web_request(asked);
}

}  // namespace touchstone::dashboard

// A connection to a CDash server of version 5.3 or later: submissions, its REST interface (api/v1) and GraphQL.
//
// /graphql takes no bearer token; api/v1 does (app/Http/Middleware/AuthenticateToken.php) and hands out a session
// cookie, with which /graphql answers for private projects too. The session is begun before the first question.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/web_request.h"

namespace touchstone::dashboard {

struct CdashServer {
  std::string url;      // http(s)://host/path, without a trailing slash
  std::string project;  // its name on the server
  std::string token;    // empty for an open project; goes into a header only
};

// What is empty in `given` comes from the environment: TOUCHSTONE_CDASH_URL, TOUCHSTONE_CDASH_PROJECT (else
// "Touchstone"), and TOUCHSTONE_CDASH_TOKEN or the first line of the file TOUCHSTONE_CDASH_TOKEN_FILE. Throws BadData
// if the file cannot be read; an empty url stays empty.
CdashServer cdash_from_environment(CdashServer given);

// The text as a literal of GraphQL.
std::string graphql_text(std::string_view text);

class CdashConnection {
 public:
  explicit CdashConnection(CdashServer server) : server_(std::move(server)) {}
  [[nodiscard]] const CdashServer& server() const noexcept { return server_; }

  // "data" of the answer. Throws BadData if the server cannot be reached, refuses, or answers with something else.
  nlohmann::json graphql(const std::string& query);
  nlohmann::json get(const std::string& path);
  // POST of a form's fields, or the method given; the answer may be empty (null).
  nlohmann::json send_form(const std::string& path, const std::vector<std::pair<std::string, std::string>>& fields);
  // PUT of a part to submit.php; the caller judges the answer.
  WebAnswer submit(const std::string& query, const std::string& body);

 private:
  WebRequest request(const std::string& path);
  nlohmann::json checked(const std::string& path, const WebAnswer& answer) const;
  void begin_session();

  CdashServer server_;
  std::string cookies_;
  bool session_ = false;
};

}  // namespace touchstone::dashboard

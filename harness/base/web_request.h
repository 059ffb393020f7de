// One HTTP request, through libcurl. The library is loaded at the first request: it brings thirty others with it, whose
// loading would cost every start of the program more than a comparison takes, and hardly any run needs it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace touchstone {

struct WebRequest {
  std::string url;
  std::vector<std::string> headers;  // "Content-Type: application/json"
  std::optional<std::string> body;   // given: POST, else GET
  bool put = false;                  // the body by PUT
  long connect_timeout_ms = 10'000;
  long timeout_ms = 60'000;   // of the whole exchange
  bool encrypted_too = true;  // https as well as http
  bool use_proxy = true;      // as the environment says
  std::size_t largest_answer_bytes = std::size_t{64} << 20U;
};

enum class WebOutcome : std::uint8_t { answered, unreachable, timed_out, failed };

struct WebAnswer {
  WebOutcome outcome = WebOutcome::failed;
  long status = 0;                   // HTTP's, where there was an answer
  std::string text;                  // the answer's body
  std::vector<std::string> cookies;  // "name=value", as the server sets them
  std::string problem;               // what went wrong where there was none
};

// Never throws for what the network or the server does; throws BadData where libcurl is not installed.
WebAnswer web_request(const WebRequest& request);

// The text as it may stand inside a URL's query.
std::string percent_encoded(const std::string& text);

}  // namespace touchstone

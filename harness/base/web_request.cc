#include "harness/base/web_request.h"

#include <curl/curl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <string_view>

#include "harness/base/error.h"
#include "harness/base/loaded_library.h"

namespace touchstone {
namespace {

// curl.h wraps some calls in macros of the same name.
#undef curl_easy_setopt
#undef curl_easy_getinfo

class Curl {
 public:
  static const Curl& library() {
    static const Curl curl;
    return curl;
  }
  decltype(&curl_easy_init) easy_init = nullptr;
  decltype(&curl_easy_cleanup) easy_cleanup = nullptr;
  decltype(&curl_easy_setopt) easy_setopt = nullptr;
  decltype(&curl_easy_perform) easy_perform = nullptr;
  decltype(&curl_easy_getinfo) easy_getinfo = nullptr;
  decltype(&curl_easy_strerror) easy_strerror = nullptr;
  decltype(&curl_slist_append) slist_append = nullptr;
  decltype(&curl_slist_free_all) slist_free_all = nullptr;

 private:
  Curl() {
    const LoadedLibrary library("libcurl.so.4", "asks servers", "libcurl4");
    library.find(easy_init, "curl_easy_init");
    library.find(easy_cleanup, "curl_easy_cleanup");
    library.find(easy_setopt, "curl_easy_setopt");
    library.find(easy_perform, "curl_easy_perform");
    library.find(easy_getinfo, "curl_easy_getinfo");
    library.find(easy_strerror, "curl_easy_strerror");
    library.find(slist_append, "curl_slist_append");
    library.find(slist_free_all, "curl_slist_free_all");
    decltype(&curl_global_init) global_init = nullptr;
    library.find(global_init, "curl_global_init");
    global_init(CURL_GLOBAL_DEFAULT);
  }
};

struct Collected {
  std::string text;
  std::size_t most;
};

std::size_t collect(char* data, std::size_t size, std::size_t count, void* to) {
  auto& collected = *static_cast<Collected*>(to);
  if (collected.text.size() + size * count > collected.most) return 0;  // curl then fails the transfer
  collected.text.append(data, size * count);
  return size * count;
}

// Called once for each header line.
std::size_t collect_cookies(char* data, std::size_t size, std::size_t count, void* to) {
  const std::string_view line(data, size * count);
  constexpr std::string_view name = "set-cookie:";
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  if (line.size() > name.size() &&
      std::equal(name.begin(), name.end(), line.begin(), [&](char a, char b) { return same(b, a); })) {
    const std::string_view rest = line.substr(std::min(line.find_first_not_of(' ', name.size()), line.size()));
    static_cast<std::vector<std::string>*>(to)->emplace_back(rest.substr(0, rest.find_first_of(";\r\n")));
  }
  return size * count;
}

WebOutcome outcome_of(CURLcode code) {
  switch (code) {
    case CURLE_OK:
      return WebOutcome::answered;
    case CURLE_COULDNT_CONNECT:
    case CURLE_COULDNT_RESOLVE_HOST:
      return WebOutcome::unreachable;
    case CURLE_OPERATION_TIMEDOUT:
      return WebOutcome::timed_out;
    default:
      return WebOutcome::failed;
  }
}

}  // namespace

WebAnswer web_request(const WebRequest& request) {
  const Curl& curl = Curl::library();
  const std::unique_ptr<CURL, decltype(curl.easy_cleanup)> easy(curl.easy_init(), curl.easy_cleanup);
  if (!easy) throw BadData("libcurl cannot be started");
  curl_slist* list = nullptr;
  for (const std::string& header : request.headers) list = curl.slist_append(list, header.c_str());
  const std::unique_ptr<curl_slist, decltype(curl.slist_free_all)> headers(list, curl.slist_free_all);
  Collected collected{{}, request.largest_answer_bytes};
  const auto set = [&](CURLoption option, auto value) { curl.easy_setopt(easy.get(), option, value); };
  set(CURLOPT_URL, request.url.c_str());
  set(CURLOPT_PROTOCOLS_STR, request.encrypted_too ? "http,https" : "http");
  set(CURLOPT_CONNECTTIMEOUT_MS, request.connect_timeout_ms);
  set(CURLOPT_TIMEOUT_MS, request.timeout_ms);
  set(CURLOPT_NOSIGNAL, 1L);
  if (!request.use_proxy) set(CURLOPT_PROXY, "");
  if (list != nullptr) set(CURLOPT_HTTPHEADER, list);
  set(CURLOPT_WRITEFUNCTION, &collect);
  set(CURLOPT_WRITEDATA, &collected);
  std::vector<std::string> cookies;
  set(CURLOPT_HEADERFUNCTION, &collect_cookies);
  set(CURLOPT_HEADERDATA, &cookies);
  if (request.body) {
    set(CURLOPT_POSTFIELDSIZE_LARGE, static_cast<curl_off_t>(request.body->size()));
    set(CURLOPT_POSTFIELDS, request.body->c_str());
    if (request.put) set(CURLOPT_CUSTOMREQUEST, "PUT");
  }
  const CURLcode code = curl.easy_perform(easy.get());
  WebAnswer answer{outcome_of(code), 0, std::move(collected.text), std::move(cookies), {}};
  curl.easy_getinfo(easy.get(), CURLINFO_RESPONSE_CODE, &answer.status);
  if (code != CURLE_OK) answer.problem = curl.easy_strerror(code);
  return answer;
}

std::string percent_encoded(const std::string& text) {
  std::string encoded;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain =
        byte < 0x80 && (std::isalnum(byte) != 0 || std::string_view("-._~").find(c) != std::string_view::npos);
    if (plain) {
      encoded += c;
    } else {
      encoded += fmt::format("%{:02X}", byte);
    }
  }
  return encoded;
}

}  // namespace touchstone

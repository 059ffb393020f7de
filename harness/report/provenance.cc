#include "harness/report/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "harness/base/hash.h"

namespace touchstone::report {
namespace {

// Single quotes around what a shell would not take as it is.
std::string quoted(const std::string& word) {
  const auto safe = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_./=:,+@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, safe)) return word;
  std::string out = "'";
  for (const char c : word) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      out += c;
    }
  }
  return out + "'";
}

}  // namespace

Provenance make_provenance(const std::vector<std::string>& command_line) {
  Provenance out;
  for (const std::string& word : command_line) out.command += (out.command.empty() ? "" : " ") + quoted(word);
  const auto now = std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
  out.created_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
  out.build = build_info();
  return out;
}

InputFile describe_input(std::string role, const std::filesystem::path& path) {
  InputFile out{std::move(role), path.string(), sha256_file(path), 0};
  std::error_code error;
  out.bytes = std::filesystem::file_size(path, error);
  return out;
}

}  // namespace touchstone::report

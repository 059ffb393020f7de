#include "harness/report/page_html.h"

#include <fmt/format.h>

#include "harness/base/atomic_file.h"
#include "harness/base/hash.h"
#include "harness/base/markup.h"
#include "harness/report/page_json.h"
#include "harness/report/web_assets.h"

namespace touchstone::report {
namespace {

int nibble(char hex) { return hex <= '9' ? hex - '0' : hex - 'a' + 10; }

// The hash that a content security policy names a script by: SHA-256 in base 64.
std::string script_hash(std::string_view script) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string hex = sha256(script);
  std::string out;
  unsigned bits = 0;
  unsigned held = 0;
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    bits = (bits << 8) | static_cast<unsigned>(nibble(hex[i]) * 16 + nibble(hex[i + 1]));
    for (held += 8; held >= 6; held -= 6) out += digits[(bits >> (held - 6)) & 63];
  }
  if (held > 0) out += digits[(bits << (6 - held)) & 63];
  while (out.size() % 4 != 0) out += '=';
  return "sha256-" + out;
}

}  // namespace

std::string escape_json_for_script(std::string_view json) {
  std::string out;
  out.reserve(json.size() + json.size() / 16);
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (c == '<' || c == '>' || c == '&') {
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    } else if (json.substr(i, 3) == "\xE2\x80\xA8" || json.substr(i, 3) == "\xE2\x80\xA9") {
      out += json[i + 2] == '\xA8' ? "\\u2028" : "\\u2029";
      i += 2;
    } else {
      out += c;
    }
  }
  return out;
}

std::string page_to_html(const Page& page) {
  const std::string_view library = web_asset_plotly();
  const std::string_view script = web_asset_script();
  std::string out;
  out += "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  // Nothing may be fetched, and no script runs but the two below, whatever the data says.
  out += fmt::format(
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
      "img-src data: blob:; script-src '{}' '{}'\">\n",
      script_hash(library), script_hash(script));
  out += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  out += fmt::format("<title>{}</title>\n<style>", escape_html(page.title));
  out += web_asset_style();
  out +=
      "</style>\n</head>\n<body>\n<main id=\"report\"><noscript>This report draws its plots with JavaScript; the same "
      "numbers are in the JSON file beside it.</noscript></main>\n<script type=\"application/json\" id=\"data\">";
  out += escape_json_for_script(page_to_json(page));
  out += "</script>\n<script>";
  out += library;
  out += "</script>\n<script>";
  out += script;
  out += "</script>\n</body>\n</html>\n";
  return out;
}

void write_html(const std::filesystem::path& path, const Page& page) { write_file(path, page_to_html(page)); }

}  // namespace touchstone::report

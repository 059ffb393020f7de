// Writes a Page as one self-contained HTML file: script, style, plotting library and data inside, no network.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "harness/report/page.h"

namespace touchstone::report {

// The file's text.
std::string page_to_html(const Page& page);
// Atomic; throws BadData when it cannot be written.
void write_html(const std::filesystem::path& path, const Page& page);

// JSON text that may stand inside <script>: "<", ">", "&", U+2028 and U+2029 are written as \uXXXX, so that nothing in
// it can end the element or the line. Bytes that are not UTF-8 are replaced by U+FFFD before.
std::string escape_json_for_script(std::string_view json);

}  // namespace touchstone::report

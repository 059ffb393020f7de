#include "harness/plugin/plugin_provenance.h"

#include <fmt/format.h>

#include "harness/base/hash.h"
#include "harness/base/repository_state.h"

namespace touchstone::plugin {
namespace {

// golden/<case>/expected/ and the summary beside it are written by accepting, not by whoever changes the renderer.
bool is_expected_result(const std::string& path) {
  return path.find("/expected/") != std::string::npos || path.ends_with("/expected.summary.json");
}

}  // namespace

std::map<std::string, std::string> plugin_provenance(const rendering::RendererEntry& entry) {
  if (entry.library.empty()) return {};
  const std::filesystem::path library = std::filesystem::absolute(entry.library);
  std::map<std::string, std::string> out{{"plugin_library", library.string()}, {"plugin_sha256", sha256_file(library)}};
  const std::filesystem::path source = entry.library_source.empty() ? library.parent_path() : entry.library_source;
  const auto state = repository_state(source);
  if (!state || state->commit.empty()) {
    out["plugin_commit"] = "unknown";
    out["plugin_state"] = fmt::format(
        "{} is in no git checkout with a commit; say with --plugin-source where its "
        "sources are",
        source.string());
    return out;
  }
  out["plugin_commit"] = state->commit;
  out["plugin_state"] = "clean";
  for (const std::string& change : state->changes) {
    if (is_expected_result(change)) continue;
    out["plugin_state"] = "changed: " + change;
    break;
  }
  return out;
}

}  // namespace touchstone::plugin

// What git says of the folder that something was made in: provenance of what is not this program.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace touchstone {

struct RepositoryState {
  std::string commit;                // empty before the first one
  std::vector<std::string> changes;  // paths with changes that are not committed, and untracked ones
};

// Nothing where the folder is in no git checkout, or git cannot be run.
std::optional<RepositoryState> repository_state(const std::filesystem::path& folder);

}  // namespace touchstone

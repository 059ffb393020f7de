// Extras: programs touchstone-NAME that are run as `touchstone NAME`, as git runs git-NAME
// (https://git-scm.com/docs/git#_git_commands). They are looked for beside this program, then along PATH; a command of
// the program itself comes first.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/error.h"

namespace touchstone::apps {

struct Extra {
  std::string name;  // lower-case letters, digits and dashes, as commands are named
  std::filesystem::path program;
};

// Sorted by name, without those that `commands` has; of two with one name the first that is found. The program's own
// parts (touchstone-full ...) are none.
std::vector<Extra> find_extras(const std::vector<std::string>& commands);

std::optional<Extra> find_extra(std::string_view name);

// Becomes the extra, with the words behind its name and the path of `touchstone` in the environment as
// TOUCHSTONE_PROGRAM; its exit status is the program's. Throws UsageError where the system cannot run it.
[[noreturn]] void become_extra(const Extra& extra, char** words);

// Runs it with these words and waits; its exit status. For a command that leaves its work to an extra. Throws
// UsageError where the system cannot run it.
ExitStatus run_extra_and_wait(const Extra& extra, const std::vector<std::string>& words);

}  // namespace touchstone::apps

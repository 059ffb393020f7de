// `touchstone texture`: what plays, makes and compares texture models. What it runs throws UsageError for an option
// that makes no sense, and BadData for a file that cannot be used.
#pragma once

#include "apps/command.h"

namespace touchstone::texture {

void add_texture(CLI::App& program, apps::Run& run);

}  // namespace touchstone::texture

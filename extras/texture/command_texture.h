// `touchstone texture`: what plays, makes and compares texture models.
#pragma once

#include "apps/command.h"

namespace touchstone::texture {

void add_texture(CLI::App& program, apps::Run& run);

}  // namespace touchstone::texture

// What this program knows: the renderers of renderers/, the surfaces and motions of synthetic/, and the extra that
// closes loops.
#pragma once

#include "apps/extras.h"
#include "harness/golden/catalogues.h"
#include "renderers/catalogue.h"
#include "synthetic/generators.h"

namespace touchstone::apps {

inline golden::Catalogues built_in_catalogues() {
  const auto loop = find_extra("loop");
  return {renderers::built_in_catalogue(), synthetic::built_in_generators(),
          loop ? loop->program : std::filesystem::path()};
}

}  // namespace touchstone::apps

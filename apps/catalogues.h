// What this program knows: the renderers of renderers/, the surfaces and motions of synthetic/.
#pragma once

#include "harness/golden/catalogues.h"
#include "renderers/catalogue.h"
#include "synthetic/generators.h"

namespace touchstone::apps {

inline golden::Catalogues built_in_catalogues() {
  return {renderers::built_in_catalogue(), synthetic::built_in_generators()};
}

}  // namespace touchstone::apps

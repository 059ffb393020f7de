// What a golden case or a sweep may name: renderers with their effects, and generated surfaces and motions.
#pragma once

#include <filesystem>

#include "harness/rendering/catalogue.h"
#include "harness/rendering/generators.h"

namespace touchstone::golden {

// Both must live as long as what is given them.
struct Catalogues {
  const rendering::Catalogue& renderers;
  const rendering::Generators& generators;
  std::filesystem::path loop_program = {};  // what closes a case's loop; empty: there is none
};

}  // namespace touchstone::golden

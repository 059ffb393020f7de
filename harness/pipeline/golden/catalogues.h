// What a golden case or a sweep may name: renderers with their effects, and generated surfaces and motions.
#pragma once

#include "harness/base/rooms.h"
#include "harness/rendering/catalogue.h"
#include "harness/rendering/generators.h"

namespace touchstone::pipeline {

// Both must live as long as what is given them.
struct Catalogues {
  const Catalogue& renderers;
  const Generators& generators;
};

}  // namespace touchstone::pipeline

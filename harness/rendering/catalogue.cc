#include "harness/rendering/catalogue.h"

namespace touchstone::rendering {

std::vector<std::string> renderer_names(const Catalogue& catalogue) {
  std::vector<std::string> names;
  for (const RendererEntry& entry : catalogue.renderers()) names.push_back(entry.name);
  return names;
}

}  // namespace touchstone::rendering

#include "renderers/catalogue.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "harness/base/known_names.h"
#include "harness/rendering/instrument_declarations.h"
#include "renderers/god_object.h"

namespace touchstone {

const std::vector<RendererEntry>& renderer_catalogue() {
  static const std::vector<RendererEntry> catalogue{god_object_entry()};
  return catalogue;
}

const RendererEntry& find_renderer(const Model& model) {
  std::vector<std::string> known;
  for (const auto& entry : renderer_catalogue()) {
    if (entry.name == model.renderer) return entry;
    known.push_back(entry.name);
  }
  throw BadData(fmt::format("{}: /renderer: {}", model.source, unknown_name("renderer", model.renderer, known)));
}

const std::vector<NamedDeclaration>& effect_catalogue() {
  static const std::vector<NamedDeclaration> catalogue;
  return catalogue;
}

std::unique_ptr<Renderer> make_renderer(const Model& model, std::shared_ptr<const Surface> surface) {
  const RendererEntry& entry = find_renderer(model);
  const Parameters parameters(entry.parameters, model.parameters, "renderer " + entry.name, model.source, "");
  for (const auto& effect : model.effects) check_entry(effect, effect_catalogue(), "contact effect", model.source);
  for (const auto& part : model.instrument)
    check_entry(part, instrument_declarations(), "instrument entry", model.source);
  if (surface->mesh() == nullptr) {
    if (const auto* const limit = find_limitation(entry.cannot, Ability::analytic_surface)) {
      throw BadData(fmt::format("{}: the renderer {} cannot run on a surface without triangles: {}", model.source,
                                entry.name, limit->reason));
    }
  }
  return entry.make(parameters, std::move(surface));
}

}  // namespace touchstone

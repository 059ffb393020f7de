// The plug-in: the renderer `texture` with the model behind this library (texture_library.h).
#include <dlfcn.h>
#include <fmt/format.h>

#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "harness/plugin/plugin_export.h"
#include "texture_library.h"
#include "texture_model.h"
#include "texture_renderer.h"

namespace {

using namespace touchstone::texture;

// What goes wrong is said when a renderer is made: a description has no place for it.
touchstone::rendering::RendererEntry own_entry() {
  try {
    Dl_info own{};
    if (::dladdr(reinterpret_cast<const void*>(&own_entry), &own) == 0)
      return texture_renderer_entry(nullptr, "the system does not say which file this plug-in is");
    const std::optional<std::string> xml = model_in_library(own.dli_fname);
    if (!xml) {
      return texture_renderer_entry(
          nullptr, fmt::format("{}: holds no texture; `touchstone texture plugin MODEL.xml --out cork.so` makes a "
                               "plug-in that does",
                               own.dli_fname));
    }
    return texture_renderer_entry(std::make_shared<const TextureModel>(parse_texture_model(*xml, own.dli_fname)));
  } catch (const std::exception& error) {
    return texture_renderer_entry(nullptr, error.what());
  }
}

}  // namespace

TOUCHSTONE_EXPORT_RENDERERS(own_entry());

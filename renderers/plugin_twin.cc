// The catalogue's own renderers as a plug-in, under names of their own: what goes through the plug-in interface must
// come out as it does without.
#include "harness/plugin/plugin_export.h"
#include "renderers/proxy/god_object.h"
#include "renderers/spring/spring.h"

namespace {

touchstone::rendering::RendererEntry twin(touchstone::rendering::RendererEntry entry) {
  entry.name += "-twin";
  return entry;
}

}  // namespace

TOUCHSTONE_EXPORT_RENDERERS(twin(touchstone::renderers::god_object_entry()),
                            twin(touchstone::renderers::spring_linear_entry()));

// Renderers of several bodies as a plug-in of version 2, under names of their own: what goes through the interface must
// come out as it does without.
#include "harness/plugin/scene_export.h"
#include "renderers/proxy/force_shading.h"
#include "renderers/proxy/friction_cone.h"
#include "renderers/proxy/god_object.h"
#include "renderers/spring/spring.h"

namespace {

touchstone::rendering::RendererEntry twin(touchstone::rendering::RendererEntry entry) {
  entry.name += "-scene-twin";
  return entry;
}

}  // namespace

TOUCHSTONE_EXPORT_SCENE_RENDERERS(twin(touchstone::renderers::god_object_entry()),
                                  twin(touchstone::renderers::friction_cone_entry()),
                                  twin(touchstone::renderers::force_shading_entry()),
                                  twin(touchstone::renderers::spring_linear_entry()));

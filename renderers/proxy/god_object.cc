#include "renderers/proxy/god_object.h"

#include "renderers/proxy/ball_proxy.h"
#include "renderers/proxy/counted_god_object.h"
#include "renderers/proxy/point_proxy.h"
#include "renderers/proxy/proxy_parameters.h"
#include "renderers/proxy/proxy_renderer.h"
#include "renderers/proxy/scene_renderer.h"

namespace touchstone::renderers {
using rendering::Parameters;

rendering::RendererEntry god_object_entry() {
  rendering::RendererEntry entry{
      "god-object",
      "constraint-based: the surface contact point follows the tip outside the surface, a spring joins the two",
      "Zilles and Salisbury 1995",
      proxy_parameters(),
      {{rendering::Ability::analytic_surface, "it constrains the god-object by triangles"}},
      [](const Parameters& parameters,
         std::shared_ptr<const surface::Surface> surface) -> std::unique_ptr<rendering::Renderer> {
        const double stiffness = parameters.at("stiffness_N_per_m");
        const double radius = parameters.at("tip_radius_m");
        if (radius > 0.0)
          return std::make_unique<ProxyRenderer<BallProxy>>(stiffness, std::move(surface), NoShading{}, radius);
        return std::make_unique<ProxyRenderer<PointProxy>>(stiffness, std::move(surface), NoShading{});
      },
      [](const Parameters& parameters,
         std::shared_ptr<const surface::Surface> surface) -> std::unique_ptr<rendering::Renderer> {
        return make_counted_god_object(std::move(surface), parameters.at("stiffness_N_per_m"),
                                       parameters.at("tip_radius_m"), {});
      }};
  entry.make_scene = [](const Parameters& parameters, std::shared_ptr<const rendering::BodyScene> scene) {
    return make_scene_proxy(parameters, std::move(scene), {});
  };
  entry.has_exact_answer = true;
  return entry;
}

}  // namespace touchstone::renderers

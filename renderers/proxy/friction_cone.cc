#include "renderers/proxy/friction_cone.h"

#include "renderers/proxy/ball_proxy.h"
#include "renderers/proxy/counted_god_object.h"
#include "renderers/proxy/point_proxy.h"
#include "renderers/proxy/proxy_parameters.h"
#include "renderers/proxy/proxy_renderer.h"
#include "renderers/proxy/scene_renderer.h"

namespace touchstone::renderers {
using rendering::Parameters;

std::vector<rendering::ParameterDeclaration> cone_parameters() {
  return {{"mu_static", "1", 0.0, 5.0, 0.0,
           "break-away coefficient, at least mu_dynamic, which it is where it is not given"},
          {"mu_dynamic", "1", 0.0, 5.0, 0.0, "sliding coefficient"}};
}

rendering::RendererEntry friction_cone_entry() {
  rendering::RendererEntry entry{
      "friction-cone",
      "god-object that a friction cone about the normal holds back",
      "Harwin and Melder 2002; Melder and Harwin 2004",
      proxy_parameters(cone_parameters()),
      {{rendering::Ability::analytic_surface, "it constrains the god-object by triangles"}},
      [](const Parameters& parameters,
         std::shared_ptr<const surface::Surface> surface) -> std::unique_ptr<rendering::Renderer> {
        const double stiffness = parameters.at("stiffness_N_per_m");
        const double radius = parameters.at("tip_radius_m");
        const ConeFriction friction{parameters.at("mu_static"), parameters.at("mu_dynamic")};
        if (radius > 0.0)
          return std::make_unique<ProxyRenderer<BallProxy>>(stiffness, std::move(surface), NoShading{}, radius,
                                                            friction);
        return std::make_unique<ProxyRenderer<PointProxy>>(stiffness, std::move(surface), NoShading{}, friction);
      },
      [](const Parameters& parameters,
         std::shared_ptr<const surface::Surface> surface) -> std::unique_ptr<rendering::Renderer> {
        return make_counted_god_object(std::move(surface), parameters.at("stiffness_N_per_m"),
                                       parameters.at("tip_radius_m"),
                                       {parameters.at("mu_static"), parameters.at("mu_dynamic")});
      }};
  entry.needs_friction = true;  // without it, it is the god-object, bit for bit
  entry.make_scene = [](const Parameters& parameters, std::shared_ptr<const rendering::BodyScene> scene) {
    return make_scene_proxy(parameters, std::move(scene), {parameters.at("mu_static"), parameters.at("mu_dynamic")});
  };
  return entry;
}

}  // namespace touchstone::renderers

#include "renderers/proxy/force_shading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderers/friction/shares.h"
#include "renderers/proxy/ball_proxy.h"
#include "renderers/proxy/counted_god_object.h"
#include "renderers/proxy/friction_cone.h"
#include "renderers/proxy/point_proxy.h"
#include "renderers/proxy/proxy_parameters.h"
#include "renderers/proxy/proxy_renderer.h"
#include "renderers/proxy/scene_renderer.h"
#include "renderers/proxy/shaded_normals.h"

namespace touchstone::renderers {
using rendering::Parameters;

namespace {

// The interpolated normals of a scene's bodies: each body's own, turned by its pose.
class PosedNormals {
 public:
  PosedNormals(const PosedBodies& bodies, double crease_angle_rad) : bodies_(&bodies) {
    for (const PosedBody& body : bodies.bodies()) normals_.emplace_back(body.mesh(), crease_angle_rad);
  }

  template <class S, class Place>
  [[nodiscard]] double direction(const Facet& /*facet*/, const Place& place, const Vec3& n, Vec3& m) const noexcept {
    const std::size_t which = bodies_->body_of(place.triangle);
    const PosedBody& body = bodies_->bodies()[which];
    Place local = place;
    local.triangle -= body.first_triangle();
    local.p = body.to_B(place.p);
    const double along =
        normals_[which].direction<double>(body.mesh().facet(local.triangle), local, body.direction_to_B(n), m);
    m = body.direction_to_W(m);
    return along;
  }
  template <class S>
  [[nodiscard]] Vec3 at(const Facet& facet, const ContactPlaces::Place& place) const noexcept {
    Vec3 m;
    return direction<S>(facet, place, place.n, m) > 0.0 ? unit(m) : place.n;
  }
  void fetch_about(const std::array<std::int32_t, 3>& /*neighbours*/) const noexcept {}

 private:
  const PosedBodies* bodies_;
  std::vector<ShadedNormals> normals_;
};

// `Normals`: ShadedNormals or PosedNormals.
template <class Normals>
class ShadingBy {
 public:
  template <class Mesh>
  ShadingBy(const Mesh& mesh, double crease_angle_rad) : normals_(mesh, crease_angle_rad) {}

  template <class Mesh, class Proxy>
  void turn(const Mesh& mesh, const Proxy& proxy, rendering::StepResult& result) noexcept {
    using S = typename Mesh::Scalar;
    Vec3Of<S> m;
    if (const auto place = proxy.resting_place(); place.triangle >= 0) {
      const FacetOf<S>& facet = mesh.facet(place.triangle);
      if (place.triangle != fetched_about_) {
        fetched_about_ = place.triangle;
        normals_.fetch_about(facet.neighbour);
      }
      const Vec3Of<S> n = result.n_W.cast<S>();
      const S along = normals_.template direction<S>(facet, place, n, m);
      if (!(along > S(0.0))) return;
      if (!proxy.frictionless()) return turn_to(n, m, along, result);
      // All of the force is along n.
      const Vec3Of<S> shaded = (S(1.0) / sqrt(squared_norm(m))) * m;
      result.f_W_N = (dot(result.f_W_N.cast<S>(), n) * shaded).template cast<double>();
      result.n_W = shaded.template cast<double>();
    } else {
      const ContactPlacesOf<S> contact = proxy.contact_places();
      if (contact.size == 0) return;
      const Vec3Of<S> n = result.n_W.cast<S>();
      const Vec3Of<S> share = contact.size == 1 ? Vec3Of<S>(S(1.0), S(0.0), S(0.0)) : shares(contact, n);
      m.setZero();
      for (int i = 0; i < contact.size; ++i) {
        const auto& at = contact.place[static_cast<std::size_t>(i)];
        m += share[i] * normals_.template at<S>(mesh.facet(at.triangle), at);
      }
      if (const S along = dot(n, m); along > S(0.0)) turn_to(n, m, along, result);
    }
  }

 private:
  // The force turned by the shortest rotation that takes the unit vector n to the direction m, along = n . m > 0: of v
  // it makes v - s (s . v) / (1 + n . b) + 2 b (n . v), where b is the unit vector along m and s = n + b.
  template <class S>
  static void turn_to(const Vec3Of<S>& n, const Vec3Of<S>& m, const S& along, rendering::StepResult& result) noexcept {
    const S inverse = S(1.0) / sqrt(squared_norm(m));
    const Vec3Of<S> b = inverse * m;
    const Vec3Of<S> s = n + b;
    const Vec3Of<S> v = result.f_W_N.cast<S>();
    const S back = dot(s, v) / (S(1.0) + inverse * along);
    const S press = dot(n, v);
    result.f_W_N = (v - back * s + (press + press) * b).template cast<double>();
    result.n_W = b.template cast<double>();
  }

  Normals normals_;
  std::int32_t fetched_about_ = -1;  // that triangle
};
using Shading = ShadingBy<ShadedNormals>;

std::vector<rendering::ParameterDeclaration> parameters_of_force_shading() {
  std::vector<rendering::ParameterDeclaration> own{
      {"crease_angle_rad", "rad", 0.0, std::numbers::pi, std::numbers::pi / 3.0, "sharper edges are not shaded"}};
  for (auto& declared : cone_parameters()) own.push_back(std::move(declared));
  return proxy_parameters(std::move(own));
}

}  // namespace

rendering::RendererEntry force_shading_entry() {
  rendering::RendererEntry entry{
      "force-shading",
      "god-object whose force points along normals interpolated between the vertices', with or without friction",
      "Morgenbesser and Srinivasan 1996",
      parameters_of_force_shading(),
      {{rendering::Ability::analytic_surface, "it constrains the god-object by triangles"},
       {rendering::Ability::passive,
        "interpolated normals are no surface's: a path of length L at depth d gives back up to k d 2 sin(a/2) L, a the "
        "angle between shaded and true normal"}},
      [](const Parameters& parameters,
         std::shared_ptr<const surface::Surface> surface) -> std::unique_ptr<rendering::Renderer> {
        const double stiffness = parameters.at("stiffness_N_per_m");
        const double radius = parameters.at("tip_radius_m");
        const ConeFriction friction{parameters.at("mu_static"), parameters.at("mu_dynamic")};
        const auto mesh = contact_mesh(surface);  // kept, so that it is built once
        Shading shading(*mesh, parameters.at("crease_angle_rad"));
        if (radius > 0.0)
          return std::make_unique<ProxyRenderer<BallProxy, Shading>>(stiffness, std::move(surface), std::move(shading),
                                                                     radius, friction);
        return std::make_unique<ProxyRenderer<PointProxy, Shading>>(stiffness, std::move(surface), std::move(shading),
                                                                    friction);
      },
      [](const Parameters& parameters,
         std::shared_ptr<const surface::Surface> surface) -> std::unique_ptr<rendering::Renderer> {
        const auto mesh = contact_mesh(surface);
        Shading shading(*mesh, parameters.at("crease_angle_rad"));
        return make_counted_proxy(std::move(surface), parameters.at("stiffness_N_per_m"), parameters.at("tip_radius_m"),
                                  {parameters.at("mu_static"), parameters.at("mu_dynamic")}, std::move(shading));
      }};
  entry.make_scene = [](const Parameters& parameters, std::shared_ptr<const rendering::BodyScene> scene) {
    const double crease_angle_rad = parameters.at("crease_angle_rad");
    return make_scene_proxy(
        parameters, std::move(scene), {parameters.at("mu_static"), parameters.at("mu_dynamic")},
        [=](const PosedBodies& bodies) { return ShadingBy<PosedNormals>(bodies, crease_angle_rad); });
  };
  return entry;
}

}  // namespace touchstone::renderers

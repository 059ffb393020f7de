#include "renderers/proxy/force_shading.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderers/friction/fixed_order.h"
#include "renderers/proxy/ball_proxy.h"
#include "renderers/proxy/counted_god_object.h"
#include "renderers/proxy/friction_cone.h"
#include "renderers/proxy/point_proxy.h"
#include "renderers/proxy/proxy_parameters.h"
#include "renderers/proxy/proxy_renderer.h"
#include "renderers/proxy/shaded_normals.h"

namespace touchstone::renderers {
namespace {

// How much each contact presses: n = sum w_i n_i, least squares; zeros where the normals cannot be told apart.
template <class S>
Vec3Of<S> shares(const ContactPlacesOf<S>& contact, const Vec3Of<S>& n) noexcept {
  const S none(0.0);
  const S one(1.0);
  Vec3Of<S> share = Vec3Of<S>::Zero();
  if (contact.size == 2) {
    const S c = dot(contact.place[0].n, contact.place[1].n);
    const S a = dot(contact.place[0].n, n);
    const S b = dot(contact.place[1].n, n);
    const S apart = one - c * c;
    if (apart > none) share = {(a - c * b) / apart, (b - c * a) / apart, none};
  } else {
    Eigen::Matrix<S, 3, 3> normals;
    for (int i = 0; i < 3; ++i) normals.col(i) = contact.place[static_cast<std::size_t>(i)].n;
    Eigen::Matrix<S, 3, 3> inverse;
    if (invert<S>(normals, 1e-12, inverse)) share = product(inverse, n);
  }
  for (S& part : share) part = std::max(none, part);
  return share;
}

class Shading {
 public:
  Shading(const ContactMesh& mesh, double crease_angle_rad) : normals_(mesh, crease_angle_rad) {}

  template <class Mesh, class Proxy>
  void turn(const Mesh& mesh, const Proxy& proxy, StepResult& result) noexcept {
    using S = typename Mesh::Scalar;
    Vec3Of<S> m;
    if (const auto place = proxy.resting_place(); place.triangle >= 0) {
      const FacetOf<S>& facet = mesh.facet(place.triangle);
      if (place.triangle != fetched_about_) {
        fetched_about_ = place.triangle;
        normals_.fetch_about(facet.neighbour);
      }
      const Vec3Of<S> n = result.n_W.cast<S>();
      const S along = normals_.direction(facet, place, n, m);
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
        m += share[i] * normals_.at(mesh.facet(at.triangle), at);
      }
      if (const S along = dot(n, m); along > S(0.0)) turn_to(n, m, along, result);
    }
  }

 private:
  // The force turned by the shortest rotation that takes the unit vector n to the direction m, along = n . m > 0: of v
  // it makes v - s (s . v) / (1 + n . b) + 2 b (n . v), where b is the unit vector along m and s = n + b.
  template <class S>
  static void turn_to(const Vec3Of<S>& n, const Vec3Of<S>& m, const S& along, StepResult& result) noexcept {
    const S inverse = S(1.0) / sqrt(squared_norm(m));
    const Vec3Of<S> b = inverse * m;
    const Vec3Of<S> s = n + b;
    const Vec3Of<S> v = result.f_W_N.cast<S>();
    const S back = dot(s, v) / (S(1.0) + inverse * along);
    const S press = dot(n, v);
    result.f_W_N = (v - back * s + (press + press) * b).template cast<double>();
    result.n_W = b.template cast<double>();
  }

  ShadedNormals normals_;
  std::int32_t fetched_about_ = -1;  // that triangle
};

std::vector<ParameterDeclaration> parameters_of_force_shading() {
  std::vector<ParameterDeclaration> own{
      {"crease_angle_rad", "rad", 0.0, std::numbers::pi, std::numbers::pi / 3.0, "sharper edges are not shaded"}};
  for (auto& declared : cone_parameters()) own.push_back(std::move(declared));
  return proxy_parameters(std::move(own));
}

}  // namespace

RendererEntry force_shading_entry() {
  return {
      "force-shading",
      "god-object whose force points along normals interpolated between the vertices', with or without friction",
      "Morgenbesser and Srinivasan 1996",
      parameters_of_force_shading(),
      {{Ability::analytic_surface, "it constrains the god-object by triangles"},
       {Ability::passive,
        "interpolated normals are no surface's: a path of length L at depth d gives back up to k d 2 sin(a/2) L, a the "
        "angle between shaded and true normal"}},
      [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
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
      [](const Parameters& parameters, std::shared_ptr<const Surface> surface) -> std::unique_ptr<Renderer> {
        const auto mesh = contact_mesh(surface);
        Shading shading(*mesh, parameters.at("crease_angle_rad"));
        return make_counted_proxy(std::move(surface), parameters.at("stiffness_N_per_m"), parameters.at("tip_radius_m"),
                                  {parameters.at("mu_static"), parameters.at("mu_dynamic")}, std::move(shading));
      }};
}

}  // namespace touchstone::renderers

#include "renderers/force_shading.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <numbers>
#include <type_traits>

#include "renderers/ball_proxy.h"
#include "renderers/counted_god_object.h"
#include "renderers/friction_cone.h"
#include "renderers/point_proxy.h"
#include "renderers/proxy_parameters.h"
#include "renderers/proxy_renderer.h"
#include "renderers/shaded_normals.h"

namespace touchstone {
namespace {

// v turned by the shortest rotation that takes the unit vector a to b; c = a . b > 0.
template <class S>
Vec3Of<S> turned(const Vec3Of<S>& a, const Vec3Of<S>& b, const S& c, const Vec3Of<S>& v) noexcept {
  const Vec3Of<S> w = a.cross(b);
  return c * v + w.cross(v) + dot(w, v) / (S(1.0) + c) * w;
}

// How much each contact presses: n = sum w_i n_i, least squares; zeros where the normals cannot be told apart.
Vec3 shares(const ContactPlaces& contact, const Vec3& n) noexcept {
  Vec3 share = Vec3::Zero();
  if (contact.size == 2) {
    const double c = contact.place[0].n.dot(contact.place[1].n);
    const double a = contact.place[0].n.dot(n);
    const double b = contact.place[1].n.dot(n);
    if (1.0 - c * c > 0.0) share = {(a - c * b) / (1.0 - c * c), (b - c * a) / (1.0 - c * c), 0.0};
  } else {
    Mat3 normals;
    for (int i = 0; i < 3; ++i) normals.col(i) = contact.place[static_cast<std::size_t>(i)].n;
    Mat3 inverse;
    bool solvable = false;
    normals.computeInverseWithCheck(inverse, solvable, 1e-12);
    if (solvable) share = inverse * n;
  }
  return share.cwiseMax(0.0);
}

class Shading {
 public:
  Shading(const ContactMesh& mesh, double crease_angle_rad) : normals_(mesh, crease_angle_rad) {}

  template <class Mesh, class Proxy>
  void turn(const Mesh& mesh, const Proxy& proxy, StepResult& result) const noexcept {
    const auto contact = proxy.contact_places();
    if (contact.size == 0) return;
    if (contact.size == 1) {
      const auto& place = contact.place[0];
      turn_to(normals_.at(mesh.facet(place.triangle), place), result);
    } else if constexpr (std::is_same_v<typename Mesh::Scalar, double>) {
      // A walk, which is all that counts its operations, rests at one place.
      const Vec3 share = shares(contact, result.n_W);
      Vec3 shaded = Vec3::Zero();
      for (int i = 0; i < contact.size; ++i) {
        const auto& place = contact.place[static_cast<std::size_t>(i)];
        shaded += share[i] * normals_.at(mesh.facet(place.triangle), place);
      }
      const double length = shaded.norm();
      if (length > 0.0) turn_to(Vec3(shaded / length), result);
    }
  }

 private:
  template <class S>
  static void turn_to(const Vec3Of<S>& shaded, StepResult& result) noexcept {
    const Vec3Of<S> n = result.n_W.cast<S>();
    const S c = dot(n, shaded);
    if (!(c > S(0.0))) return;
    result.f_W_N = turned<S>(n, shaded, c, result.f_W_N.cast<S>()).template cast<double>();
    result.n_W = shaded.template cast<double>();
  }

  ShadedNormals normals_;
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
        if (parameters.at("tip_radius_m") > 0.0) return nullptr;
        const auto mesh = contact_mesh(surface);
        Shading shading(*mesh, parameters.at("crease_angle_rad"));
        return make_counted_proxy(std::move(surface), parameters.at("stiffness_N_per_m"),
                                  {parameters.at("mu_static"), parameters.at("mu_dynamic")}, std::move(shading));
      }};
}

}  // namespace touchstone

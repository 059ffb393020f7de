#include "renderers/force_shading.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <numbers>

#include "renderers/ball_proxy.h"
#include "renderers/friction_cone.h"
#include "renderers/point_proxy.h"
#include "renderers/proxy_parameters.h"
#include "renderers/proxy_renderer.h"
#include "renderers/shaded_normals.h"

namespace touchstone {
namespace {

// v turned by the shortest rotation that takes the unit vector a to b; a . b > 0.
Vec3 turned(const Vec3& a, const Vec3& b, const Vec3& v) noexcept {
  const double c = a.dot(b);
  const Vec3 w = a.cross(b);
  return c * v + w.cross(v) + w.dot(v) / (1.0 + c) * w;
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
  Shading(std::shared_ptr<const ContactMesh> mesh, double crease_angle_rad)
      : mesh_(std::move(mesh)), normals_(*mesh_, crease_angle_rad) {}

  template <class Proxy>
  void turn(const Proxy& proxy, const Vec3& /*p*/, StepResult& result) const noexcept {
    const ContactPlaces contact = proxy.contact_places();
    if (contact.size == 0) return;
    Vec3 shaded;
    if (contact.size == 1) {
      shaded = normals_.at(*mesh_, contact.place[0]);
    } else {
      const Vec3 share = shares(contact, result.n_W);
      shaded.setZero();
      for (int i = 0; i < contact.size; ++i)
        shaded += share[i] * normals_.at(*mesh_, contact.place[static_cast<std::size_t>(i)]);
      const double length = shaded.norm();
      if (!(length > 0.0)) return;
      shaded /= length;
    }
    if (!(shaded.dot(result.n_W) > 0.0)) return;
    result.f_W_N = turned(result.n_W, shaded, result.f_W_N);
    result.n_W = shaded;
  }

 private:
  std::shared_ptr<const ContactMesh> mesh_;
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
        Shading shading(contact_mesh(surface), parameters.at("crease_angle_rad"));
        if (radius > 0.0)
          return std::make_unique<ProxyRenderer<BallProxy, Shading>>(stiffness, std::move(surface), std::move(shading),
                                                                     radius, friction);
        return std::make_unique<ProxyRenderer<PointProxy, Shading>>(stiffness, std::move(surface), std::move(shading),
                                                                    friction);
      }};
}

}  // namespace touchstone

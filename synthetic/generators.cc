#include "synthetic/generators.h"

#include <utility>

#include "synthetic/surface_catalogue.h"
#include "synthetic/surfaces/exact_contact.h"
#include "synthetic/trajectory_catalogue.h"

namespace touchstone::synthetic {
using surface::Surface;

namespace {

class BuiltInGenerators final : public rendering::Generators {
 public:
  [[nodiscard]] std::unique_ptr<const Surface> surface(std::string_view name, const Values& parameters) const override {
    return make_surface(name, parameters);
  }
  [[nodiscard]] rendering::GeneratedMesh mesh(std::string_view name, const Values& parameters,
                                              std::size_t triangles) const override {
    auto made = make_mesh(name, parameters, triangles);
    return {std::move(made.mesh), made.deviation_bound_m};
  }
  [[nodiscard]] recording::InTrajectory motion(std::string_view name, const Values& parameters, std::uint64_t seed,
                                               double rate_Hz) const override {
    return sample(*make_path(name, parameters, seed), rate_Hz);
  }
  [[nodiscard]] rendering::ExactResponse exact_response(const Surface& surface, const Vec3& tip_W_m,
                                                        double stiffness_N_per_m, double tip_radius_m) const override {
    const ExactContact exact = exact_contact(surface, tip_W_m, stiffness_N_per_m, tip_radius_m);
    return {exact.contact, exact.depth_m, exact.proxy_W_m, exact.f_W_N};
  }
  [[nodiscard]] bool leaves_sheet(const Surface& surface, const Vec3& from_W_m, const Vec3& to_W_m,
                                  double tip_radius_m) const override {
    return synthetic::leaves_sheet(surface, from_W_m, to_W_m, tip_radius_m);
  }
};

}  // namespace

const rendering::Generators& built_in_generators() {
  static const BuiltInGenerators generators;
  return generators;
}

}  // namespace touchstone::synthetic

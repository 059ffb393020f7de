// Surfaces and motions that golden cases and sweeps name instead of a file, each with its exact answer. The harness
// knows no concrete shape; it is given these. synthetic/generators.h has the ones of this project,
// built_in_generators().
//
// Frames and units: the object's frame, metres, newtons, seconds. All functions throw UsageError, listing what is
// known, for a name or parameter that is not. Many threads may ask at once.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "harness/recording/trajectory.h"
#include "harness/surface/surface.h"

namespace touchstone::rendering {

// The exact answer of a frictionless god-object at rest (Zilles and Salisbury 1995).
struct ExactResponse {
  bool contact = false;
  double depth_m = 0.0;             // of the tip (of a ball, its centre's offset surface) below the surface
  Vec3 contact_W_m = Vec3::Zero();  // surface contact point; of a ball, its centre at the proxy
  Vec3 f_W_N = Vec3::Zero();        // on the probe
};

// A mesh, and how far from the surface in closed form it is at most.
struct GeneratedMesh {
  surface::TriangleMesh mesh;
  double deviation_bound_m = 0.0;
};

class Generators {
 public:
  using Values = std::map<std::string, double, std::less<>>;

  Generators() = default;
  Generators(const Generators&) = delete;
  Generators& operator=(const Generators&) = delete;
  virtual ~Generators() = default;

  // The surface in closed form.
  [[nodiscard]] virtual std::unique_ptr<const surface::Surface> surface(std::string_view name,
                                                                        const Values& parameters) const = 0;
  // Its mesh of about `triangles` triangles.
  [[nodiscard]] virtual GeneratedMesh mesh(std::string_view name, const Values& parameters,
                                           std::size_t triangles) const = 0;
  // The motion, sampled at `rate_Hz` from 0 to its duration.
  [[nodiscard]] virtual recording::InTrajectory motion(std::string_view name, const Values& parameters,
                                                       std::uint64_t seed, double rate_Hz) const = 0;
  // On a surface in closed form. `tip_radius_m` 0: a point.
  [[nodiscard]] virtual ExactResponse exact_response(const surface::Surface& surface, const Vec3& tip_W_m,
                                                     double stiffness_N_per_m, double tip_radius_m) const = 0;
  // Whether a tip that moves straight from one place to the other may leave the sheet of the surface that it touches,
  // so that the closest point no longer knows where it came from.
  [[nodiscard]] virtual bool leaves_sheet(const surface::Surface& surface, const Vec3& from_W_m, const Vec3& to_W_m,
                                          double tip_radius_m) const = 0;
};

}  // namespace touchstone::rendering

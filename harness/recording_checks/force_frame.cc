#include "harness/recording_checks/force_frame.h"

#include <array>
#include <cmath>
#include <vector>

#include "harness/base/signed_order.h"

namespace touchstone::recording_checks {
namespace {

constexpr std::size_t block_count = 20;
constexpr std::size_t agreeing = 17;      // of 20 fair coins at least 17: p = 0.0013
constexpr double least_alignment = 0.8;   // cos(atan(0.75))
constexpr double outside_friction = 0.9;  // cos(atan(0.5)), rounded up

struct Reading {
  const char* meaning;
  const char* map_key;
  Vec3 (*read)(const Quat& q, const Vec3& f);
};

Quat scalar_last(const Quat& q) { return Quat(q.z(), q.w(), q.x(), q.y()); }

constexpr std::array readings{
    Reading{"the force is in the sensor's frame", R"("force_frame": "sensor")",
            [](const Quat& q, const Vec3& f) -> Vec3 { return q * f; }},
    Reading{"the force was turned by the orientation although it was in the object's frame",
            R"("force_frame": "inverse")", [](const Quat& q, const Vec3& f) -> Vec3 { return q.conjugate() * f; }},
    Reading{"the force is in the sensor's frame and the quaternion's columns hold x, y, z, w",
            R"("force_frame": "sensor" with "order": "xyzw")",
            [](const Quat& q, const Vec3& f) -> Vec3 { return scalar_last(q) * f; }},
    Reading{"the force was turned by the transposed rotation", R"("force_frame": "transposed")",
            [](const Quat& q, const Vec3& f) -> Vec3 { return q * (q * f); }},
};

struct Alignment {
  std::array<double, block_count> pushed{}, size{};
  [[nodiscard]] double block(std::size_t b) const { return size[b] > 0.0 ? pushed[b] / size[b] : 0.0; }
  [[nodiscard]] double whole() const {
    double p = 0.0, s = 0.0;
    for (std::size_t b = 0; b < block_count; ++b) p += pushed[b], s += size[b];
    return s > 0.0 ? p / s : 0.0;
  }
};

template <class Read>
Alignment align(std::span<const Vec3> normals, std::span<const Vec3> forces, const Read& read) {
  Alignment alignment;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const std::size_t b = i * block_count / forces.size();
    alignment.pushed[b] += read(i).dot(normals[i]);
    alignment.size[b] += forces[i].norm();
  }
  return alignment;
}

}  // namespace

std::optional<ForceFrame> find_force_frame(std::span<const Vec3> normals, std::span<const Vec3> forces,
                                           std::span<const Quat> q_WS, double most_left) {
  if (forces.size() < block_count) return std::nullopt;
  const Alignment recorded = align(normals, forces, [&](std::size_t i) { return forces[i]; });
  // A force that is merely reversed is in the right frame: that is another fault.
  const double own_sign = recorded.whole() < 0.0 ? -1.0 : 1.0;
  const Alignment own = align(normals, forces, [&](std::size_t i) -> Vec3 { return own_sign * forces[i]; });
  const double misaligned = 1.0 - own.whole();
  std::optional<ForceFrame> found;
  // Whether it fits, and clearly better than what was found before it.
  const auto better_than_found = [&](const Alignment& other) {
    std::size_t better = 0;
    for (std::size_t b = 0; b < block_count; ++b) better += other.block(b) > own.block(b) ? 1 : 0;
    const double whole = other.whole();
    if (whole < least_alignment || !(1.0 - whole < most_left * misaligned) || better < agreeing) return false;
    return !found || 1.0 - whole < 0.9 * (1.0 - found->repaired);
  };
  for (const Reading& reading : readings) {
    if (q_WS.size() != forces.size()) break;
    for (const double sign : {1.0, -1.0}) {
      const Alignment other =
          align(normals, forces, [&](std::size_t i) -> Vec3 { return sign * reading.read(q_WS[i], forces[i]); });
      if (!better_than_found(other)) continue;
      found = ForceFrame{reading.meaning, reading.map_key, recorded.whole(), other.whole()};
      if (sign < 0.0) {
        found->meaning += " and is reversed";
        found->map_key += R"(, "force_sign": -1)";
      }
    }
  }
  for (const SignedOrder& order : signed_orders()) {
    if (own.whole() > outside_friction) break;
    if (order.as_it_stands() || order.reversed()) continue;
    const Alignment other = align(normals, forces, [&](std::size_t i) -> Vec3 { return order.applied(forces[i]); });
    if (better_than_found(other)) found = ForceFrame{order.meaning(), "", recorded.whole(), other.whole()};
  }
  return found;
}

}  // namespace touchstone::recording_checks

#include "synthetic/surfaces/radial_bodies.h"

#include <array>
#include <cmath>

namespace touchstone::synthetic {
namespace {

class Bumpy final : public RadialFunction {
 public:
  explicit Bumpy(double radius_m) : radius_m_(radius_m) {}

  [[nodiscard]] double value(const Vec3& u) const override {
    return radius_m_ * (1.0 + 0.30 * u.x() * u.y() + 0.08 * std::sin(3.0 * u.x() + 1.0) * std::cos(2.0 * u.z()) +
                        0.05 * std::sin(5.0 * u.y()));
  }
  [[nodiscard]] RadialJet jet(const Vec3& u) const override {
    const double s3 = std::sin(3.0 * u.x() + 1.0);
    const double c3 = std::cos(3.0 * u.x() + 1.0);
    const double s2 = std::sin(2.0 * u.z());
    const double c2 = std::cos(2.0 * u.z());
    const double s5 = std::sin(5.0 * u.y());
    const double c5 = std::cos(5.0 * u.y());
    RadialJet jet;
    jet.value = radius_m_ * (1.0 + 0.30 * u.x() * u.y() + 0.08 * s3 * c2 + 0.05 * s5);
    jet.gradient = radius_m_ * Vec3(0.30 * u.y() + 0.24 * c3 * c2, 0.30 * u.x() + 0.25 * c5, -0.16 * s3 * s2);
    jet.hessian << -0.72 * s3 * c2, 0.30, -0.48 * c3 * s2,  //
        0.30, -1.25 * s5, 0.0,                              //
        -0.48 * c3 * s2, 0.0, -0.32 * s3 * c2;
    jet.hessian *= radius_m_;
    return jet;
  }

 private:
  double radius_m_;
};

struct Lobe {
  Vec3 direction;  // unit
  double height;   // of the half length
  double sharpness;
};

// x forward, z up.
const std::array<Lobe, 3> duck_lobes{Lobe{Vec3(0.58, 0.0, 0.81).normalized(), 0.75, 13.0},    // head
                                     Lobe{Vec3(0.86, 0.0, 0.51).normalized(), 0.34, 55.0},    // bill
                                     Lobe{Vec3(-0.90, 0.0, 0.43).normalized(), 0.25, 22.0}};  // tail

class Duck final : public RadialFunction {
 public:
  explicit Duck(double half_length_m) : half_length_m_(half_length_m) {}

  [[nodiscard]] double value(const Vec3& u) const override {
    double sum = 1.0 / std::sqrt(u.dot(q_ * u));
    for (const Lobe& lobe : duck_lobes) sum += lobe.height * std::exp(lobe.sharpness * (u.dot(lobe.direction) - 1.0));
    return half_length_m_ * sum;
  }
  [[nodiscard]] RadialJet jet(const Vec3& u) const override {
    const Vec3 qu = q_ * u;
    const double w = 1.0 / u.dot(qu);
    const double body = std::sqrt(w);
    RadialJet jet{body, -body * w * qu, 3.0 * body * w * w * qu * qu.transpose()};
    jet.hessian -= body * w * q_;
    for (const Lobe& lobe : duck_lobes) {
      const double v = lobe.height * std::exp(lobe.sharpness * (u.dot(lobe.direction) - 1.0));
      jet.value += v;
      jet.gradient += v * lobe.sharpness * lobe.direction;
      jet.hessian += v * lobe.sharpness * lobe.sharpness * lobe.direction * lobe.direction.transpose();
    }
    jet.value *= half_length_m_;
    jet.gradient *= half_length_m_;
    jet.hessian *= half_length_m_;
    return jet;
  }

 private:
  // The body's half axes: 1 long, 0.70 wide, 0.58 high, in half lengths.
  Mat3 q_ = Vec3(1.0, 1.0 / (0.70 * 0.70), 1.0 / (0.58 * 0.58)).asDiagonal();
  double half_length_m_;
};

}  // namespace

std::unique_ptr<RadialBody> bumpy_body(double radius_m) {
  return std::make_unique<RadialBody>(std::make_unique<Bumpy>(radius_m));
}

std::unique_ptr<RadialBody> duck_body(double half_length_m) {
  return std::make_unique<RadialBody>(std::make_unique<Duck>(half_length_m));
}

}  // namespace touchstone::synthetic

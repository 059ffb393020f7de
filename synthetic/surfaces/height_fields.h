// The open patches, heights z over (x, y) in metres: plane, saddle, Gaussian bump, sinusoidal texture.
#pragma once

#include "synthetic/surfaces/height_field.h"

namespace touchstone::synthetic {

// z = 0.
class Plane final : public HeightField {
 public:
  explicit Plane(double half_side_m) : HeightField(half_side_m) {}
  [[nodiscard]] Height height(double, double) const override { return {0.0, Vec2::Zero()}; }

 protected:
  [[nodiscard]] double second_derivative_bound(const Vec2&) const override { return 0.0; }
  [[nodiscard]] Vec2 foot(const Vec3& p) const override { return {p.x(), p.y()}; }
  [[nodiscard]] std::pair<double, double> range() const override { return {0.0, 0.0}; }
};

// z = (x^2 - y^2) / (2 R): principal radii R and -R at the origin. The closest point is that of a quadratic objective
// under one quadratic constraint: at its global minimum the Lagrangian is positive semidefinite (More 1993,
// theorem 3.2), which leaves one interval of the multiplier, where the secular equation is monotone.
class Saddle final : public HeightField {
 public:
  Saddle(double radius_m, double half_side_m) : HeightField(half_side_m), c_(1.0 / radius_m) {}
  [[nodiscard]] Height height(double x, double y) const override {
    return {0.5 * c_ * (x * x - y * y), {c_ * x, -c_ * y}};
  }

 protected:
  [[nodiscard]] double second_derivative_bound(const Vec2& d) const override {
    return c_ * std::max(d.x() * d.x(), d.y() * d.y());
  }
  [[nodiscard]] Vec2 foot(const Vec3& p) const override;
  [[nodiscard]] std::pair<double, double> range() const override {
    const double top = 0.5 * c_ * half_side_m() * half_side_m();
    return {-top, top};
  }

 private:
  double c_;
};

// z = A exp(-(x^2 + y^2) / (2 s^2)).
class GaussianBump final : public HeightField {
 public:
  GaussianBump(double amplitude_m, double width_m, double half_side_m)
      : HeightField(half_side_m), amplitude_m_(amplitude_m), width_m_(width_m) {}
  [[nodiscard]] Height height(double x, double y) const override;

 protected:
  // |h''| is largest at the top, A / s^2 (its eigenvalues: h'/r and h'').
  [[nodiscard]] double second_derivative_bound(const Vec2& d) const override {
    return amplitude_m_ / (width_m_ * width_m_) * d.squaredNorm();
  }
  [[nodiscard]] Vec2 foot(const Vec3& p) const override;
  [[nodiscard]] std::pair<double, double> range() const override { return {0.0, amplitude_m_}; }

 private:
  double amplitude_m_;
  double width_m_;
};

// z = A sin(2 pi x / wavelength): the texture of interfaces.md's `surface-texture` along x, without its phase.
class Sinusoid final : public HeightField {
 public:
  Sinusoid(double amplitude_m, double wavelength_m, double half_side_m)
      : HeightField(half_side_m), amplitude_m_(amplitude_m), wavelength_m_(wavelength_m) {}
  [[nodiscard]] Height height(double x, double y) const override;

 protected:
  [[nodiscard]] double second_derivative_bound(const Vec2& d) const override;
  [[nodiscard]] Vec2 foot(const Vec3& p) const override;
  [[nodiscard]] std::pair<double, double> range() const override { return {-amplitude_m_, amplitude_m_}; }

 private:
  double amplitude_m_;
  double wavelength_m_;
};

}  // namespace touchstone::synthetic

#include "renderers/field/signed_field.h"

#include <array>
#include <cmath>
#include <vector>

#include "harness/base/in_parallel.h"

namespace touchstone::renderers {
using surface::Surface;

namespace {

class AnalyticField final : public SignedField {
 public:
  explicit AnalyticField(std::shared_ptr<const Surface> surface)
      : surface_(std::move(surface)), size_m_(surface_->bounds().sizes().maxCoeff()) {}

  [[nodiscard]] double value_m(const Vec3& p_W_m) const override { return surface_->signed_distance(p_W_m); }
  [[nodiscard]] Vec3 gradient(const Vec3& p_W_m) const override {
    // Central differences of fourth order, (8 (f(d) - f(-d)) - (f(2d) - f(-2d))) / 12 d: the error of the fifth
    // derivative is d^4 / 30 of it, and rounding adds about 1e-16 / 1e-4 to the slope.
    const double d = 1e-4 * size_m_;
    Vec3 slope;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto at = [&](double step) { return value_m(p_W_m + step * Vec3::Unit(i)); };
      slope[i] = (8.0 * (at(d) - at(-d)) - (at(2.0 * d) - at(-2.0 * d))) / (12.0 * d);
    }
    return slope;
  }
  [[nodiscard]] double size_m() const noexcept override { return size_m_; }

 private:
  std::shared_ptr<const Surface> surface_;
  double size_m_;
};

// Keys' four weights at a fraction of the way from the second of four samples to the third, and their slopes.
template <class S>
struct Weights {
  std::array<S, 4> w;
  std::array<S, 4> slope;
};

template <class S>
Weights<S> cubic(const S& t) {
  const S t2 = t * t;
  const S t3 = t2 * t;
  return {{-0.5 * t3 + t2 - 0.5 * t, 1.5 * t3 - 2.5 * t2 + 1.0, -1.5 * t3 + 2.0 * t2 + 0.5 * t, 0.5 * t3 - 0.5 * t2},
          {-1.5 * t2 + 2.0 * t - 0.5, 4.5 * t2 - 5.0 * t, -4.5 * t2 + 4.0 * t + 0.5, 1.5 * t2 - t}};
}

template <class S>
class SampledField final : public SignedFieldOf<S> {
  using V = Vec3Of<S>;

 public:
  SampledField(const Surface& surface, int resolution) : box_(surface.bounds()) {
    size_m_ = box_.sizes().maxCoeff();
    // `resolution` nodes along the longest side, margins included; the shorter sides have as many as cover them.
    step_m_ = size_m_ / (resolution - 1 - 2 * margin);
    std::size_t nodes = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const double side = box_.sizes()[static_cast<Eigen::Index>(i)];
      count_[i] = static_cast<std::size_t>(std::ceil(side / step_m_ - 1e-6)) + 1 + std::size_t{2} * margin;
      nodes *= count_[i];
    }
    origin_W_m_ = box_.min() - step_m_ * Vec3::Constant(margin);
    value_m_.resize(nodes);
    const auto fill = [&](std::size_t row) {
      const std::size_t y = row % count_[1];
      const std::size_t z = row / count_[1];
      for (std::size_t x = 0; x < count_[0]; ++x) {
        const Vec3 node(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
        value_m_[row * count_[0] + x] = surface.signed_distance(origin_W_m_ + step_m_ * node);
      }
    };
    in_parallel(count_[2] * count_[1], fill, 1);
  }

  [[nodiscard]] S value_m(const V& p_W_m) const override {
    using std::sqrt;
    Place place{};
    if (!find(p_W_m, place)) return sqrt(squared_norm(beyond_box(p_W_m)));
    // The tensor product of the weights along the three axes over 4 x 4 x 4 nodes.
    S sum = 0.0;
    each(place, [&](std::size_t i, std::size_t j, std::size_t k, const S& value) {
      sum += place.along[0].w[i] * place.along[1].w[j] * place.along[2].w[k] * value;
    });
    return sum;
  }
  [[nodiscard]] V gradient(const V& p_W_m) const override {
    Place place{};
    if (!find(p_W_m, place)) return unit(beyond_box(p_W_m));
    // The product rule: the slope along one axis times the weights along the others, per metre at the end.
    V sum = V::Zero();
    const auto& [x, y, z] = place.along;
    each(place, [&, &x = x, &y = y, &z = z](std::size_t i, std::size_t j, std::size_t k, const S& value) {
      sum += value * V(x.slope[i] * y.w[j] * z.w[k], x.w[i] * y.slope[j] * z.w[k], x.w[i] * y.w[j] * z.slope[k]);
    });
    return sum / S(step_m_);
  }
  // Keys' weights add up to at most 5/4 in magnitude along each axis.
  [[nodiscard]] double steepness() const noexcept override { return 2.0; }
  [[nodiscard]] double size_m() const noexcept override { return size_m_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept override { return value_m_.capacity() * sizeof(double); }

 private:
  // Nodes beyond the body's box: a tip in contact stays where the cubic has all its samples.
  static constexpr int margin = 3;

  struct Place {
    std::array<std::size_t, 3> first{};  // of the four samples
    std::array<Weights<S>, 3> along{};
  };
  // From the body's box to p.
  [[nodiscard]] V beyond_box(const V& p_W_m) const {
    V way = V::Zero();
    for (Eigen::Index i = 0; i < 3; ++i) {
      const S least = box_.min()[i];
      const S most = box_.max()[i];
      if (p_W_m[i] < least) way[i] = p_W_m[i] - least;
      if (p_W_m[i] > most) way[i] = p_W_m[i] - most;
    }
    return way;
  }
  bool find(const V& p_W_m, Place& place) const {
    using std::floor;
    const V q = (p_W_m - origin_W_m_.template cast<S>()) / S(step_m_);
    for (std::size_t i = 0; i < 3; ++i) {
      const S at = q[static_cast<Eigen::Index>(i)];
      if (!(at >= S(1.0) && at < S(static_cast<double>(count_[i] - 2)))) return false;
      const S below = floor(at);
      place.first[i] = static_cast<std::size_t>(static_cast<double>(below)) - 1;
      place.along[i] = cubic(at - below);
    }
    return true;
  }
  template <class Visit>
  void each(const Place& place, const Visit& visit) const {
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t j = 0; j < 4; ++j) {
        const std::size_t row = ((place.first[2] + k) * count_[1] + place.first[1] + j) * count_[0] + place.first[0];
        for (std::size_t i = 0; i < 4; ++i) visit(i, j, k, S(value_m_[row + i]));
      }
    }
  }

  Box3 box_;
  Vec3 origin_W_m_;
  double size_m_ = 0.0;
  double step_m_ = 0.0;
  std::array<std::size_t, 3> count_{};
  std::vector<double> value_m_;
};

}  // namespace

std::unique_ptr<SignedField> make_analytic_field(std::shared_ptr<const Surface> surface) {
  return std::make_unique<AnalyticField>(std::move(surface));
}

std::unique_ptr<SignedField> make_sampled_field(const Surface& surface, int resolution) {
  return std::make_unique<SampledField<double>>(surface, resolution);
}

std::unique_ptr<SignedFieldOf<Counted>> make_counted_field(const Surface& surface, int resolution) {
  return std::make_unique<SampledField<Counted>>(surface, resolution);
}

}  // namespace touchstone::renderers

#include "renderers/field/implicit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderers/field/signed_field.h"

namespace touchstone::renderers {
using rendering::Ability;
using rendering::Renderer;
using rendering::StepResult;

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr int turns = 400;   // tangent plane and back; each gains a factor of depth over radius of curvature
constexpr int newton = 20;   // to the zero level
constexpr int march = 4096;  // along the tip's way

// A template over its scalar, so that the operations can be counted (harness/base/counted.h).
template <class S>
class Implicit final : public Renderer {
  using V = Vec3Of<S>;

 public:
  Implicit(std::unique_ptr<SignedFieldOf<S>> field, double stiffness_N_per_m, double radius_m)
      : field_(std::move(field)), stiffness_N_per_m_(stiffness_N_per_m), radius_m_(radius_m) {}

  [[nodiscard]] std::optional<std::size_t> memory_bytes() const noexcept override { return field_->memory_bytes(); }

 private:
  void do_reset() override {
    started_ = false;
    touching_ = false;
  }

  StepResult do_step(const rendering::TipState& tip) noexcept override {
    const V p = tip.p_W_m.cast<S>();
    using std::abs;
    rounding_m_ = 32.0 * eps * (field_->size_m() + std::max({abs(p[0]), abs(p[1]), abs(p[2])}));
    const S here_m = level(p);
    if (!touching_) {
      touching_ = started_ ? enter(p, here_m) : here_m < S(0.0);
      if (touching_ && !started_) on_W_m_ = p;
    }
    started_ = true;
    V n = V::Zero();
    if (touching_) {
      n = settle(p);
      if (dot(n, p - on_W_m_) >= S(0.0)) {
        // Let go; where the tip is in the body for all that, it is held by the part that it came to be in.
        touching_ = here_m < S(0.0);
        if (touching_) {
          on_W_m_ = p;
          n = settle(p);
        }
      }
    }
    last_W_m_ = p;
    last_m_ = here_m;
    return answer(p, n);
  }

  [[nodiscard]] StepResult answer(const V& p, const V& n) const noexcept {
    using std::sqrt;
    StepResult result;
    result.contact_W_m = p.template cast<double>();
    if (!touching_) return result;
    const V push_m = on_W_m_ - p;
    const S depth_m = sqrt(squared_norm(push_m));
    result.contact = true;
    result.contact_W_m = on_W_m_.template cast<double>();
    result.depth_m = static_cast<double>(depth_m);
    result.f_W_N = (stiffness_N_per_m_ * push_m).template cast<double>();
    result.n_W = (depth_m > S(0.0) ? V(push_m / depth_m) : n).template cast<double>();
    return result;
  }

  [[nodiscard]] S level(const V& x) const { return field_->value_m(x) - radius_m_; }

  // Whether the way from the last tip to p meets the body; on_W_m_ is then where.
  bool enter(const V& p, const S& here_m) noexcept {
    using std::sqrt;
    const V way = p - last_W_m_;
    const S length = sqrt(squared_norm(way));
    const S steep = field_->steepness();
    // No surface within reach of either end.
    if (here_m >= S(0.0) && std::max(S(0.0), last_m_) + here_m > steep * length) return false;
    S done = 0.0;
    S value = last_m_;
    // A stride that rounding would swallow is made this long: shorter ones find no crossing that matters.
    const S least = std::max(4.0 * rounding_m_, length / S(march));
    for (int i = 0; i < march && done < length; ++i) {
      done = std::min(length, done + std::max(least, value / steep));
      const V x = last_W_m_ + done / length * way;
      value = level(x);
      if (value < S(0.0)) {
        on_W_m_ = x;
        return true;
      }
    }
    return false;
  }

  // Moves on_W_m_ to where the body holds the tip and returns the outward normal there.
  V settle(const V& p) noexcept {
    using std::sqrt;
    descend(on_W_m_);
    V n = unit(field_->gradient(on_W_m_));
    S moved = std::numeric_limits<double>::infinity();
    for (int turn = 0; turn < turns; ++turn) {
      V x = p - dot(n, p - on_W_m_) * n;
      descend(x);
      const S step = sqrt(squared_norm(x - on_W_m_));
      // Rounding keeps it moving: it has come as near as it will.
      if (turn > 8 && step >= moved && step <= 64.0 * rounding_m_) break;
      moved = step;
      on_W_m_ = x;
      n = unit(field_->gradient(x));
      if (step <= rounding_m_) break;
    }
    return n;
  }

  void descend(V& x) const noexcept {
    using std::abs;
    for (int i = 0; i < newton; ++i) {
      const S value = level(x);
      if (abs(value) <= 0.25 * rounding_m_) return;
      const V slope = field_->gradient(x);
      const S steep2 = squared_norm(slope);
      if (!(steep2 > S(eps))) return;
      x -= value / steep2 * slope;
    }
  }

  std::unique_ptr<SignedFieldOf<S>> field_;
  S stiffness_N_per_m_;
  S radius_m_;
  S rounding_m_ = 0.0;
  bool started_ = false;
  bool touching_ = false;
  V last_W_m_ = V::Zero();
  S last_m_ = 0.0;        // the level there
  V on_W_m_ = V::Zero();  // surface contact point
};

std::unique_ptr<Renderer> make(const rendering::Parameters& parameters,
                               const std::shared_ptr<const surface::Surface>& surface) {
  auto field = surface->mesh() == nullptr
                   ? make_analytic_field(surface)
                   : make_sampled_field(*surface, static_cast<int>(std::lround(parameters.at("resolution"))));
  return std::make_unique<Implicit<double>>(std::move(field), parameters.at("stiffness_N_per_m"),
                                            parameters.at("tip_radius_m"));
}

std::unique_ptr<Renderer> make_counted(const rendering::Parameters& parameters,
                                       const std::shared_ptr<const surface::Surface>& surface) {
  auto field = make_counted_field(*surface, static_cast<int>(std::lround(parameters.at("resolution"))));
  return std::make_unique<Implicit<Counted>>(std::move(field), parameters.at("stiffness_N_per_m"),
                                             parameters.at("tip_radius_m"));
}

}  // namespace

rendering::RendererEntry implicit_entry() {
  return {"implicit",
          "holds the surface contact point on the zero level of a signed distance field: a slow reference for smooth "
          "shapes",
          "Salisbury and Tarr 1997",
          {{"stiffness_N_per_m", "N/m", std::numeric_limits<double>::min(), 1e9, 500.0,
            "spring from tip to surface contact point"},
           {"tip_radius_m", "m", 0.0, 1e3, 0.0, "0: a point; else a ball whose centre the positions are"},
           {"resolution", "1", 12.0, 512.0, 64.0, "of a mesh: samples along the longest side; nothing else reads it"}},
          {{Ability::thin_shells, "of a mesh: a body thinner than two samples is not in its field"},
           {Ability::large_jumps, "of a mesh: a body thinner than two samples is not in its field"},
           {Ability::start_inside, "of a mesh: the way out is that of the interpolated field"},
           {Ability::surface_contact, "of a mesh: the contact point is on the interpolated field's zero level"},
           {Ability::rigid_motion, "of a mesh: the samples lie along the axes"}},
          make,
          make_counted};
}

}  // namespace touchstone::renderers

#include "synthetic/surfaces/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "harness/base/error.h"

namespace touchstone::synthetic {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

Vec2 right_of(const Vec2& direction) { return Vec2(direction.y(), -direction.x()).normalized(); }

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

Vec2 normal_at(const ProfileElement& e, const Vec2& p) {
  if (!e.is_arc) return e.normal;
  return (e.sweep > 0.0 ? 1.0 : -1.0) * (p - e.centre).normalized();
}

// How far along the arc the direction of p from its centre lies, as a fraction of the sweep in [0, 2 pi / |sweep|).
double arc_fraction(const ProfileElement& e, const Vec2& p) {
  const Vec2 d = p - e.centre;
  double turned = std::atan2(d.y(), d.x()) - e.start_angle;
  if (e.sweep < 0.0) turned = -turned;
  turned -= two_pi * std::floor(turned / two_pi);
  return turned / std::abs(e.sweep);
}

struct Fillet {
  Vec2 in, out;  // where the side before ends and the side after begins
  std::optional<ProfileElement> arc;
};

Fillet fillet(const Corner& before, const Corner& corner, const Corner& after) {
  const Vec2& p = corner.p;
  const Vec2 back = before.p - p;
  const Vec2 ahead = after.p - p;
  const double turn = std::atan2(cross(-back, ahead), (-back).dot(ahead));  // positive: to the left, convex
  if (corner.radius <= 0.0 || turn == 0.0) return {p, p, std::nullopt};
  const double cut = corner.radius * std::tan(0.5 * std::abs(turn));
  const auto room = [](const Vec2& side, const Corner& other) {
    return side.norm() * (other.radius > 0.0 ? 0.5 : 1.0);
  };
  if (cut > room(back, before) || cut > room(ahead, after)) {
    throw UsageError(
        fmt::format("an edge radius of {} m does not fit at the profile's corner ({}, {}) m, which turns by {} rad: it "
                    "would cut {} m "
                    "from sides of {} m and {} m; choose a smaller radius or a wider shape",
                    corner.radius, p.x(), p.y(), turn, cut, back.norm(), ahead.norm()));
  }
  const Vec2 in = p + cut * back.normalized();
  const Vec2 from_centre = right_of(-back) * (turn > 0.0 ? 1.0 : -1.0);
  ProfileElement arc =
      profile_arc(in - corner.radius * from_centre, corner.radius, std::atan2(from_centre.y(), from_centre.x()), turn);
  // The very points where the lines end, so that no rounding opens the joint.
  arc.start = in;
  arc.end = p + cut * ahead.normalized();
  return {in, arc.end, arc};
}

}  // namespace

ProfileElement profile_line(const Vec2& start, const Vec2& end) {
  return {false, start, end, right_of(end - start), Vec2::Zero(), 0, 0, 0};
}

ProfileElement profile_arc(const Vec2& centre, double radius, double start_angle, double sweep) {
  const Vec2 start = centre + radius * unit(start_angle);
  const Vec2 end = std::abs(sweep) >= two_pi ? start : Vec2(centre + radius * unit(start_angle + sweep));
  return {true, start, end, Vec2::Zero(), centre, radius, start_angle, sweep};
}

double ProfileElement::length() const { return is_arc ? radius * std::abs(sweep) : (end - start).norm(); }

Vec2 ProfileElement::at(double fraction) const {
  if (fraction <= 0.0) return start;
  if (fraction >= 1.0) return end;
  if (!is_arc) return start + fraction * (end - start);
  return centre + radius * unit(start_angle + fraction * sweep);
}

Profile::Profile(std::vector<ProfileElement> elements, bool closed) : elements_(std::move(elements)), closed_(closed) {
  const std::size_t n = elements_.size();
  for (std::size_t i = 0; i <= n; ++i) {
    const bool first = i == 0;
    const bool last = i == n;
    if (last && closed_) break;
    const ProfileElement* const before = first ? (closed_ ? &elements_[n - 1] : nullptr) : &elements_[i - 1];
    const ProfileElement* const after = last ? nullptr : &elements_[i];
    Vec2 sum = Vec2::Zero();
    if (before != nullptr) sum += normal_at(*before, before->end);
    if (after != nullptr) sum += normal_at(*after, after->start);
    // Two unit normals that agree but for rounding sum up to 2.
    joints_.push_back({sum.normalized(), before != nullptr && after != nullptr && sum.norm() < 2.0 * (1.0 - 1e-15)});
  }
}

Profile Profile::through(const std::vector<Corner>& corners, bool closed) {
  const std::size_t n = corners.size();
  std::vector<Fillet> joints;
  for (std::size_t i = 0; i < n; ++i) {
    const bool is_end = !closed && (i == 0 || i + 1 == n);
    joints.push_back(is_end ? Fillet{corners[i].p, corners[i].p, std::nullopt}
                            : fillet(corners[(i + n - 1) % n], corners[i], corners[(i + 1) % n]));
  }
  std::vector<ProfileElement> elements;
  for (std::size_t i = 0; i < n; ++i) {
    if (joints[i].arc) elements.push_back(*joints[i].arc);
    const Vec2& next = joints[(i + 1) % n].in;
    // A fillet that uses up a whole side leaves a line of no length: the arcs already join.
    if ((closed || i + 1 < n) && joints[i].out != next) elements.push_back(profile_line(joints[i].out, next));
  }
  return Profile(std::move(elements), closed);
}

ProfilePoint Profile::closest(const Vec2& p) const {
  ProfilePoint best{Vec2::Zero(), Vec2::Zero(), 0.0, false};
  double best_distance = -1.0;
  const auto offer = [&](const Vec2& q, const Vec2& n, double distance, double side, bool corner) {
    if (best_distance >= 0.0 && distance >= best_distance) return;
    best_distance = distance;
    best = {q, n, side < 0.0 ? -distance : distance, corner};
  };
  const auto offer_corner = [&](const Vec2& q, std::size_t index) {
    const Joint& joint = joints_[index % joints_.size()];
    offer(q, joint.n, (p - q).norm(), (p - q).dot(joint.n), joint.sharp);
  };
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const ProfileElement& e = elements_[i];
    if (!e.is_arc) {
      const Vec2 along = e.end - e.start;
      const double fraction = (p - e.start).dot(along) / along.squaredNorm();
      if (fraction <= 0.0) {
        offer_corner(e.start, i);
      } else if (fraction >= 1.0) {
        offer_corner(e.end, i + 1);
      } else {
        const double side = (p - e.start).dot(e.normal);
        offer(p - side * e.normal, e.normal, std::abs(side), side, false);
      }
      continue;
    }
    const double from_centre = (p - e.centre).norm();
    const bool at_centre = from_centre == 0.0;
    const double fraction = at_centre ? 0.5 : arc_fraction(e, p);
    if (fraction <= 1.0) {
      const Vec2 radial = at_centre ? unit(e.start_angle + 0.5 * e.sweep) : Vec2((p - e.centre) / from_centre);
      const double sign = e.sweep > 0.0 ? 1.0 : -1.0;
      offer(e.centre + e.radius * radial, sign * radial, std::abs(from_centre - e.radius),
            sign * (from_centre - e.radius), false);
    } else {
      offer_corner(e.start, i);
      offer_corner(e.end, i + 1);
    }
  }
  return best;
}

double Profile::length() const {
  double sum = 0.0;
  for (const ProfileElement& e : elements_) sum += e.length();
  return sum;
}

Profile::Samples Profile::sample(std::size_t count) const {
  const double total_length = length();
  double total_turn = 0.0;
  for (const ProfileElement& e : elements_) total_turn += std::abs(e.sweep);
  const double by_length = total_turn > 0.0 ? 0.5 : 1.0;
  Samples samples{{}, 0.0};
  for (const ProfileElement& e : elements_) {
    const double turn_share = total_turn > 0.0 ? (1.0 - by_length) * std::abs(e.sweep) / total_turn : 0.0;
    const double share = by_length * e.length() / total_length + turn_share;
    // An arc of a quarter turn keeps at least two chords, so that no mesh folds.
    const double least = e.is_arc ? std::ceil(std::abs(e.sweep) / (0.25 * std::numbers::pi)) : 1.0;
    const auto pieces = static_cast<std::size_t>(std::max(least, std::round(share * static_cast<double>(count))));
    for (std::size_t i = 0; i < pieces; ++i) {
      samples.points.push_back(e.at(static_cast<double>(i) / static_cast<double>(pieces)));
    }
    if (e.is_arc) {
      const double half = 0.5 * std::abs(e.sweep) / static_cast<double>(pieces);
      // 1 - cos as 2 sin^2(half/2): exact for the tiny angles of nearly flat creases too.
      samples.sagitta = std::max(samples.sagitta, e.radius * 2.0 * std::pow(std::sin(0.5 * half), 2));
    }
  }
  if (!closed_) samples.points.push_back(elements_.back().end);
  return samples;
}

}  // namespace touchstone::synthetic

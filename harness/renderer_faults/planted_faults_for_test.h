// The faults of the matrix, each with the detector that must name it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "harness/base/random.h"
#include "harness/renderer_faults/planted_fault_for_test.h"

namespace touchstone::renderer_faults {
using rendering::StepResult;
using rendering::TipState;

// A step's answer is free again where it was not in contact then.
inline void at_this_tip(StepResult& result, const TipState& tip) {
  if (!result.contact) result.contact_W_m = tip.p_W_m;
}

inline Fault held(double period) {
  return {fmt::format("held for {:g}", period), "held-answer", {}, [period](auto& r, auto& tip, auto& m) {
            const auto now = static_cast<double>(m.since_reset);
            const bool update = std::floor(now / period) != std::floor((now - 1.0) / period);
            if (update || m.since_reset == 0) m.kept = r;
            r = m.kept;
            at_this_tip(r, tip);
          }};
}

inline Fault late(std::size_t lag) {
  return {fmt::format("late by {}", lag), "delay", {}, [lag](auto& r, auto& tip, auto& m) {
            m.past.push_back(r);
            r = m.past.size() > lag ? m.past[m.past.size() - 1 - lag] : StepResult{};
            if (m.past.size() > 2 * lag + 2) m.past.pop_front();
            at_this_tip(r, tip);
          }};
}

// One in every so many answers is that of the sample before.
inline Fault alternate(std::size_t period) {
  return {fmt::format("one in {} late", period), "alternate-lag", {}, [period](auto& r, auto& tip, auto& m) {
            const StepResult now = r;
            if (m.since_reset % period == 1) r = m.kept;
            at_this_tip(r, tip);
            m.kept = now;
          }};
}

// The contact point of the sample before, the spring to the tip of now.
inline Fault alternate_contact(std::size_t one_in) {
  return {fmt::format("contact point of one in {} late", one_in),
          "alternate-lag",
          {},
          [one_in](auto& r, auto& tip, auto& m) {
            const StepResult now = r;
            if (m.since_reset % one_in == one_in - 1) {
              r = m.kept;
              if (r.contact) r.f_W_N = 500.0 / m.unit * (r.contact_W_m - tip.p_W_m);
              at_this_tip(r, tip);
            }
            m.kept = now;
          }};
}

// A proxy that is updated less often than the spring between it and the tip.
inline Fault held_contact(double samples) {
  return {
      fmt::format("contact point held for {:g}", samples), "held-answer", {}, [samples](auto& r, auto& tip, auto& m) {
        const auto update = [&](std::size_t i) { return std::floor(static_cast<double>(i) / samples); };
        if (m.since_reset == 0 || update(m.since_reset) != update(m.since_reset - 1)) m.kept = r;
        r = m.kept;
        if (r.contact) r.f_W_N = 500.0 / m.unit * (r.contact_W_m - tip.p_W_m);
        r.depth_m = std::max(0.0, r.n_W.dot(r.contact_W_m - tip.p_W_m));
        at_this_tip(r, tip);
      }};
}

// One in so many answers, at random, is that of the sample before.
inline Fault now_and_then(std::uint64_t one_in) {
  return {fmt::format("one in {} late at random", one_in), "jitter", {}, [one_in](auto& r, auto& tip, auto& m) {
            const StepResult now = r;
            if (Random(5 + m.since_reset).below(one_in) == 0 && m.since_reset > 0) r = m.kept;
            at_this_tip(r, tip);
            m.kept = now;
          }};
}

inline Fault irregular() {
  return {"late at random", "jitter", {}, [](auto& r, auto& tip, auto& m) {
            m.past.push_back(r);
            if (m.past.size() > 6) m.past.pop_front();
            const std::size_t lag = Random(m.since_reset).below(4);
            r = m.past[m.past.size() - 1 - std::min(lag, m.past.size() - 1)];
            at_this_tip(r, tip);
          }};
}

inline Fault filtered(double time_constant_s) {
  return {fmt::format("filtered by {:g} s", time_constant_s), "filter", {}, [=](auto& r, auto& tip, auto& m) {
            const double share = -std::expm1(-(tip.t_s - m.last_t_s) / time_constant_s);
            m.kept.f_W_N += (m.since_reset == 0 ? 1.0 : share) * (r.f_W_N - m.kept.f_W_N);
            if (!r.contact) m.kept.f_W_N.setZero();
            r.f_W_N = m.kept.f_W_N;
          }};
}

// Goes on in the air when the surface is left.
inline Fault fades(double time_constant_s) {
  return {fmt::format("fades with {:g} s", time_constant_s), "filter", {}, [=](auto& r, auto& tip, auto& m) {
            const double share = m.since_reset == 0 ? 1.0 : -std::expm1(-(tip.t_s - m.last_t_s) / time_constant_s);
            r.f_W_N = m.kept.f_W_N += share * (r.f_W_N - m.kept.f_W_N);
          }};
}

// Two low-pass filters one behind the other.
inline Fault filtered_twice(double time_constant_s) {
  return {fmt::format("filtered twice by {:g} s", time_constant_s), "filter", {}, [=](auto& r, auto& tip, auto& m) {
            const double share = m.since_reset == 0 ? 1.0 : -std::expm1(-(tip.t_s - m.last_t_s) / time_constant_s);
            Vec3& once_N = m.kept.n_W;
            once_N += share * (r.f_W_N - once_N);
            m.kept.f_W_N += share * (once_N - m.kept.f_W_N);
            if (!r.contact) once_N = m.kept.f_W_N = Vec3::Zero();
            r.f_W_N = m.kept.f_W_N;
          }};
}

inline Fault mean_over(std::size_t samples) {
  return {fmt::format("the mean over {} samples", samples), "filter", {}, [samples](auto& r, auto&, auto& m) {
            m.past.push_back(r);
            if (m.past.size() > samples) m.past.pop_front();
            Vec3 sum_N = Vec3::Zero();
            for (const StepResult& one : m.past) sum_N += one.f_W_N;
            r.f_W_N = sum_N / static_cast<double>(samples);
          }};
}

inline Fault slow_rise(double per_sample_N) {
  return {fmt::format("changes by {:g} N at most", per_sample_N), "clipped-rate", {}, [=](auto& r, auto&, auto& m) {
            const Vec3 change = r.f_W_N - m.kept.f_W_N;
            if (change.norm() > per_sample_N) r.f_W_N = m.kept.f_W_N + per_sample_N * change.normalized();
            m.kept.f_W_N = r.f_W_N;
          }};
}

inline Fault mapped(const std::string& name, const std::string& caught_by,
                    const std::function<Vec3(const Vec3&)>& map) {
  return {name, caught_by, {}, [map](auto& r, auto&, auto&) { r.f_W_N = map(r.f_W_N); }};
}

inline Fault clipped_by_axis(double limit_N) {
  return mapped(fmt::format("clipped at {:g} N by axis", limit_N), "saturation",
                [=](const Vec3& f) { return Vec3(f.cwiseMax(-limit_N).cwiseMin(limit_N)); });
}

// Along one axis, which need be none of x, y and z.
inline Fault clipped_along(const Vec3& axis, double limit_N) {
  return mapped(fmt::format("clipped at {:g} N along a leaning axis", limit_N), "saturation", [=](const Vec3& f) {
    const Vec3 n = axis.normalized();
    return Vec3(f + (std::clamp(f.dot(n), -limit_N, limit_N) - f.dot(n)) * n);
  });
}

// Along the axes of a device that stands askew.
inline Fault clipped_in_frame(const Quat& turn, double limit_N) {
  return mapped(fmt::format("clipped at {:g} N in a turned frame", limit_N), "saturation", [=](const Vec3& f) {
    return Vec3(turn * Vec3((turn.conjugate() * f).cwiseMax(-limit_N).cwiseMin(limit_N)));
  });
}

inline Fault in_steps(double step_N) {
  return mapped(fmt::format("in steps of {:g} N", step_N), "quantised",
                [=](const Vec3& f) { return Vec3(step_N * (f / step_N).array().round().matrix()); });
}

inline Fault less_on_release(double share, bool also_at_rest) {
  return {fmt::format("{:g} less on release{}", share, also_at_rest ? ", and at rest" : ""),
          "hysteresis",
          {},
          [=](auto& r, auto&, auto& m) {
            constexpr double same_m = 1e-13;
            const double before_m = m.kept.depth_m;
            m.kept.depth_m = r.depth_m;
            if (r.depth_m > before_m + same_m * m.unit || !r.contact) m.figure = 0.0;
            if (r.depth_m < before_m - same_m * m.unit) m.figure = share;
            if (!also_at_rest && std::abs(r.depth_m - before_m) <= same_m * m.unit) m.figure = 0.0;
            r.f_W_N *= 1.0 - m.figure;
          }};
}

inline Fault drops_out(std::uint64_t one_in, std::size_t in_a_row = 1) {
  return {
      fmt::format("1 of {} dropped, {} in a row", one_in, in_a_row), "dropout", {}, [=](auto& r, auto& tip, auto& m) {
        for (std::size_t back = 0; back < std::min(in_a_row, m.steps + 1); ++back) {
          if (Random(77 + m.steps - back).below(one_in) == 0) nothing_there(r, tip);
        }
      }};
}

inline Fault noise(const std::string& name, const std::function<Vec3(const TipState&, const Memory&)>& added_N) {
  return {name, "noise", {}, [added_N](auto& r, auto& tip, auto& m) {
            if (r.contact) r.f_W_N += added_N(tip, m);
          }};
}

// Of one face of a ball of 2048, as many as its index says; no other body has as many.
inline Fault bad_face(std::int32_t face, double factor) {
  return {fmt::format("face {} times {:g}", face, factor), "one-bad-face", {}, [=](auto& r, auto&, auto& m) {
            if (r.contact && m.surface->closest(r.contact_W_m).triangle == face) r.f_W_N *= factor;
          }};
}

inline double damped_N(const StepResult& r, const TipState& tip, const Memory& m, double coefficient) {
  if (!r.contact || m.since_reset == 0) return 0.0;
  return -coefficient * r.n_W.dot(tip.p_W_m - m.last_tip) / m.unit / (tip.t_s - m.last_t_s);
}

inline Fault damper(double coefficient_N_s_per_m) {
  return {fmt::format("damped by {:g} N s/m", coefficient_N_s_per_m), "", {}, [=](auto& r, auto& tip, auto& m) {
            const double all_N = r.f_W_N.dot(r.n_W);
            if (r.contact) r.f_W_N += std::max(-all_N, damped_N(r, tip, m, coefficient_N_s_per_m)) * r.n_W;
          }};
}

// Where contact begins and ends, and where the tip is in a body.
inline std::vector<Fault> of_the_contact() {
  std::vector<Fault> list;
  list.push_back({"lingers for a sample", "gap-at-contact", {}, [](auto& r, auto&, auto& m) {
                    const StepResult now = r;
                    if (!r.contact && m.kept.contact) r.f_W_N = 0.2 * m.kept.f_W_N;
                    m.kept = now;
                  }});
  list.push_back({"begins 40 um late, whatever the unit", "gap-at-contact", {}, [](auto& r, auto& tip, auto&) {
                    if (r.contact && r.depth_m < 4e-5) nothing_there(r, tip);
                  }});
  list.push_back({"doubles the depth it gives", "standoff", {}, [](auto& r, auto&, auto&) { r.depth_m *= 2.0; }});
  list.push_back({"constant force", "gap-at-contact", {}, [](auto& r, auto&, auto&) {
                    if (r.contact) r.f_W_N = 5.0 * r.n_W;
                  }});
  list.push_back({"a force in the plane of a wall", "tie-break", {}, [](auto& r, auto& tip, auto& m) {
                    if (!r.contact && tip.p_W_m.z() == 0.0 && tip.p_W_m.x() > 0.0)
                      r.f_W_N = 480.0 / m.unit * Vec3(tip.p_W_m);
                  }});
  list.push_back({"nothing in the middle between two faces", "tie-break", {}, [](auto& r, auto& tip, auto& m) {
                    const auto bounds = m.surface->mesh()->bounds();
                    const double middle_m = 0.5 * (bounds.min().z() + bounds.max().z());
                    if (r.contact && std::abs(tip.p_W_m.z() - middle_m) < 1e-12 * m.unit) nothing_there(r, tip);
                  }});
  list.push_back({"lost 2.5 mm deep", "falls-through-block", {}, [](auto& r, auto& tip, auto& m) {
                    if (r.depth_m > 2.5e-3 * m.unit) nothing_there(r, tip);
                  }});
  return list;
}

inline std::vector<Fault> of_the_force() {
  std::vector<Fault> list{
      late(1),
      late(3),
      late(8),
      late(31),
      late(113),
      held(16),
      held(1000.0 / 60.0),
      held(4),
      alternate(5),
      alternate(50),
      alternate(3),
      irregular(),
      now_and_then(80),
      filtered(1e-3),
      filtered(5e-3),
      fades(4e-3),
      filtered_twice(3e-3),
      mean_over(2),
      mean_over(6),
      slow_rise(0.05),
      slow_rise(0.4),
      mapped("x mirrored", "mirrored-axis", [](const Vec3& f) { return Vec3(-f.x(), f.y(), f.z()); }),
      mapped("positive x mirrored", "mirrored-axis",
             [](const Vec3& f) { return Vec3(-std::abs(f.x()), f.y(), f.z()); }),
      mapped("positive y mirrored", "mirrored-axis",
             [](const Vec3& f) { return Vec3(f.x(), -std::abs(f.y()), f.z()); }),
      mapped("inverted", "mirrored-axis", [](const Vec3& f) { return Vec3(-f); }),
      mapped("y and z exchanged", "exchanged-axes", [](const Vec3& f) { return Vec3(f.x(), f.z(), f.y()); }),
      mapped("x, y and z in turn", "exchanged-axes", [](const Vec3& f) { return Vec3(f.z(), f.x(), f.y()); }),
      mapped("y lost", "lost-axis", [](const Vec3& f) { return Vec3(f.x(), 0.0, f.z()); }),
      mapped("y and z lost", "lost-axis", [](const Vec3& f) { return Vec3(f.x(), 0.0, 0.0); }),
      clipped_by_axis(3.0),
      clipped_by_axis(0.7),
      mapped("clipped at 4 N", "saturation", [](const Vec3& f) { return Vec3(f * std::min(1.0, 4.0 / f.norm())); }),
      clipped_along({2.0, -1.0, 2.0}, 0.7),
      clipped_in_frame(Quat(0.9, -0.2, 0.3, 0.25).normalized(), 1.6),
      mapped("clipped along z alone", "saturation",
             [](const Vec3& f) { return Vec3(f.x(), f.y(), std::clamp(f.z(), -1.3, 1.3)); }),
      mapped("clipped where positive", "saturation", [](const Vec3& f) { return Vec3(f.cwiseMin(1.7)); }),
      in_steps(0.02),
      in_steps(0.005),
      in_steps(0.1),
      mapped("cut off to steps", "quantised",
             [](const Vec3& f) {
               return Vec3(f.unaryExpr([](double part) { return 0.015 * std::trunc(part / 0.015); }));
             }),
      mapped("cut off downwards", "quantised",
             [](const Vec3& f) { return Vec3(0.008 * (f / 0.008).array().floor().matrix()); }),
      less_on_release(0.05, true),
      less_on_release(0.03, false),
      drops_out(4000),
      drops_out(300),
      drops_out(1100, 4),
      bad_face(1234, -1.0),
      bad_face(777, 0.0),
      bad_face(499, 1.5),
      bad_face(13, 1.4),
      noise("white noise", [](const TipState&, const Memory& m) { return Vec3(6e-3 * Random(m.steps).direction()); }),
      noise("a hum", [](const TipState& tip, const Memory&) {
        return Vec3(0.008 * std::sin(2.0 * M_PI * 83.3 * tip.t_s) * Vec3(0.3, 0.2, 1.0));
      })};
  list.push_back({"stiffer to the right", "place-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    r.f_W_N *= std::exp(10.0 * tip.p_W_m.x() / m.unit);
                  }});
  list.push_back({"softer above", "place-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    r.f_W_N *= 1.0 - 2.0 * tip.p_W_m.z() / m.unit;
                  }});
  list.push_back({"in waves of 7 mm", "place-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    r.f_W_N *= 1.0 + 0.12 * std::sin(2.0 * M_PI * tip.p_W_m.y() / m.unit / 7e-3);
                  }});
  list.push_back(mapped("turned by 8 degrees", "wrong-frame",
                        [](const Vec3& f) { return Vec3(Eigen::AngleAxisd(0.14, Vec3::UnitY()) * f); }));
  list.push_back(mapped("more along y", "wrong-frame", [](const Vec3& f) { return Vec3(f.x(), 1.25 * f.y(), f.z()); }));
  list.push_back({"scaled by the time of a sample", "rate-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    if (m.since_reset > 0) r.f_W_N *= std::pow((tip.t_s - m.last_t_s) / 1e-3, 0.25);
                  }});
  list.push_back({"damped by the sample", "rate-dependent", {}, [](auto& r, auto& tip, auto& m) {
                    r.f_W_N += damped_N(r, tip, m, 50.0) * (tip.t_s - m.last_t_s) * r.n_W;
                  }});
  for (const Fault& fault : of_the_contact()) list.push_back(fault);
  return list;
}

// The way from the centre of a ball to the nearest point has no direction where the centre is on the surface.
inline Fault lost_on_the_surface() {
  return {"lost where its centre is on the surface", "tie-break", {}, [](auto& r, auto& tip, auto&) {
            if (r.contact && tip.p_W_m.z() == 0.0) nothing_there(r, tip);
          }};
}

// Where its normal turns by more than 0.2 rad from sample to sample, it does so 12 samples later.
inline Fault hangs_behind() {
  return {"hangs behind at edges", "ball-at-edge", {}, [](auto& r, auto& tip, auto& m) {
            constexpr double wait = 12.0;
            const bool turned = r.contact && m.kept.contact && r.n_W.dot(m.kept.n_W) < 0.98;
            m.figure = turned ? m.figure + 1.0 : 0.0;
            if (!turned || m.figure > wait) {
              m.kept = r;
              m.figure = 0.0;
              return;
            }
            r = m.kept;
            r.f_W_N = 500.0 / m.unit * (r.contact_W_m - tip.p_W_m);
          }};
}

}  // namespace touchstone::renderer_faults

// A small evaluation with an answer known in advance, for the tests of this room: a sphere stroked at a constant speed.
#pragma once

#include <cmath>
#include <numbers>

#include "harness/metrics/catalogue.h"
#include "harness/report/evaluation.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::report {

inline surface::TriangleMesh sample_sphere(double radius_m, int rings) {
  surface::TriangleMesh mesh;
  const int sectors = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < sectors; ++j) {
      const double polar = std::numbers::pi * i / rings;
      const double around = 2.0 * std::numbers::pi * j / sectors;
      mesh.vertices_W_m.push_back(
          radius_m * Vec3(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)));
    }
  }
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < sectors; ++j) {
      const int a = i * sectors + j, b = i * sectors + (j + 1) % sectors;
      mesh.triangles.push_back({a, a + sectors, b});
      mesh.triangles.push_back({b, a + sectors, b + sectors});
    }
  }
  return mesh;
}

// `name` reaches every text that could come from an input file.
inline EvaluationResult sample_result(const std::string& name) {
  const double radius = 0.03;
  const surface::TriangleMesh sphere = sample_sphere(radius, 24);
  metrics::MetricSet metrics({}, {}, {});
  std::array<metrics::SeriesRecorder, 6> signals{metrics::SeriesRecorder{"measured_x", "N"},
                                                 {"measured_y", "N"},
                                                 {"measured_z", "N"},
                                                 {"rendered_x", "N"},
                                                 {"rendered_y", "N"},
                                                 {"rendered_z", "N"}};
  EvaluationResult result;
  result.object.vertices_W_m = sphere.vertices_W_m;
  result.object.triangles = sphere.triangles;
  for (const Vec3& v : sphere.vertices_W_m) {
    result.object.error.push_back(v.z() > 0.0 ? 0.2 * (1.0 + std::sin(8.0 * v.x() / radius)) : std::nan(""));
    result.object.noticed_share.push_back(v.z() > 0.0 ? 0.5 * (1.0 + std::sin(8.0 * v.x() / radius)) : std::nan(""));
  }
  for (int i = 0; i < 5000; ++i) {
    metrics::MetricSample s;
    s.t_s = 0.002 * i;
    const double around = 0.6 * s.t_s;
    const Vec3 n(std::cos(3.0 * around) * std::cos(around), std::sin(3.0 * around) * std::cos(around),
                 std::abs(std::sin(around)));
    s.out_W_m = radius * n;
    s.contact_W_m = s.out_W_m + 1e-5 * Vec3(std::sin(40.0 * s.t_s), 0, 0);
    s.f_measured_W_N = (1.0 + 0.5 * std::sin(5.0 * s.t_s)) * n +
                       0.01 * Vec3(std::sin(900.0 * i), std::sin(700.0 * i), std::sin(800.0 * i));
    s.f_rendered_W_N = (1.0 + 0.5 * std::sin(5.0 * s.t_s)) * n;
    if (i > 2000 && i < 2100) s.contact_W_m.z() += 2e-3, s.f_rendered_W_N *= 0.3;
    s.cost_us = 0.4 + 0.1 * std::abs(std::sin(i));
    metrics.add(s);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      signals[axis].add(s.t_s, s.f_measured_W_N[static_cast<Eigen::Index>(axis)]);
      signals[axis + 3].add(s.t_s, s.f_rendered_W_N[static_cast<Eigen::Index>(axis)]);
    }
    if (i % 5 == 0) result.path_W_m.push_back(s.out_W_m);
  }
  result.title = name;
  result.renderer = name;
  result.model = "{\"renderer\": \"" + name + "\"}";
  result.settings = {{"Recording", name}, {"Stiffness", "500 N/m"}};
  result.messages = {name};
  result.metrics = metrics.results();
  for (const metrics::SeriesRecorder& signal : signals) result.signals.push_back(signal.series());
  result.force_threshold_N = 0.1;
  result.position_threshold_m = 0.5e-3;
  for (const metrics::Episode& episode : metrics.force_episodes())
    result.episodes.push_back({episode, "force", "N", {result.signals[2], result.signals[5]}});
  for (const metrics::Episode& episode : metrics.position_episodes())
    result.episodes.push_back({episode, "position", "m", {}});
  result.object.error_name = "force error";
  result.object.error_unit = "N";
  result.object.note = name;
  result.provenance = make_provenance({"touchstone", "evaluate", name});
  result.provenance.inputs = {{"recording", name, std::string(64, 'a'), 1234}};
  return result;
}

}  // namespace touchstone::report

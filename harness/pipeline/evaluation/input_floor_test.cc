#include "harness/pipeline/evaluation/input_floor.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "harness/pipeline/evaluation/sample_scan_for_test.h"
#include "harness/surface/embree_surface.h"

namespace touchstone::pipeline {
namespace {

using surface::TriangleMesh;

// Pressed all the time with 2 N while it moves over a plate.
FloorWorld plate_world(double noise_N) {
  FloorWorld world;
  world.law = "friction-cone";
  world.recording.source = "plate";
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.001 * i;
    world.recording.motion.t_s.push_back(t);
    world.recording.motion.p_W_m.emplace_back(0.05 + 0.01 * std::sin(2.0 * t), 0.05, 0.0);
    world.recording.f_W_N.emplace_back(0.0, 0.0, 2.0);
  }
  world.surface = make_embree_surface(plate());
  world.stiffness_N_per_m = 500.0;
  world.contact_threshold_N = 0.05;
  world.instrument.force_noise_N = noise_N;
  return world;
}

// Without friction the input carries the measured normal force, noise and all, and the renderer gives it back; nothing
// gives back the noise of the two tangential axes.
TEST(Floor, OnAPlateIsTheNoiseOfTheTangentialAxes) {
  for (const double noise_N : {0.001, 0.01, 0.1}) {
    const pipeline::Floor floor = floor_of(built_in(), plate_world(noise_N), {}, 1);
    EXPECT_NEAR(floor.rms_N, std::sqrt(2.0) * noise_N, 0.02 * noise_N);
    EXPECT_LT(floor.low95_N, std::sqrt(2.0) * noise_N);
    EXPECT_GT(floor.high95_N, std::sqrt(2.0) * noise_N);
  }
  EXPECT_LT(floor_of(built_in(), plate_world(0.0), {}, 1).rms_N, 1e-12) << "perfect instruments leave no floor";
}

// With measured positions the input knows nothing of the force: all three axes are left.
TEST(Floor, OfMeasuredPositionsIsTheNoiseOfAllAxes) {
  FloorWorld world = plate_world(0.01);
  world.in_trajectory = recording::InTrajectoryMode::measured;
  for (Vec3& p : world.recording.motion.p_W_m) p.z() = -2.0 / 500.0;
  EXPECT_NEAR(floor_of(built_in(), world, {}, 1).rms_N, std::sqrt(3.0) * 0.01, 2e-4);
}

TEST(Floor, IsTheSameFromTheSameSeed) {
  const FloorWorld world = plate_world(0.01);
  EXPECT_EQ(floor_of(built_in(), world, {}, 5).rms_N, floor_of(built_in(), world, {}, 5).rms_N);
  EXPECT_NE(floor_of(built_in(), world, {}, 5).rms_N, floor_of(built_in(), world, {}, 6).rms_N);
}

// The block from x = `from_m` to `to_m` below the plate, outward.
void add_block(TriangleMesh& mesh, double from_m, double to_m) {
  const auto first = static_cast<std::int32_t>(mesh.vertices_W_m.size());
  for (const double z : {0.0, -0.02}) {
    for (const auto& [x, y] : {std::pair(from_m, 0.0), {to_m, 0.0}, {to_m, 0.1}, {from_m, 0.1}})
      mesh.vertices_W_m.emplace_back(x, y, z);
  }
  for (const auto& [a, b, c] : {std::array{0, 1, 2},
                                {0, 2, 3},
                                {4, 6, 5},
                                {4, 7, 6},
                                {0, 4, 5},
                                {0, 5, 1},
                                {1, 5, 6},
                                {1, 6, 2},
                                {2, 6, 7},
                                {2, 7, 3},
                                {3, 7, 4},
                                {3, 4, 0}})
    mesh.triangles.push_back({first + a, first + b, first + c});
}

// Where two blocks meet a wall of each stands inside of the body, and the tracker's noise would put a point of the
// surface below it, next to the wall. The centre of the ball that made the recording is a radius above.
TEST(Floor, OfABallThatMadeTheRecordingSeesNoWallInsideOfTheBody) {
  FloorWorld world = plate_world(0.01);
  world.instrument.position_noise_m = 1e-4;
  world.instrument.position_rate_Hz = 250.0;
  world.probe_radius_m = 1e-3;
  for (std::size_t i = 0; i < world.recording.size(); ++i) {
    // Comes down from free air, beside the joint.
    world.recording.motion.p_W_m[i].z() = world.probe_radius_m + (i < 100 ? 0.005 : 0.0);
    if (i < 100) world.recording.f_W_N[i].setZero();
  }
  TriangleMesh one;
  add_block(one, 0.0, 0.1);
  TriangleMesh two;
  add_block(two, 0.0, 0.055);
  add_block(two, 0.055, 0.1);
  world.surface = make_embree_surface(one);
  const double of_one_N = floor_of(built_in(), world, {}, 1).rms_N;
  world.surface = make_embree_surface(two);
  EXPECT_NEAR(floor_of(built_in(), world, {}, 1).rms_N, of_one_N, 0.02 * of_one_N);
  EXPECT_NEAR(of_one_N, std::sqrt(2.0) * 0.01, 0.02 * 0.01);
}

}  // namespace
}  // namespace touchstone::pipeline

#include "harness/discrepancy/noise_model.h"

#include <algorithm>
#include <cmath>

#include "harness/discrepancy/smooth_motion.h"

namespace touchstone::discrepancy {
using rendering::Model;
using rendering::Prediction;

namespace {

// The noise of neighbouring blocks is pooled, since a handful of replicas measures one block's variance badly.
constexpr std::size_t pooled_on_each_side = 3;

Vec3 mean_normal(const ResidualBlock& block, const std::vector<Vec3>& n_W) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = block.begin; i < block.end; ++i) sum += n_W[i];
  return sum.norm() > 0.0 ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

// Every sample's normal, in free air that of the contact before or, at the start, of the first one.
std::vector<Vec3> carried_normals(std::vector<Vec3> n_W) {
  Vec3 last = Vec3::Zero();
  for (const Vec3& n : n_W) {
    if (!n.isZero()) {
      last = n;
      break;
    }
  }
  for (Vec3& n : n_W) {
    if (n.isZero()) {
      n = last;
    } else {
      last = n;
    }
  }
  return n_W;
}

// Normals that are off by an angle: that share of the normal force lies in the tangent plane.
double leaning_N(const InstrumentDescription& instrument, double normal_N) {
  return instrument.normal_error_rad * std::abs(normal_N);
}

}  // namespace

NoiseModel::NoiseModel(const MotionColumns& motion, const std::vector<Vec3>& n_W,
                       const InstrumentDescription& instrument, const rendering::MakePredictor& make,
                       std::uint64_t noise_seed, std::uint64_t mesh_seed)
    : instrument_(instrument) {
  const Random root(noise_seed);
  const Random mesh_root(mesh_seed);
  const std::vector<Vec3> normals = carried_normals(n_W);
  const MotionSmoother smoother(motion, instrument);
  smoothed_motion_ = smoother.smoothed(motion);
  likely_ = make(smoothed_motion_);
  for (std::size_t r = 0; r < replica_count + null_simulations; ++r) {
    Random random = root.stream(r);
    const bool null = r >= replica_count;
    MotionColumns moved = null ? smoothed_motion_ : with_position_noise(motion, instrument, random);
    World world;
    if (null) {
      const std::vector<Vec3> off_m = smoother.left_of_noise(random);
      for (std::size_t i = 0; i < off_m.size(); ++i) moved.p_W_m[i] += off_m[i];
      Random mesh_random = mesh_root.stream(r);
      moved = with_geometry_error(moved, normals, instrument, mesh_random);
      world.tilt_W = normal_tilts(motion, normals, instrument, mesh_random);
    }
    world.predictor = make(moved);
    world.force_noise = force_noise(motion, instrument, random);
    (null ? nulls_ : replicas_).push_back(std::move(world));
  }
  MotionColumns displaced = motion;
  for (std::size_t i = 0; i < displaced.size(); ++i) {
    displaced.p_W_m[i] -= geometry_deviation_m(instrument) * normals[i];
  }
  displaced_ = make(displaced);
}

std::vector<BlockNoise> NoiseModel::of(const Model& model, const Prediction& nominal,
                                       const std::vector<ResidualBlock>& blocks) {
  const std::size_t n = blocks.size();
  std::vector<BlockNoise> noise(n);
  std::vector<double> normal_squares(n, 0.0);
  std::vector<double> tangential_squares(n, 0.0);
  std::vector<std::vector<Vec3>> left;
  for (std::size_t r = 0; r < replica_count; ++r) {
    left.push_back(block_means(blocks, simulated_noise_residual(model, nominal, r)));
    for (std::size_t b = 0; b < n; ++b) noise[b].bias_W_N += left.back()[b] / static_cast<double>(replica_count);
  }
  const double freedom = static_cast<double>(replica_count) - 1.0;
  for (std::size_t b = 0; b < n; ++b) {
    noise[b].n_W = mean_normal(blocks[b], nominal.n_W);
    for (const auto& means : left) {
      const Vec3 spread = means[b] - noise[b].bias_W_N;
      const double normal = noise[b].n_W.dot(spread);
      normal_squares[b] += normal * normal;
      tangential_squares[b] += spread.squaredNorm() - normal * normal;
    }
    // A mean over few replicas is itself noisy: it is kept as far as it exceeds that (James and Stein 1961).
    const double of_mean = (normal_squares[b] + tangential_squares[b]) / freedom / static_cast<double>(replica_count);
    const double square = noise[b].bias_W_N.squaredNorm();
    noise[b].bias_W_N *= square > 0.0 ? std::max(0.0, 1.0 - of_mean / square) : 0.0;
  }
  const Prediction displaced = displaced_->predict(model);
  std::vector<Vec3> by_geometry(displaced.f_W_N.size());
  for (std::size_t i = 0; i < by_geometry.size(); ++i) by_geometry[i] = displaced.f_W_N[i] - nominal.f_W_N[i];
  const std::vector<Vec3> geometry = block_means(blocks, by_geometry);
  for (std::size_t b = 0; b < n; ++b) {
    const std::size_t low = b > pooled_on_each_side ? b - pooled_on_each_side : 0;
    const std::size_t high = std::min(n, b + pooled_on_each_side + 1);
    double normal = 0.0;
    double tangential = 0.0;
    double normal_axes = 0.0;
    double tangential_axes = 0.0;
    for (std::size_t j = low; j < high; ++j) {
      // Free air and contact are not pooled: contact is noisier by far.
      if (noise[j].n_W.isZero() != noise[b].n_W.isZero()) continue;
      normal += normal_squares[j];
      normal_axes += noise[j].n_W.isZero() ? 0.0 : freedom;
      tangential += tangential_squares[j];
      tangential_axes += (noise[j].n_W.isZero() ? 3.0 : 2.0) * freedom;
    }
    double normal_N = 0.0;
    for (std::size_t i = blocks[b].begin; i < blocks[b].end; ++i) normal_N += nominal.normal_N[i];
    const double leaning = leaning_N(instrument_, normal_N / static_cast<double>(blocks[b].end - blocks[b].begin));
    const double geometry_along = noise[b].n_W.dot(geometry[b]);
    const double geometry_across = geometry[b].squaredNorm() - geometry_along * geometry_along;
    noise[b].tangential_N = std::sqrt(tangential / tangential_axes + 0.5 * leaning * leaning +
                                      geometry_across / (noise[b].n_W.isZero() ? 3.0 : 2.0));
    noise[b].along_normal_N =
        normal_axes > 0.0 ? std::sqrt(normal / normal_axes + geometry_along * geometry_along) : noise[b].tangential_N;
  }
  return noise;
}

std::vector<Vec3> NoiseModel::simulated_noise_residual(const Model& model, const Prediction& nominal,
                                                       std::size_t index) {
  World& world = replicas_.at(index);
  std::vector<Vec3> left = world.predictor->predict(model).f_W_N;
  for (std::size_t i = 0; i < left.size(); ++i) left[i] += world.force_noise[i] - nominal.f_W_N[i];
  return left;
}

std::vector<double> NoiseModel::expected_squares(const Model& model, const Prediction& nominal) {
  const std::size_t n = nominal.f_W_N.size();
  std::vector<double> squares(n, 0.0);
  for (std::size_t r = 0; r < replica_count; ++r) {
    const std::vector<Vec3> left = simulated_noise_residual(model, nominal, r);
    for (std::size_t i = 0; i < n; ++i) squares[i] += left[i].squaredNorm() / static_cast<double>(replica_count);
  }
  const Prediction displaced = displaced_->predict(model);
  for (std::size_t i = 0; i < n; ++i) {
    const double leaning = leaning_N(instrument_, nominal.normal_N[i]);
    squares[i] += (displaced.f_W_N[i] - nominal.f_W_N[i]).squaredNorm() + leaning * leaning;
  }
  return squares;
}

std::vector<Vec3> NoiseModel::null_forces(const Model& model, const Prediction& nominal, std::size_t index) {
  World& world = nulls_.at(index);
  std::vector<Vec3> forces = world.predictor->predict(model).f_W_N;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    forces[i] += world.force_noise[i] + std::abs(nominal.normal_N[i]) * world.tilt_W[i];
  }
  return forces;
}

}  // namespace touchstone::discrepancy

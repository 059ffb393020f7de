#include "harness/discrepancy/structure_detector.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "harness/discrepancy/whitened_regression.h"

namespace touchstone {
namespace {

constexpr double ridge = 3e-3;
// A share of chi-squared below this is not worth a finding, whatever its significance.
constexpr double least_share = 0.3;
constexpr double null_deviations = 5.0;

// A running mean over the past, first order, at any clock.
class Memory {
 public:
  explicit Memory(double time_s) : time_s_(time_s) {}
  Vec3 next(const Vec3& value, double dt_s) {
    const double keep = std::exp(-dt_s / time_s_);
    state_ = keep * state_ + (1.0 - keep) * value;
    return state_;
  }

 private:
  double time_s_;
  Vec3 state_ = Vec3::Zero();
};

// Forces that something outside the library might make.
std::vector<std::vector<Vec3>> features(const MotionColumns& motion, const Prediction& prediction) {
  const std::size_t n = motion.size();
  std::vector<std::vector<Vec3>> all;
  std::vector<Vec3> velocity(n, Vec3::Zero());
  for (std::size_t i = 1; i < n; ++i) {
    velocity[i] = (motion.p_W_m[i] - motion.p_W_m[i - 1]) / (motion.t_s[i] - motion.t_s[i - 1]);
  }
  const auto add = [&](const auto& force) {
    std::vector<Vec3> series(n);
    for (std::size_t i = 0; i < n; ++i) series[i] = force(i);
    all.push_back(std::move(series));
  };
  const auto along_normal = [&](const auto& scalar) {
    add([&](std::size_t i) { return Vec3(scalar(i) * prediction.n_W[i]); });
  };
  const auto tangential = [&](const Vec3& v, std::size_t i) {
    const Vec3& normal = prediction.n_W[i];
    return normal.isZero() ? Vec3(Vec3::Zero()) : Vec3(v - normal.dot(v) * normal);
  };
  const auto& d = prediction.depth_m;
  const auto& N = prediction.normal_N;
  along_normal([](std::size_t) { return 1.0; });
  along_normal([&](std::size_t i) { return d[i]; });
  along_normal([&](std::size_t i) { return d[i] * d[i]; });
  along_normal([&](std::size_t i) { return d[i] * d[i] * d[i]; });
  along_normal([&](std::size_t i) { return prediction.n_W[i].dot(velocity[i]); });
  along_normal([&](std::size_t i) { return d[i] * prediction.n_W[i].dot(velocity[i]); });
  along_normal([&](std::size_t i) { return d[i] * (motion.t_s[i] - motion.t_s[0]); });
  along_normal([&](std::size_t i) { return velocity[i].norm(); });
  // The past of the depth, and the deepest so far.
  for (const double time_s : {0.03, 0.1, 0.3, 1.0, 3.0}) {
    Memory memory(time_s);
    std::vector<double> past(n);
    for (std::size_t i = 0; i < n; ++i) {
      past[i] = memory.next(Vec3(d[i], 0.0, 0.0), i > 0 ? motion.t_s[i] - motion.t_s[i - 1] : 0.0).x();
    }
    along_normal([&](std::size_t i) { return past[i]; });
  }
  // Places, with the load: a body that is not the same everywhere.
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : motion.p_W_m) middle += p / static_cast<double>(n);
  for (int axis = 0; axis < 3; ++axis) {
    along_normal([&](std::size_t i) { return N[i] * (motion.p_W_m[i] - middle)[axis]; });
    for (int other = axis; other < 3; ++other) {
      along_normal(
          [&](std::size_t i) { return N[i] * (motion.p_W_m[i] - middle)[axis] * (motion.p_W_m[i] - middle)[other]; });
    }
  }
  // Along the motion: now, with the load, and remembered.
  add([&](std::size_t i) { return velocity[i]; });
  add([&](std::size_t i) { return tangential(velocity[i], i); });
  add([&](std::size_t i) { return Vec3(N[i] * tangential(velocity[i], i)); });
  add([&](std::size_t i) {
    const Vec3 v = tangential(velocity[i], i);
    return v.norm() > 0.0 ? Vec3(N[i] * v.normalized()) : Vec3(Vec3::Zero());
  });
  for (const double time_s : {0.02, 0.06, 0.2, 0.6}) {
    Memory memory(time_s);
    std::vector<Vec3> past(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 slid = tangential(velocity[i], i);
      past[i] = memory.next(slid, i > 0 ? motion.t_s[i] - motion.t_s[i - 1] : 0.0);
    }
    add([&](std::size_t i) { return tangential(past[i], i); });
    add([&](std::size_t i) {
      const Vec3 v = tangential(past[i], i);
      return v.norm() > 0.0 ? Vec3(N[i] * v.normalized()) : Vec3(Vec3::Zero());
    });
  }
  // Outside the contact: a place that attracts, accelerations, constants in both frames.
  add([&](std::size_t i) { return Vec3(motion.p_W_m[i] - middle); });
  add([&](std::size_t i) {
    return i > 0 && i + 1 < n ? Vec3((velocity[i + 1] - velocity[i]) / (motion.t_s[i + 1] - motion.t_s[i]))
                              : Vec3(Vec3::Zero());
  });
  for (int axis = 0; axis < 3; ++axis) {
    add([&](std::size_t) { return Vec3(Vec3::Unit(axis)); });
    if (!motion.q_WS.empty()) add([&](std::size_t i) { return Vec3(motion.q_WS[i] * Vec3::Unit(axis)); });
  }
  return all;
}

std::vector<Vec3> difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::vector<Vec3> out(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

}  // namespace

Structure detect_structure(const DetectorSide& train, const DetectorSide& holdout, const Model& model) {
  struct Prepared {
    Prediction nominal;
    RegressionData data;
  };
  const auto prepare = [&](const DetectorSide& side, const MotionColumns& motion, Predictor& predictor) {
    Prepared out{predictor.predict(model), {}};
    out.data = whiten_for_regression(*side.blocks, difference(side.recording->f_W_N, out.nominal.f_W_N),
                                     features(motion, out.nominal));
    return out;
  };
  const auto gain_of = [](const Prepared& learn, const Prepared& judge) {
    return judge.data.residual.squaredNorm() - left_by(judge.data, ridge_coefficients(learn.data, ridge));
  };
  // What foretells the residual at noisy positions alone foretells the noise.
  const auto along_likely = [&](const DetectorSide& side) {
    return prepare(side, side.noise->likely_motion(), side.noise->likely_predictor());
  };
  const double likely_gain = gain_of(along_likely(train), along_likely(holdout));
  Prepared learn = prepare(train, train.recording->motion, *train.blocks->predictor);
  Prepared judge = prepare(holdout, holdout.recording->motion, *holdout.blocks->predictor);
  const auto share_of = [&](double gain) {
    const double before = judge.data.residual.squaredNorm();
    return before > 0.0 ? gain / before : 0.0;
  };
  Structure structure;
  structure.gain = std::min(gain_of(learn, judge), likely_gain);
  structure.share = share_of(structure.gain);

  std::array<double, NoiseModel::null_worlds> shares{};
  const std::vector<std::vector<Vec3>> none;
  for (std::size_t world = 0; world < shares.size(); ++world) {
    const auto null_residual = [&](const DetectorSide& side, const Prepared& prepared) {
      const auto forces = side.noise->null_forces(model, prepared.nominal, world);
      return whiten_for_regression(*side.blocks, difference(forces, prepared.nominal.f_W_N), none).residual;
    };
    learn.data.residual = null_residual(train, learn);
    judge.data.residual = null_residual(holdout, judge);
    shares[world] = std::max(0.0, share_of(gain_of(learn, judge)));
  }
  double mean = 0.0;
  for (const double share : shares) mean += share / static_cast<double>(shares.size());
  double squares = 0.0;
  for (const double share : shares) squares += (share - mean) * (share - mean);
  structure.bar =
      std::max(least_share, mean + null_deviations * std::sqrt(squares / static_cast<double>(shares.size() - 1)));
  return structure;
}

}  // namespace touchstone

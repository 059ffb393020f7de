#include "harness/discrepancy/law_waves.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "harness/base/in_parallel.h"

namespace touchstone::discrepancy {
namespace {

constexpr std::size_t fewest_blocks = 30;
constexpr std::size_t most_blocks = 1500;
constexpr std::size_t most_peaks = 3;
constexpr double most_waves = 16.0;  // over the extent: finer ones a tracker hardly resolves
constexpr double least_waves = 1.0;

struct Peak {
  Vec3 at = Vec3::Zero();
  double power = 0.0;
};

// Power of the residual at a phase per block, of all axes.
double power_at(const std::vector<Vec3>& f_W_N, const std::vector<double>& turns) {
  Eigen::Matrix<std::complex<double>, 3, 1> sum = Eigen::Matrix<std::complex<double>, 3, 1>::Zero();
  for (std::size_t i = 0; i < f_W_N.size(); ++i) {
    const double phase = 2.0 * std::numbers::pi * turns[i];
    sum += std::complex<double>(std::cos(phase), std::sin(phase)) * f_W_N[i].cast<std::complex<double>>();
  }
  return sum.squaredNorm() / static_cast<double>(f_W_N.size());
}

// The strongest ones that are further than `apart` from each other (in steps of the grid).
std::vector<Peak> strongest(std::vector<Peak> all, const Vec3& step, double apart) {
  std::sort(all.begin(), all.end(), [](const Peak& a, const Peak& b) { return a.power > b.power; });
  std::vector<Peak> kept;
  for (const Peak& one : all) {
    if (kept.size() >= most_peaks) break;
    const auto near = [&](const Peak& other) {
      return (one.at - other.at).cwiseQuotient(step).norm() < apart ||
             (one.at + other.at).cwiseQuotient(step).norm() < apart;
    };
    if (std::none_of(kept.begin(), kept.end(), near)) kept.push_back(one);
  }
  return kept;
}

LeftOver thinned_and_centred(const LeftOver& left) {
  const std::size_t stride = left.t_s.size() / most_blocks + 1;
  LeftOver some;
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < left.t_s.size(); i += stride) {
    some.t_s.push_back(left.t_s[i]);
    some.p_W_m.push_back(left.p_W_m[i]);
    some.f_W_N.push_back(left.f_W_N[i]);
    mean += left.f_W_N[i];
  }
  mean /= static_cast<double>(some.t_s.size());
  for (Vec3& f : some.f_W_N) f -= mean;
  return some;
}

std::vector<double> lines(const LeftOver& left) {
  const double duration_s = left.t_s.back() - left.t_s.front();
  const double step_Hz = 0.3 / duration_s;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < left.t_s.size(); ++i) gaps.push_back(left.t_s[i] - left.t_s[i - 1]);
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  const double highest_Hz = 0.5 / gaps[gaps.size() / 2];
  const double lowest_Hz = 2.0 / duration_s;
  if (highest_Hz < lowest_Hz) return {};
  const auto count = static_cast<std::size_t>((highest_Hz - lowest_Hz) / step_Hz) + 1;
  std::vector<Peak> all(count);
  in_parallel(
      count,
      [&](std::size_t i) {
        const double frequency_Hz = lowest_Hz + static_cast<double>(i) * step_Hz;
        std::vector<double> turns;
        for (const double t_s : left.t_s) turns.push_back(frequency_Hz * t_s);
        all[i] = {Vec3(frequency_Hz, 0.0, 0.0), power_at(left.f_W_N, turns)};
      },
      64);
  std::vector<double> found;
  for (const Peak& peak : strongest(std::move(all), Vec3(step_Hz, 1.0, 1.0), 8.0)) found.push_back(peak.at.x());
  return found;
}

std::vector<Vec3> waves(const LeftOver& left) {
  Box3 box;
  for (const Vec3& p : left.p_W_m) box.extend(p);
  const Vec3 size = box.diagonal();
  const double extent = size.maxCoeff();
  if (!(extent > 0.0)) return {};
  const double most = most_waves / extent;
  // Half a turn over the extent from one wave to the next; none across where the tip has not been.
  constexpr double turns_between = 0.4;
  Vec3 step;
  std::array<int, 3> half{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    step[axis] = turns_between / std::max(size[axis], turns_between / most);
    half.at(k) = static_cast<int>(most / step[axis]);
  }
  const auto blocks = static_cast<Eigen::Index>(left.p_W_m.size());
  const Eigen::Map<const Eigen::Matrix3Xd> places(left.p_W_m.front().data(), 3, blocks);
  const Eigen::MatrixX3d forces_N =
      Eigen::Map<const Eigen::Matrix3Xd>(left.f_W_N.front().data(), 3, blocks).transpose();
  // A row has all waves of one number along x and along y: from each to the next every block's phase turns by the same
  // angle, so that none of them needs a sine.
  const int columns = 2 * half[1] + 1;
  std::vector<std::vector<Peak>> rows(static_cast<std::size_t>((half[0] + 1) * columns));
  const Eigen::ArrayXd turn = (2.0 * std::numbers::pi * step.z()) * places.row(2).transpose().array();
  const Eigen::ArrayXd turn_cosine = turn.cos();
  const Eigen::ArrayXd turn_sine = turn.sin();
  in_parallel(
      rows.size(),
      [&](std::size_t i) {
        const int x = static_cast<int>(i) / columns;
        const int y = static_cast<int>(i) % columns - half[1];
        const Vec3 first = Vec3(x, y, -half[2]).cwiseProduct(step);
        if (Vec3(first.x(), first.y(), 0.0).norm() > most) return;
        const Eigen::ArrayXd phase = 2.0 * std::numbers::pi * (first.transpose() * places).transpose().array();
        Eigen::ArrayXd cosine = phase.cos();
        Eigen::ArrayXd sine = phase.sin();
        Eigen::ArrayXd next(blocks);
        for (int z = -half[2]; z <= half[2]; ++z) {
          const Vec3 at = Vec3(x, y, z).cwiseProduct(step);
          if (at.norm() <= most && at.norm() * extent >= least_waves) {
            const double square = (forces_N.transpose() * cosine.matrix()).squaredNorm() +
                                  (forces_N.transpose() * sine.matrix()).squaredNorm();
            rows[i].push_back({at, square / static_cast<double>(blocks)});
          }
          next = cosine * turn_cosine - sine * turn_sine;
          sine = sine * turn_cosine + cosine * turn_sine;
          cosine.swap(next);
        }
      },
      16);
  std::vector<Peak> all;
  for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
  std::vector<Vec3> found;
  for (const Peak& peak : strongest(std::move(all), step, 3.0)) found.push_back(peak.at);
  return found;
}

}  // namespace

WavePeaks wave_peaks(const LeftOver& left) {
  if (left.t_s.size() < fewest_blocks) return {};
  const LeftOver some = thinned_and_centred(left);
  return {lines(some), waves(some)};
}

}  // namespace touchstone::discrepancy

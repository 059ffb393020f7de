#include "harness/renderer_faults/arx.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace touchstone::renderer_faults {
namespace {

struct Orders {
  Eigen::Index a = 0;
  Eigen::Index b = 0;
  int dead = 0;
};

// Where damping pulls, the force is cut off at 0, and the law is another one: rows are those of positive f alone.
std::optional<Arx> fit(const std::vector<double>& f, const std::vector<double>& s, std::size_t from,
                       const Orders& orders) {
  std::vector<std::size_t> rows;
  for (std::size_t i = from; i < f.size(); ++i) {
    const auto first = f.begin() + static_cast<std::ptrdiff_t>(i) - orders.a;
    if (std::all_of(first, first + orders.a + 1, [](double one) { return one > 0.0; })) rows.push_back(i);
  }
  const Eigen::Index unknowns = orders.a + orders.b + 1;
  constexpr Eigen::Index least_rows = 20;  // for each unknown
  const auto count = static_cast<Eigen::Index>(rows.size());
  if (count < least_rows * unknowns) return std::nullopt;
  Eigen::MatrixXd m(count, unknowns);
  Eigen::VectorXd y(count);
  for (Eigen::Index row = 0; row < count; ++row) {
    const std::size_t i = rows[static_cast<std::size_t>(row)];
    for (Eigen::Index j = 0; j < orders.a; ++j) m(row, j) = f[i - 1 - static_cast<std::size_t>(j)];
    for (Eigen::Index j = 0; j < orders.b; ++j) m(row, orders.a + j) = s[i - static_cast<std::size_t>(orders.dead + j)];
    m(row, unknowns - 1) = 1.0;
    y[row] = f[i];
  }
  const Eigen::VectorXd x = m.colPivHouseholderQr().solve(y);
  return Arx{orders.dead, x.head(orders.a), x.segment(orders.a, orders.b),
             (m * x - y).squaredNorm() / (y.array() - y.mean()).matrix().squaredNorm()};
}

}  // namespace

int Arx::settling_samples() const {
  constexpr int longest = 2000;
  constexpr double settled = 1e-5;
  const double goal = b.sum() / (1.0 - a.sum());
  std::vector<double> answer;
  int last_off = 0;
  for (int i = 0; i < longest; ++i) {
    double now = b.head(std::min<Eigen::Index>(b.size(), i + 1)).sum();
    for (Eigen::Index j = 0; j < std::min<Eigen::Index>(a.size(), i); ++j)
      now += a[j] * answer[static_cast<std::size_t>(i - 1 - j)];
    answer.push_back(now);
    if (!(std::abs(now - goal) <= settled * std::abs(goal))) last_off = i + 1;
  }
  return dead + last_off;
}

double Arx::delay_samples() const {
  double samples = dead;
  for (Eigen::Index j = 1; j < b.size(); ++j) samples += static_cast<double>(j) * b[j] / b.sum();
  for (Eigen::Index j = 0; j < a.size(); ++j) samples += static_cast<double>(j + 1) * a[j] / (1.0 - a.sum());
  return samples;
}

std::optional<Arx> simplest_arx(const std::vector<double>& f, const std::vector<double>& s, std::size_t from) {
  constexpr int longest_dead = 8;
  constexpr Eigen::Index mean_over = 24;
  std::vector<Orders> simplest_first;
  for (int dead = 0; dead <= longest_dead; ++dead) simplest_first.push_back({1, 2, dead});
  simplest_first.push_back({2, 3, 0});
  simplest_first.push_back({0, mean_over, 0});
  for (const Orders& orders : simplest_first) {
    constexpr double explained = 1e-3;
    // What begins with less than this share of its largest b begins a sample later.
    constexpr double nothing = 0.05;
    auto arx = fit(f, s, from, orders);
    if (arx && arx->left < explained && std::abs(arx->b[0]) > nothing * arx->b.cwiseAbs().maxCoeff()) return arx;
  }
  return std::nullopt;
}

}  // namespace touchstone::renderer_faults

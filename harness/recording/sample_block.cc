#include "harness/recording/sample_block.h"

#include <algorithm>

namespace touchstone::recording {
namespace {

// Applies `call` to every column of `a` with the same column of `b`.
template <class A, class B, class Call>
void for_each_column(A& a, B& b, Call call) {
  call(a.motion.t_s, b.motion.t_s);
  call(a.motion.p_W_m, b.motion.p_W_m);
  call(a.motion.q_WS, b.motion.q_WS);
  call(a.f_W_N, b.f_W_N);
  call(a.torque_W_Nm, b.torque_W_Nm);
  call(a.contact_W_m, b.contact_W_m);
  call(a.contact, b.contact);
  call(a.cost_us, b.cost_us);
}

}  // namespace

void SampleBlock::clear() {
  for_each_column(*this, *this, [](auto& column, auto&) { column.clear(); });
}

void SampleBlock::append(const SampleBlock& other, std::size_t begin, std::size_t end) {
  for_each_column(*this, other, [&](auto& to, const auto& from) {
    const auto at = [&](std::size_t i) { return from.begin() + static_cast<std::ptrdiff_t>(i); };
    if (!from.empty()) to.insert(to.end(), at(begin), at(end));
  });
}

void SampleBlock::append_mean(const SampleBlock& other, std::size_t begin, std::size_t end) {
  const auto n = static_cast<double>(end - begin);
  const auto mean = [&](auto& to, const auto& from) {
    if (from.empty()) return;
    auto sum = from[begin];
    for (std::size_t i = begin + 1; i < end; ++i) sum += from[i];
    to.push_back(sum / n);
  };
  motion.t_s.push_back(other.motion.t_s[begin]);
  mean(motion.p_W_m, other.motion.p_W_m);
  mean(f_W_N, other.f_W_N);
  mean(torque_W_Nm, other.torque_W_Nm);
  mean(contact_W_m, other.contact_W_m);
  mean(cost_us, other.cost_us);
  if (!other.motion.q_WS.empty()) {
    const Quat& first = other.motion.q_WS[begin];
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    // q and -q are the same orientation.
    for (std::size_t i = begin; i < end; ++i) {
      const Quat& q = other.motion.q_WS[i];
      sum += first.dot(q) < 0.0 ? Eigen::Vector4d(-q.coeffs()) : q.coeffs();
    }
    motion.q_WS.emplace_back(Quat(sum).normalized());
  }
  if (!other.contact.empty()) {
    const auto from = other.contact.begin() + static_cast<std::ptrdiff_t>(begin);
    contact.push_back(*std::max_element(from, from + static_cast<std::ptrdiff_t>(end - begin)));
  }
}

}  // namespace touchstone::recording

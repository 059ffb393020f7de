// A double that counts what is done with it, so that the floating-point operations of an algorithm are known exactly
// and repeatably: the same code, as a template over its scalar, runs with double and with Counted and gives the same
// bits. The measure is that of Ruffaldi et al. 2006, section 3.3 (operations per step: mean, median, maximum, total).
//
// Counted, one each: + and - of two numbers, *, /, sqrt, and the comparisons (<, <=, >, >=, ==, !=, min, max).
// Not counted: a change of sign, |x|, floor, conversions from and to integers and double, copies, tests for NaN, and
// everything that is not floating point: indices, addresses, branches.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>

namespace touchstone {

struct OperationCounts {
  std::uint64_t add = 0;  // and subtract
  std::uint64_t multiply = 0;
  std::uint64_t divide = 0;
  std::uint64_t square_root = 0;
  std::uint64_t compare = 0;

  [[nodiscard]] std::uint64_t total() const noexcept { return add + multiply + divide + square_root + compare; }
  OperationCounts& operator+=(const OperationCounts& o) noexcept {
    add += o.add;
    multiply += o.multiply;
    divide += o.divide;
    square_root += o.square_root;
    compare += o.compare;
    return *this;
  }
  friend OperationCounts operator-(OperationCounts a, const OperationCounts& b) noexcept {
    a.add -= b.add;
    a.multiply -= b.multiply;
    a.divide -= b.divide;
    a.square_root -= b.square_root;
    a.compare -= b.compare;
    return a;
  }
  friend bool operator==(const OperationCounts&, const OperationCounts&) = default;
};

// Of this thread, since it started.
inline OperationCounts& operations_on_this_thread() noexcept {
  thread_local OperationCounts counts;
  return counts;
}

class Counted {
 public:
  Counted() = default;
  constexpr Counted(double value) noexcept : value_(value) {}  // implicit: constants, and Eigen's own
  explicit operator double() const noexcept { return value_; }
  [[nodiscard]] double value() const noexcept { return value_; }

  friend Counted operator+(Counted a, Counted b) noexcept {
    ++operations_on_this_thread().add;
    return a.value_ + b.value_;
  }
  friend Counted operator-(Counted a, Counted b) noexcept {
    ++operations_on_this_thread().add;
    return a.value_ - b.value_;
  }
  friend Counted operator*(Counted a, Counted b) noexcept {
    ++operations_on_this_thread().multiply;
    return a.value_ * b.value_;
  }
  friend Counted operator/(Counted a, Counted b) noexcept {
    ++operations_on_this_thread().divide;
    return a.value_ / b.value_;
  }
  friend Counted operator-(Counted a) noexcept { return -a.value_; }
  Counted& operator+=(Counted b) noexcept { return *this = *this + b; }
  Counted& operator-=(Counted b) noexcept { return *this = *this - b; }
  Counted& operator*=(Counted b) noexcept { return *this = *this * b; }
  Counted& operator/=(Counted b) noexcept { return *this = *this / b; }

  friend bool operator<(Counted a, Counted b) noexcept { return compared(a.value_ < b.value_); }
  friend bool operator<=(Counted a, Counted b) noexcept { return compared(a.value_ <= b.value_); }
  friend bool operator>(Counted a, Counted b) noexcept { return compared(a.value_ > b.value_); }
  friend bool operator>=(Counted a, Counted b) noexcept { return compared(a.value_ >= b.value_); }
  friend bool operator==(Counted a, Counted b) noexcept { return compared(a.value_ == b.value_); }
  friend bool operator!=(Counted a, Counted b) noexcept { return compared(a.value_ != b.value_); }

  friend Counted sqrt(Counted a) noexcept {
    ++operations_on_this_thread().square_root;
    return std::sqrt(a.value_);
  }
  friend Counted abs(Counted a) noexcept { return std::abs(a.value_); }
  friend Counted floor(Counted a) noexcept { return std::floor(a.value_); }
  friend bool isfinite(Counted a) noexcept { return std::isfinite(a.value_); }
  friend bool isnan(Counted a) noexcept { return std::isnan(a.value_); }

 private:
  static bool compared(bool answer) noexcept {
    ++operations_on_this_thread().compare;
    return answer;
  }
  double value_ = 0.0;
};

}  // namespace touchstone

template <>
struct std::numeric_limits<touchstone::Counted> : std::numeric_limits<double> {};

template <>
struct Eigen::NumTraits<touchstone::Counted> : Eigen::NumTraits<double> {
  using Real = touchstone::Counted;
  using NonInteger = touchstone::Counted;
  using Nested = touchstone::Counted;
  using Literal = touchstone::Counted;
};

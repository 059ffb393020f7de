// Weber's law with an absolute threshold: the smallest change of a stimulus that is noticed (eq 12: dI/I = K), and the
// scale of just noticeable differences that follows from it (Fechner 1860).
#pragma once

namespace touchstone::perception {

// K is `fraction_below` from the absolute threshold up to `breakpoint`, `fraction_above` beyond. In the stimulus's
// unit.
struct WeberLaw {
  double absolute_threshold;  // less than this is not felt at all; 0: everything is
  double breakpoint;
  double fraction_below;
  double fraction_above;

  [[nodiscard]] double fraction(double intensity) const noexcept;
  // The change that is just noticed from `intensity`: K |I|, and the absolute threshold from nothing.
  [[nodiscard]] double just_noticeable_difference(double intensity) const noexcept;
  // How many just noticeable steps I -> I (1 + K) lie between nothing and `intensity`, odd in it: linear up to the
  // absolute threshold (its first step), logarithmic beyond. Needs an absolute threshold > 0.
  [[nodiscard]] double steps(double intensity) const noexcept;
};

// WeberLaw::steps() for many values: what depends on the law alone is worked out once.
class NoticeableSteps {
 public:
  explicit NoticeableSteps(const WeberLaw& law) noexcept;
  [[nodiscard]] double operator()(double intensity) const noexcept;

 private:
  double threshold_;
  double breakpoint_;
  double per_log_below_;  // steps per unit of log intensity
  double per_log_above_;
  double log_threshold_;
  double at_breakpoint_;  // steps there, less its log
};

// Force on the fingertip (section 3.2): absolute threshold 0.06 N (Jones 2000), K 20 % (of 15-27 %, Nadjarbashi 2015)
// up to 2.5 N, 7 % above (Pang, Tan and Durlach 1991). These are the defaults of every filter and metric here.
inline constexpr WeberLaw fingertip_force{0.06, 2.5, 0.20, 0.07};

}  // namespace touchstone::perception

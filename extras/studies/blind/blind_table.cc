#include "blind/blind_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "harness/stats/quantile.h"

namespace touchstone::blind {
using discrepancy::FindingsVerdict;

namespace {

struct Share {
  std::size_t right = 0;
  std::size_t all = 0;
};

double part(const Share& share) { return static_cast<double>(share.right) / static_cast<double>(share.all); }

std::string with_interval(const Share& share) {
  if (share.all == 0) return "-";
  const double n = static_cast<double>(share.all);
  const double p = static_cast<double>(share.right) / n;
  constexpr double z = 1.96;
  const double centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return fmt::format("{:3.0f} % ({} of {}; 95 %: {:.0f} to {:.0f} %)", 100.0 * p, share.right, share.all,
                     100.0 * std::max(0.0, centre - half), 100.0 * std::min(1.0, centre + half));
}

struct Bar {
  std::string set;
  std::string what;
  double least;  // share right
};

const std::vector<Bar> bars{
    {"one", "one effect, low and middle noise: first choice right", 0.95},
    {"one-noisy", "one effect, high noise: first choice right", 0.85},
    {"two", "two at once: both named", 0.90},
    {"three", "three at once: of the hidden effects, named", 0.80},
    {"none", "nothing missing: nothing named", 0.98},  // that nothing is missing need not have been said
    {"unknown", "unknown effects: flagged", 0.90},
    {"cannot-tell", "cannot tell: said so, with the right pair", 0.90},
    {"corrupted", "corrupted: nothing named, the data blamed", 1.0},
    {"full-band", "hum, buzz, resonance: flagged, frequency within 1 %", 0.95},
    {"outside", "unknown effects for a law: flagged", 0.95},
    {"sample", "samples: right", 1.0},
};

// How often a single effect is found, by the RMS force that it makes over the noise floor.
std::string detection_curve(const std::vector<BlindScore>& scores) {
  constexpr std::array edges{0.0, 0.25, 0.5, 1.0, 2.0, 5.0, std::numeric_limits<double>::infinity()};
  std::string text = "\nfound first, by the effect's RMS force over the noise floor (single effects):\n";
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    Share share;
    for (const BlindScore& score : scores) {
      const double square = score.before_N * score.before_N - score.floor_N * score.floor_N;
      const double strength = std::sqrt(std::max(0.0, square)) / score.floor_N;
      if (score.expected.size() != 1 || !(strength >= edges[i] && strength < edges[i + 1])) continue;
      ++share.all;
      share.right += !score.named.empty() && score.named.front() == score.expected.front() ? 1 : 0;
    }
    if (share.all == 0) continue;
    text += fmt::format("  {:4} to {:4}  {}\n", edges[i], edges[i + 1], with_interval(share));
  }
  return text;
}

// What a kind of effect's parameters may be off by, in the median.
struct ParameterBar {
  std::string what;
  double most;
  std::set<std::string> effects;  // empty: all others
};

const std::vector<ParameterBar> parameter_bars{
    {"weight, bias, drift, cross-talk, lag, saturation",
     0.02,
     {"tool-weight", "force-bias", "force-drift", "force-crosstalk", "time-lag", "force-saturation"}},
    {"friction, relaxation, exponent, tip radius, texture",
     0.10,
     {"coulomb-friction", "stribeck-friction", "anisotropic-friction", "sublinear-friction", "viscous-friction",
      "stress-relaxation", "power-law-stiffness", "tip-radius", "surface-texture"}},
    {"the other effects", 0.25, {}},
};

const ParameterBar& bar_of(const std::string& effect) {
  return *std::find_if(parameter_bars.begin(), parameter_bars.end(),
                       [&](const ParameterBar& bar) { return bar.effects.empty() || bar.effects.contains(effect); });
}

double relative_error(const BlindScore::Parameter& parameter) {
  return std::abs(parameter.value / parameter.truth - 1.0);
}

// Of the effects hidden alone, the one whose share of right first choices is the least.
Share least_of_an_effect(const std::vector<BlindScore>& scores) {
  std::map<std::string, Share> by_effect;
  for (const BlindScore& score : scores) {
    if (score.set != "one" || score.weak) continue;
    Share& share = by_effect[score.expected.front()];
    ++share.all;
    share.right += score.right ? 1 : 0;
  }
  const auto least = std::min_element(by_effect.begin(), by_effect.end(), [&](const auto& a, const auto& b) {
    return std::pair(part(a.second), b.second.all) < std::pair(part(b.second), a.second.all);
  });
  return least == by_effect.end() ? Share{} : least->second;
}

// Of the cases in which nothing is missing, those that were said to lack nothing. What was flagged as unknown instead
// counts among the false flags, which have a bar of their own.
std::string said_consistent(const std::vector<BlindScore>& scores) {
  Share share;
  for (const BlindScore& score : scores) {
    if (score.set != "none") continue;
    ++share.all;
    share.right += score.right ? 1 : 0;
  }
  return with_interval(share);
}

bool is_named(const BlindScore& score, const std::string& name) {
  return std::find(score.named.begin(), score.named.end(), name) != score.named.end();
}

// The table's text as it grows, and whether every bar was met so far.
class TableText {
 public:
  explicit TableText(const std::vector<BlindScore>& scores) : scores_(scores) {}

  // Right verdicts and names, set by set.
  void add_sets() {
    for (const Bar& bar : bars) {
      const Share share = share_of(bar);
      if (share.all == 0) continue;
      add_share(bar.what, bar.least, share);
      if (bar.set == "none")
        text_ += fmt::format("{:56}            {}\n", "nothing missing: said so", said_consistent(scores_));
    }
    if (const Share worst = least_of_an_effect(scores_); worst.all > 0)
      add_share("one effect: the effect that is found least often", 0.70, worst);
    Share told;
    for (const BlindScore& score : scores_) {
      if (!score.told_apart) continue;
      ++told.all;
      told.right += *score.told_apart ? 1 : 0;
    }
    if (told.all > 0) add_share("cannot tell: right once the motion asked for is recorded", 0.90, told);
  }

  // What was claimed and is not so.
  void add_false_claims() {
    Share false_flags;
    Share extra;
    for (const BlindScore& score : scores_) {
      if (score.weak) continue;
      const bool known = score.expected_verdict == FindingsVerdict::explained;
      if (known || score.expected_verdict == FindingsVerdict::consistent) {
        ++false_flags.all;
        false_flags.right += score.verdict == FindingsVerdict::unexplained ? 1 : 0;
      }
      if (!known) continue;
      ++extra.all;
      const bool more = std::any_of(score.named.begin(), score.named.end(), [&](const std::string& name) {
        return std::find(score.expected.begin(), score.expected.end(), name) == score.expected.end();
      });
      extra.right += more ? 1 : 0;
    }
    text_ += fmt::format("{:56} bar at most 5 %  {}  {}\n", "flagged as unknown though nothing unknown was there",
                         with_interval(false_flags), judged(part(false_flags), part(false_flags) <= 0.05));
    text_ += fmt::format("{:56} bar at most 10 %  {}  {}\n", "effects named that are not there", with_interval(extra),
                         judged(part(extra), part(extra) <= 0.10));
  }

  void add_gap_closed() {
    std::vector<double> closed;
    for (const BlindScore& score : scores_) {
      if (is_known(score)) closed.push_back(score.closed);
    }
    if (closed.empty()) return;
    const double median = stats::lower_quantile(closed, 0.5);
    const double tenth = stats::lower_quantile(closed, 0.1);
    const double least = stats::lower_quantile(closed, 0.0);
    text_ += fmt::format(
        "gap closed, held out: median {:.3f} (bar 0.97) {}, 10th percentile {:.3f} (bar 0.90) {}, least {:.3f} "
        "(bar -0.02) {}\n",
        median, judged(median, median >= 0.97), tenth, judged(tenth, tenth >= 0.90), least,
        judged(least, least >= -0.02));
  }

  // Of effects that no library has: the gap that the law closes, and whether it says what the effect follows.
  void add_laws() {
    std::vector<double> closed;
    Share follows;
    std::string lines;
    for (const BlindScore& score : scores_) {
      if (score.set != "outside") continue;
      closed.push_back(score.law_closed);
      ++follows.all;
      follows.right += score.law_follows ? 1 : 0;
      lines += fmt::format("  {:12} {} {}, named {}: {}, closed {:.3f}{}\n", fmt::join(score.expected, ""), score.id,
                           to_string(score.verdict),
                           score.named.empty() ? "nothing" : fmt::format("{}", fmt::join(score.named, " and ")),
                           score.law.empty() ? "no law" : score.law, score.law_closed,
                           score.law_follows ? "" : ", elsewhere");
    }
    if (closed.empty()) return;
    const double median = stats::lower_quantile(closed, 0.5);
    text_ += fmt::format("unknown effects for a law: gap closed by it, held out, median {:.3f} (bar 0.70)  {}\n",
                         median, judged(median, median >= 0.70));
    add_share("unknown effects for a law: what they follow is said", 0.90, follows);
    text_ += lines;
  }

  void add_parameters() {
    Share inside;
    for (const BlindScore& score : scores_) {
      if (!is_known(score)) continue;
      for (const auto& parameter : score.parameters) {
        ++inside.all;
        inside.right += parameter.inside ? 1 : 0;
      }
    }
    text_ += fmt::format("parameters inside their 95 % interval: bar 88 %  {}  {}\n", with_interval(inside),
                         judged(part(inside), part(inside) >= 0.88));
    for (const ParameterBar& bar : parameter_bars) {
      std::vector<double> of_kind;
      for (const BlindScore& score : scores_) {
        if (!is_known(score)) continue;
        for (const auto& parameter : score.parameters) {
          if (&bar_of(parameter.effect) == &bar && parameter.truth != 0.0) of_kind.push_back(relative_error(parameter));
        }
      }
      if (of_kind.empty()) continue;
      const double error = stats::lower_quantile(of_kind, 0.5);
      text_ += fmt::format("median error of {} parameters of {}: {:.1f} % (bar {:.0f} %)  {}\n", of_kind.size(),
                           bar.what, 100.0 * error, 100.0 * bar.most, judged(error, error <= bar.most));
    }
  }

  // By strength and by effect.
  void add_detection() {
    std::size_t weak = 0;
    std::size_t weak_named = 0;
    for (const BlindScore& score : scores_) {
      weak += score.weak ? 1 : 0;
      weak_named += score.weak && score.right ? 1 : 0;
    }
    text_ += fmt::format("weaker than half of the noise floor: {} cases, {} of them found\n", weak, weak_named);
    text_ += detection_curve(scores_);
    std::map<std::string, Share> by_effect;
    std::map<std::string, std::vector<double>> errors;
    for (const BlindScore& score : scores_) {
      if (!is_known(score)) continue;
      for (const std::string& name : score.expected) {
        Share& share = by_effect[name];
        ++share.all;
        share.right += is_named(score, name) ? 1 : 0;
      }
      for (const auto& parameter : score.parameters) {
        if (parameter.truth != 0.0)
          errors[parameter.effect + " " + parameter.name].push_back(relative_error(parameter));
      }
    }
    text_ += "\nfound, where it was hidden (among others or alone), and median error of its parameters:\n";
    for (const auto& [name, share] : by_effect) {
      text_ += fmt::format("  {:24} {} of {} ", name, share.right, share.all);
      for (const auto& [parameter, values] : errors) {
        if (!parameter.starts_with(name + " ")) continue;
        text_ +=
            fmt::format("  {} {:.1f} %", parameter.substr(name.size() + 1), 100.0 * stats::lower_quantile(values, 0.5));
      }
      text_ += "\n";
    }
  }

  void add_misses() {
    text_ += "\nnot right:\n";
    for (const BlindScore& score : scores_) {
      if (score.right) continue;
      text_ +=
          fmt::format("  {} {:12} {}: expected {} {}, found {} {} (held out {:.4g} N, {}){}\n", score.id, score.set,
                      score.weak ? "weak " : "", to_string(score.expected_verdict), fmt::join(score.expected, " and "),
                      to_string(score.verdict), fmt::join(score.named, " and "), score.after_N,
                      std::isnan(score.floor_N) ? "no true model" : fmt::format("floor {:.4g} N", score.floor_N),
                      score.data_blamed ? ", data blamed" : "");
    }
  }

  [[nodiscard]] BlindTable table() && { return {std::move(text_), all_met_}; }

 private:
  // Its effects are all known, and strong enough to count.
  static bool is_known(const BlindScore& score) {
    return !score.weak && score.expected_verdict == FindingsVerdict::explained;
  }

  [[nodiscard]] Share share_of(const Bar& bar) const {
    Share share;
    for (const BlindScore& score : scores_) {
      if (score.set != bar.set || score.weak) continue;
      if (score.set == "three") {
        for (const std::string& name : score.expected) {
          ++share.all;
          share.right += is_named(score, name) ? 1 : 0;
        }
        continue;
      }
      ++share.all;
      share.right += (score.set == "none" ? score.named.empty() : score.right) ? 1 : 0;
    }
    return share;
  }

  void add_share(const std::string& what, double least, const Share& share) {
    text_ += fmt::format("{:56} bar {:3.0f} %  {}  {}\n", what, 100.0 * least, with_interval(share),
                         judged(part(share), part(share) >= least));
  }

  // A figure that could not be had (no case of the kind) has no bar.
  std::string_view judged(double value, bool met) {
    if (std::isnan(value)) return "";
    all_met_ = all_met_ && met;
    return met ? "met" : "NOT MET";
  }

  const std::vector<BlindScore>& scores_;
  std::string text_;
  bool all_met_ = true;
};

}  // namespace

BlindTable blind_table(const std::vector<BlindScore>& scores) {
  TableText table(scores);
  table.add_sets();
  table.add_false_claims();
  table.add_gap_closed();
  table.add_laws();
  table.add_parameters();
  table.add_detection();
  table.add_misses();
  return std::move(table).table();
}

}  // namespace touchstone::blind

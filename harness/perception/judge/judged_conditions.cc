#include "harness/perception/judge/judged_conditions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <set>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/in_parallel.h"
#include "harness/recording/force_sign.h"
#include "harness/stats/distributions.h"
#include "harness/stats/summary.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

// As if normal: half the interval over its quantile.
double error_of_d_prime(const Judgement& j) { return (j.d_prime_high95 - j.d_prime_low95) / (2.0 * 1.959964); }

void rank_conditions(std::vector<JudgedCondition>& conditions) {
  std::vector<std::size_t> order(conditions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return conditions[a].judgement.d_prime < conditions[b].judgement.d_prime;
  });
  // z of the difference of two d'.
  const auto apart = [&](std::size_t a, std::size_t b) {
    const Judgement& x = conditions[a].judgement;
    const Judgement& y = conditions[b].judgement;
    const double error = std::hypot(error_of_d_prime(x), error_of_d_prime(y));
    const double difference = y.d_prime - x.d_prime;
    return error > 0.0 ? difference / error : (difference > 0.0 ? 1e9 : 0.0);
  };
  std::size_t group = 1;
  std::size_t first_of_group = 0;
  for (std::size_t r = 0; r < order.size(); ++r) {
    JudgedCondition& own = conditions[order[r]];
    own.rank = r + 1;
    if (r > 0) own.behind_probability = stats::normal_cdf(apart(order[r - 1], order[r]));
    if (r > 0 && apart(order[first_of_group], order[r]) > 1.959964) {
      ++group;
      first_of_group = r;
    }
    own.group = group;
  }
}

std::optional<RateHardnessEstimate> rate_hardness_of(const FeltSeries& felt, const WeberLaw& force) {
  return estimated_rate_hardness(felt.force_N[0], felt.depth_m, felt.rate_Hz, force.absolute_threshold);
}

// Below it, the response over one depth says too little of the object: on the springs of the bench it is above 0.99.
constexpr double depth_explains = 0.8;

// Share of the variation of the force along the direction of pressing that the response explains.
double share_by_depth(const JudgedProcess& process) {
  const std::vector<double>& force_N = process.felt.force_N[0];
  const double spread_N = stats::standard_deviation(force_N);
  const double varies_N2 = spread_N * spread_N * static_cast<double>(force_N.size());
  return varies_N2 > 0.0 ? 1.0 - residual_squares_N2(*process.response, process.felt) / varies_N2 : 1.0;
}

void find_strongest(JudgedCondition& own, const Recording& recording) {
  const auto& moments = own.judgement.moments;
  if (moments.empty()) return;
  const auto strongest =
      std::max_element(moments.begin(), moments.end(), [](const auto& a, const auto& b) { return a.jnd < b.jnd; });
  own.strongest_s = strongest->t_s;
  // The clock may have been evened: the sample nearest to that time.
  const auto& t = recording.motion.t_s;
  const auto at = std::min(static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), strongest->t_s) - t.begin()),
                           t.size() - 1);
  own.strongest_W_m = recording.motion.p_W_m[at];
}

}  // namespace

JudgedConditions judge_conditions(const Recording& real, const std::vector<RecordingSource>& repeats,
                                  const std::vector<RecordingSource>& conditions, const Vec3& outward,
                                  const JudgeOptions& options, const std::function<void(std::size_t)>& progress) {
  if (conditions.empty()) throw BadData("there is no condition to compare with the real process");
  std::set<std::string> names;
  for (const auto& c : conditions) {
    if (!names.insert(c.name).second) throw BadData(fmt::format("two conditions are called '{}'", c.name));
  }
  const JudgedProcess reference = judged_process(felt_series(real, outward), options.thresholds);
  if (!reference.response) {
    throw BadData(
        fmt::format("{}: never presses into anything along the direction of pressing; give the direction "
                    "(--direction), or check the sign of the force",
                    real.source));
  }
  const auto prepared = [&](const Recording& recording, const RecordingSource& source) {
    FeltSeries felt = felt_series(recording, outward);
    felt.replayed_samples = source.replayed_samples;
    return judged_process(std::move(felt), options.thresholds, &reference);
  };
  const double explained = share_by_depth(reference);
  JudgedConditions result;
  result.rate_Hz = reference.felt.rate_Hz;
  result.samples = reference.felt.size();
  result.outward = outward;
  std::vector<JudgedProcess> repeated(repeats.size());
  in_parallel(
      repeats.size(), [&](std::size_t i) { repeated[i] = prepared(repeats[i].load(), repeats[i]); }, 1);
  result.floor = noise_floor(reference, repeated, options);
  result.real_rate_hardness = rate_hardness_of(reference.felt, options.thresholds.force);
  result.conditions.resize(conditions.size());
  const bool beside = conditions.size() <= keep_series_up_to;
  JudgeOptions own_options = options;
  own_options.keep_moments = beside;
  std::size_t done = 0;
  std::mutex mutex;
  const auto judge_one = [&](std::size_t i) {
    JudgedCondition& own = result.conditions[i];
    own.name = conditions[i].name;
    const Recording recording = conditions[i].load();
    const JudgedProcess process = prepared(recording, conditions[i]);
    own.judgement = judge(reference, process, result.floor, own_options);
    if (!own.judgement.open.empty())
      own.judgement.remarks.push_back(fmt::format("{}: {}", own.name, own.judgement.open));
    if (explained < depth_explains) {
      own.judgement.remarks.push_back(
          fmt::format("depth explains {:.0f} % of how the real force varies: the object is curved or sloping, or "
                      "differs from place to "
                      "place. Compare models on the real path (--model), or recordings of one path",
                      100.0 * explained));
    }
    const recording::ForceSign sign =
        recording::check_force_sign(std::vector<Vec3>(recording.size(), outward), recording.f_W_N);
    if (sign.verdict == recording::SignVerdict::reversed) {
      own.judgement.remarks.push_back(fmt::format(
          "{}: its forces point into the object, against those of the real process (statistic {:.2g}): is it "
          "the force BY the probe? Then negate the three columns",
          own.name, sign.statistic));
    }
    if (beside) {
      own.rate_hardness = rate_hardness_of(process.felt, options.thresholds.force);
      find_strongest(own, recording);
      own.others = other_metrics(real, recording, outward);
    }
    const std::scoped_lock lock(mutex);
    if (progress) progress(++done);
  };
  in_parallel(conditions.size(), judge_one, 1);
  rank_conditions(result.conditions);
  return result;
}

}  // namespace touchstone::perception

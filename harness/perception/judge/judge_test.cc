#include "harness/perception/judge/judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "harness/base/error.h"
#include "harness/base/random.h"
#include "harness/perception/judge/forced_choice.h"
#include "harness/perception/judge/judged_conditions.h"
#include "harness/perception/judge/vibration_scale.h"

namespace touchstone::perception {
using recording::Recording;

namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double two_pi = 2.0 * std::numbers::pi;

// Presses from free air on a spring, with a hand of its own for every seed.
struct JudgedPress {
  double k = 500.0;
  double stroke_m = 0.008;
  double beat_Hz = 1.0;
  int presses = 10;
  double sideways_N = 0.0;
  double buzz_N = 0.0;
  double buzz_Hz = 200.0;
  double delay_s = 0.0;
  double damping_N_s_per_m = 0.0;
  double record_later_s = 0.0;
  double noise_N = 0.005;
  double late_m = 0.0;
  Vec3 outward = Vec3::UnitZ();
};

Recording record_presses(const JudgedPress& press, std::uint64_t seed) {
  Random random(seed);
  Recording recording;
  recording.source = "presses";
  const double phase = random.uniform(0.0, 0.2);
  const auto depth = [&](double t) {
    return -0.0012 +
           (press.stroke_m + 0.0012) * 0.5 * (1.0 - std::cos(two_pi * press.beat_Hz * std::max(0.0, t - phase)));
  };
  const Vec3 across = press.outward.unitOrthogonal();
  const auto count = static_cast<int>(1000 * press.presses / press.beat_Hz);
  for (int i = 0; i < count; ++i) {
    const double clock = i / 1000.0;
    const double t = clock - press.record_later_s;
    const double felt = depth(t - press.delay_s) - press.late_m;
    const double speed = (depth(t + 1e-4) - depth(t - 1e-4)) / 2e-4;
    Vec3 f = Vec3::Zero();
    if (felt > 0.0) {
      const double part = std::min(1.0, 5.0 * felt / 0.008);
      f = (press.k * felt + press.damping_N_s_per_m * speed + press.buzz_N * std::sin(two_pi * press.buzz_Hz * t)) *
              press.outward +
          part * part * (3.0 - 2.0 * part) * press.sideways_N * across;
    }
    const double x = random.normal();
    const double y = random.normal();
    f += press.noise_N * Vec3(x, y, random.normal());
    recording.motion.t_s.push_back(clock);
    recording.motion.p_W_m.push_back(-(depth(t) + 1e-5 * random.normal()) * press.outward);
    recording.f_W_N.push_back(f);
  }
  return recording;
}

Judgement judged(const JudgedPress& rendered, const JudgeOptions& options = {}, std::uint64_t seed = 2,
                 const JudgedPress& real = {}) {
  const auto reference = judged_process(felt_series(record_presses(real, 1), real.outward), options.thresholds);
  const auto other =
      judged_process(felt_series(record_presses(rendered, seed), rendered.outward), options.thresholds, &reference);
  return judge(reference, other, {}, options);
}

const ChannelEvidence& of(const Judgement& judgement, Channel channel) {
  return judgement.channels[static_cast<std::size_t>(channel)];
}

// Steps of 7 % above 2.5 N between two forces.
double steps_above(double a_N, double b_N) { return std::abs(std::log(a_N / b_N)) / std::log(1.07); }

TEST(Judge, ARepeatOfTheRealThingIsNotNoticed) {
  for (const std::uint64_t seed : {2u, 3u, 4u, 5u}) {
    const auto judgement = judged({.noise_N = 0.001}, {}, seed, {.noise_N = 0.001});
    EXPECT_EQ(judgement.verdict, Verdict::not_noticed) << judgement.d_prime;
    EXPECT_LT(judgement.noticed_probability, 0.65);
    EXPECT_FALSE(judgement.gives_away.has_value());
  }
}

TEST(Judge, ASofterSpringIsToldAsComplianceUnlessTheDepthIsKnown) {
  // A hand that may be at another depth: 22 % (Tan, Durlach, Beauregard and Srinivasan 1995), by force or stiffness.
  const auto at_any_depth = judged({.k = 500.0 / 1.22, .noise_N = 0.0005}, {}, 2, {.noise_N = 0.0005});
  EXPECT_NEAR(of(at_any_depth, Channel::force).jnd, 1.0, 0.05);
  EXPECT_NEAR(at_any_depth.d_prime, 1.0, 0.1);
  JudgeOptions led;
  led.thresholds.depth_fraction = 0.0;
  const auto judgement = judged({.k = 400}, led);
  EXPECT_EQ(judgement.verdict, Verdict::noticed);
  ASSERT_TRUE(judgement.gives_away.has_value());
  EXPECT_EQ(*judgement.gives_away, Channel::force);
  // 4 N and 3.2 N at the full stroke: both above 2.5 N.
  EXPECT_NEAR(of(judgement, Channel::force).jnd, steps_above(4.0, 3.2), 0.1);
  EXPECT_NEAR(of(judgement, Channel::stiffness).jnd, std::log(1.25) / std::log(1.22), 0.05);
  EXPECT_THAT(of(judgement, Channel::stiffness).what, HasSubstr("400"));
  EXPECT_FALSE(of(judgement, Channel::force).remedy.empty());
}

TEST(Judge, SidewaysForceABuzzAndADelayAreSeenEachInItsChannel) {
  const auto sideways = judged({.sideways_N = 5.0});
  EXPECT_GT(sideways.d_prime, 5.0);
  EXPECT_NEAR(of(sideways, Channel::direction).jnd * 0.4468, std::atan2(5.0, 3.2), 0.1);
  const auto buzz = judged({.buzz_N = 0.5});
  ASSERT_TRUE(buzz.gives_away.has_value());
  EXPECT_EQ(*buzz.gives_away, Channel::vibration);
  EXPECT_THAT(of(buzz, Channel::vibration).what, HasSubstr("202 Hz"));
  const double threshold_N = Thresholds{}.vibration_force_N(20.0 * std::exp2(10.0 / 3.0));
  const double expected = VibrationScale(Thresholds{}).from_nothing(std::pow(0.5 / threshold_N, 2));
  EXPECT_NEAR(of(buzz, Channel::vibration).jnd / expected, 1.0, 0.1);
  const auto delayed = judged({.delay_s = 0.03});
  ASSERT_TRUE(delayed.gives_away.has_value());
  EXPECT_EQ(*delayed.gives_away, Channel::rate);
}

// Frequencies at the edges of third-octave bands too, where the threshold is another than at the centre.
TEST(Judge, ABuzzCountsByTheThresholdOfItsOwnFrequency) {
  const Thresholds thresholds;
  for (const double f : {90.0, 178.0, 250.0, 359.0, 430.0}) {
    const double amplitude_N = 3.0 * thresholds.vibration_force_N(f);
    const auto buzz = judged({.buzz_N = amplitude_N, .buzz_Hz = f, .noise_N = 0.0002}, {}, 2, {.noise_N = 0.0002});
    EXPECT_NEAR(of(buzz, Channel::vibration).jnd / VibrationScale(thresholds).from_nothing(9.0), 1.0, 0.05) << f;
  }
}

// At the edges of third-octave bands (178, 224 Hz) as well as within.
TEST(Judge, ATonesFrequencyCountsByItsJndWhereverItLies) {
  const Thresholds thresholds;
  const auto told = [&thresholds](double real_Hz, double rendered_Hz) {
    const auto tone = [&thresholds](double f_Hz) {
      return JudgedPress{.buzz_N = 10.0 * thresholds.vibration_force_N(f_Hz), .buzz_Hz = f_Hz, .noise_N = 0.0002};
    };
    return judged(tone(rendered_Hz), {}, 2, tone(real_Hz));
  };
  const double two_jnd = std::pow(1.0 + thresholds.frequency_fraction, 2.0);
  for (const double f : {65.0, 90.0, 126.0, 178.0, 201.6, 224.0, 285.0}) {
    EXPECT_LT(of(told(f, 1.05 * f), Channel::vibration).jnd, 0.5) << f;
    EXPECT_NE(told(f, 1.05 * f).verdict, Verdict::noticed) << f;
    const auto above = told(f, two_jnd * f);
    EXPECT_EQ(above.verdict, Verdict::noticed) << f;
    EXPECT_NEAR(of(above, Channel::vibration).jnd, 2.0, 0.4) << f;
    EXPECT_THAT(of(above, Channel::vibration).what, HasSubstr("Hz instead of")) << f;
  }
}

TEST(Judge, TheHandIsNotJudged) {
  for (const JudgedPress& other :
       {JudgedPress{.stroke_m = 0.012}, JudgedPress{.stroke_m = 0.006}, JudgedPress{.beat_Hz = 2.0},
        JudgedPress{.presses = 15}, JudgedPress{.record_later_s = 0.1}}) {
    const auto judgement = judged(other);
    EXPECT_LT(judgement.d_prime_low95, 0.1) << other.stroke_m << " " << other.beat_Hz << " " << other.presses;
    EXPECT_NE(judgement.verdict, Verdict::noticed);
    EXPECT_LT(of(judgement, Channel::force).jnd, 0.1);
    EXPECT_LT(of(judgement, Channel::rate).jnd, 0.1);
  }
}

// Of a difference too: another depth, speed, duration, number of presses or a delay of the whole recording change d' by
// less than its interval is wide.
TEST(Judge, TheHandChangesTheAnswerByLessThanItsInterval) {
  for (const double k : {200.0, 500.0, 2000.0}) {
    const JudgedPress real{.k = k, .stroke_m = 4.0 / k, .noise_N = 0.002};
    JudgedPress rendered = real;
    rendered.k = 0.6 * k;
    const auto usual = judged(rendered, {}, 2, real);
    std::vector<JudgedPress> hands(5, rendered);
    hands[0].stroke_m *= 1.5;
    hands[1].stroke_m *= 0.7;
    hands[2].beat_Hz = 2.0;
    hands[3].presses = 15;
    hands[4].record_later_s = 0.1;
    for (std::size_t h = 0; h < hands.size(); ++h) {
      const auto other = judged(hands[h], {}, 3 + h, real);
      EXPECT_LT(std::abs(other.d_prime - usual.d_prime), other.d_prime_high95 - other.d_prime_low95)
          << "k " << k << " hand " << h;
    }
    JudgedPress late = rendered;
    late.delay_s = 0.1;
    EXPECT_GT(judged(late, {}, 8, real).d_prime - usual.d_prime, 0.5) << k;
  }
}

TEST(Judge, DampingIsComparedAtTheSameSpeedWhateverTheHands) {
  const JudgedPress damped{.damping_N_s_per_m = 10.0};
  JudgedPress faster = damped;
  faster.beat_Hz = 2.0;
  EXPECT_LT(of(judged(faster, {}, 2, damped), Channel::rate).jnd, 0.2);
  EXPECT_GT(of(judged({.damping_N_s_per_m = 100.0}, {}, 2, damped), Channel::rate).jnd, 1.0);
}

// The JND of damping is a fraction of the magnitude of the whole impedance (Fu, Landman, van Paassen and Mulder 2018):
// the same damper more is felt half as much on twice the spring, and as much if it is less. Where the damper is nearly
// all, a quarter more is one JND (Jones, Hunter and Lafontaine 1997).
TEST(Judge, DampingIsFeltAgainstTheWholeImpedance) {
  const auto felt = [](double k, double damping, double other) {
    const JudgedPress real{.k = k, .damping_N_s_per_m = damping, .noise_N = 0.001};
    JudgedPress rendered = real;
    rendered.damping_N_s_per_m = other;
    return of(judged(rendered, {}, 2, real), Channel::rate).jnd;
  };
  const double on_soft = felt(1000.0, 10.0, 30.0);
  EXPECT_GT(on_soft, 0.3);
  EXPECT_NEAR(felt(2000.0, 10.0, 30.0) / on_soft, 0.5, 0.05);
  EXPECT_NEAR(felt(1000.0, 30.0, 10.0) / on_soft, 1.0, 0.05);
  EXPECT_NEAR(felt(20.0, 100.0, 125.0), 1.0, 0.15);
}

TEST(Judge, DoesNotDependOnTheFrameOrTheUnitOfTime) {
  const auto along_z = judged({.k = 450});
  const auto along_y = judged({.k = 450, .outward = Vec3::UnitY()}, {}, 2, {.outward = Vec3::UnitY()});
  EXPECT_NEAR(along_z.d_prime, along_y.d_prime, 0.5);  // noise of vibration differs with the axes
  EXPECT_NEAR(of(along_z, Channel::force).jnd, of(along_y, Channel::force).jnd, 1e-2);
}

TEST(Judge, AModelOnTheRealPathIsComparedMomentByMomentToo) {
  const auto real = record_presses({.noise_N = 0.0}, 1);
  Recording rendered = real;
  // Too strong in the first half, too weak in the second: the mean over depth is right.
  for (std::size_t i = 0; i < rendered.size(); ++i) rendered.f_W_N[i] *= i < rendered.size() / 2 ? 1.3 : 0.7;
  const JudgeOptions options;
  const auto reference = judged_process(felt_series(real, Vec3::UnitZ()), options.thresholds);
  const auto other = judged_process(felt_series(rendered, Vec3::UnitZ()), options.thresholds, &reference);
  const auto judgement = judge(reference, other, {}, options);
  EXPECT_TRUE(judgement.same_motion);
  EXPECT_EQ(judgement.verdict, Verdict::noticed);
  EXPECT_GT(judgement.noticed_share, 0.9);
  const auto itself = judge(reference, reference, {}, options);
  EXPECT_EQ(itself.d_prime, 0.0);
  EXPECT_EQ(itself.noticed_probability, 0.5);
}

TEST(Judge, RepeatsThatDifferMakeTheFloorAndTheAnswerThatTheDataCannotTell) {
  const JudgeOptions options;
  const auto real = judged_process(felt_series(record_presses({}, 1), Vec3::UnitZ()), options.thresholds);
  const auto process = [&](const JudgedPress& press, std::uint64_t seed) {
    return judged_process(felt_series(record_presses(press, seed), Vec3::UnitZ()), options.thresholds, &real);
  };
  const auto rendered = process({.k = 450}, 2);
  EXPECT_TRUE(judge(real, rendered, {}, options).above_noise);
  // Sessions that differ by 12 % from one to the next say nothing about 10 %.
  const auto floor = noise_floor(real, {process({.k = 440}, 3), process({.k = 560}, 4)}, options);
  const auto judgement = judge(real, rendered, floor, options);
  EXPECT_EQ(judgement.verdict, Verdict::cannot_tell);
  EXPECT_FALSE(judgement.above_noise);
  EXPECT_LT(judgement.d_prime, judge(real, rendered, {}, options).d_prime);
}

TEST(Judge, ARenderingThatGivesNoForceIsNoticed) {
  const auto judgement = judged({.k = 0.0});
  EXPECT_EQ(judgement.verdict, Verdict::noticed);
  EXPECT_GT(of(judgement, Channel::force).jnd, 5.0);
}

// 0.5 mm is what an optical or magnetic tracker is off by; a hand knows its place to some millimetres.
TEST(Judge, AFrameOffByATrackersErrorIsNotNoticed) {
  for (const double late_m : {0.0002, 0.0005, 0.001}) {
    const auto off = judged({.noise_N = 0.001, .late_m = late_m}, {}, 2, {.noise_N = 0.001});
    EXPECT_EQ(off.verdict, Verdict::not_noticed) << late_m << ": " << off.d_prime;
  }
  const auto far = judged({.stroke_m = 0.016, .noise_N = 0.001, .late_m = 0.009}, {}, 2, {.noise_N = 0.001});
  EXPECT_EQ(far.verdict, Verdict::noticed);
  EXPECT_EQ(far.gives_away, Channel::position);
  EXPECT_NEAR(of(far, Channel::position).jnd, 3.0, 0.1);
}

TEST(Judge, LeavesChannelsOutOfTheSumButShowsThem) {
  JudgeOptions options;
  options.thresholds.position_m = 4e-4;  // between finger and thumb
  const auto late = judged({.noise_N = 0.001, .late_m = 0.003}, options, 2, {.noise_N = 0.001});
  EXPECT_NEAR(of(late, Channel::position).jnd, 3.0 / 0.4, 0.1);
  options.without = {Channel::position};
  const auto without = judged({.noise_N = 0.001, .late_m = 0.003}, options, 2, {.noise_N = 0.001});
  EXPECT_LT(without.d_prime, 1.0);
  EXPECT_NEAR(of(without, Channel::position).jnd, 3.0 / 0.4, 0.1);
}

TEST(Judge, SimulatedObserversGiveTheStatedShareOfRightAnswers) {
  constexpr std::size_t trials = 40000;
  // Three standard errors of a share.
  const double tolerance = 3.0 * 0.5 / std::sqrt(static_cast<double>(trials));
  std::uint64_t seed = 1;
  for (const auto& evidence : {std::vector<double>{}, {0.0}, {1.0}, {0.7, 0.7}, {0.3, 0.2, 1.5}, {4.0}}) {
    double squares = 0.0;
    for (const double jnd : evidence) squares += jnd * jnd;
    EXPECT_NEAR(simulated_forced_choice(evidence, trials, seed++), forced_choice_probability(std::sqrt(squares)),
                tolerance);
  }
}

TEST(JudgedConditions, NumbersOfAPairDoNotDependOnTheOthersToTheBit) {
  const auto source = [](const std::string& name, const JudgedPress& press, std::uint64_t seed) {
    return RecordingSource{name, [=] { return record_presses(press, seed); }};
  };
  const auto real = record_presses({}, 1);
  const auto soft = source("soft", {.k = 380}, 2);
  const auto odd = source("odd", {.k = 100, .buzz_N = 2.0}, 3);
  const auto close = source("close", {}, 4);
  const auto alone = judge_conditions(real, {}, {soft}, Vec3::UnitZ(), {});
  const auto among = judge_conditions(real, {}, {odd, close, soft}, Vec3::UnitZ(), {});
  const auto& a = alone.conditions[0];
  const auto& b = among.conditions[2];
  EXPECT_EQ(a.judgement.d_prime, b.judgement.d_prime);
  EXPECT_EQ(a.judgement.d_prime_high95, b.judgement.d_prime_high95);
  for (std::size_t c = 0; c < channel_count; ++c) EXPECT_EQ(a.judgement.channels[c].jnd, b.judgement.channels[c].jnd);
  ASSERT_EQ(a.others.size(), b.others.size());
  for (std::size_t m = 0; m < a.others.size(); ++m) EXPECT_EQ(a.others[m].value, b.others[m].value) << a.others[m].name;
  EXPECT_EQ(among.conditions[0].rank, 3u);
  EXPECT_EQ(among.conditions[1].rank, 1u);
  EXPECT_THROW(judge_conditions(real, {}, {soft, soft}, Vec3::UnitZ(), {}), BadData);
  EXPECT_THROW(judge_conditions(real, {}, {}, Vec3::UnitZ(), {}), BadData);
}

// On many pairs: whatever else is judged beside them, spoiled or not, in whatever order.
TEST(JudgedConditions, NoOtherConditionChangesABitOfAnyAnswer) {
  const auto real = record_presses({}, 1);
  std::vector<RecordingSource> conditions;
  for (std::uint64_t c = 0; c < 6; ++c) {
    JudgedPress press{.k = 350.0 + 40.0 * static_cast<double>(c)};
    if (c == 2) press.buzz_N = 5.0;
    if (c == 3) press.noise_N = 2.0;
    if (c == 4) press.k = 0.0;
    conditions.push_back({std::to_string(c), [press, c] { return record_presses(press, 10 + c); }});
  }
  const auto forwards = judge_conditions(real, {}, conditions, Vec3::UnitZ(), {});
  std::reverse(conditions.begin(), conditions.end());
  const auto backwards = judge_conditions(real, {}, conditions, Vec3::UnitZ(), {});
  for (std::size_t c = 0; c < conditions.size(); ++c) {
    const auto alone = judge_conditions(real, {}, {conditions[c]}, Vec3::UnitZ(), {});
    for (const auto* other : {&backwards.conditions[c], &forwards.conditions[conditions.size() - 1 - c]}) {
      const Judgement& a = alone.conditions[0].judgement;
      const Judgement& b = other->judgement;
      EXPECT_EQ(alone.conditions[0].name, other->name);
      EXPECT_EQ(a.d_prime, b.d_prime);
      EXPECT_EQ(a.d_prime_low95, b.d_prime_low95);
      EXPECT_EQ(a.d_prime_high95, b.d_prime_high95);
      EXPECT_EQ(a.noticed_share, b.noticed_share);
      for (std::size_t e = 0; e < channel_count; ++e) {
        EXPECT_EQ(a.channels[e].jnd, b.channels[e].jnd);
        EXPECT_EQ(a.channels[e].standard_error, b.channels[e].standard_error);
      }
    }
  }
}

TEST(JudgedConditions, RateHardnessOfRepeatsAgreesOrHasNoValue) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    const auto felt = felt_series(record_presses({}, seed), Vec3::UnitZ());
    const auto estimate = estimated_rate_hardness(felt.force_N[0], felt.depth_m, felt.rate_Hz, 0.06);
    ASSERT_TRUE(estimate.has_value());
    EXPECT_NEAR(estimate->value_N_per_m, 500.0, 25.0);
    EXPECT_LT(estimate->low95_N_per_m, 500.0 * 1.05);
    EXPECT_GT(estimate->high95_N_per_m, 500.0 * 0.95);
    const auto noisy = felt_series(record_presses({.noise_N = 2.0}, seed), Vec3::UnitZ());
    EXPECT_FALSE(estimated_rate_hardness(noisy.force_N[0], noisy.depth_m, noisy.rate_Hz, 0.06).has_value());
  }
}

TEST(Judge, RefusesWhatItCannotCompare) {
  const JudgeOptions options;
  auto broken = record_presses({}, 1);
  broken.f_W_N[17].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(felt_series(broken, Vec3::UnitZ()), BadData);
  broken = record_presses({}, 1);
  broken.motion.t_s[20] = broken.motion.t_s[19];
  EXPECT_THROW(felt_series(broken, Vec3::UnitZ()), BadData);
  broken = record_presses({}, 1);
  broken.f_W_N.clear();
  EXPECT_THROW(felt_series(broken, Vec3::UnitZ()), BadData);
  // Finite, but its square's square is not.
  broken = record_presses({}, 1);
  broken.f_W_N[30].y() = -1e160;
  EXPECT_THAT([&] { felt_series(broken, Vec3::UnitZ()); },
              ThrowsMessage<BadData>(HasSubstr("sample 31 (t = 0.03 s) has a force of 1e+160 N")));
  broken = record_presses({}, 1);
  broken.motion.p_W_m[40].x() = 1e90;
  EXPECT_THAT([&] { felt_series(broken, Vec3::UnitZ()); }, ThrowsMessage<BadData>(HasSubstr("a place of 1e+90 m")));
}

// A clock that hurries and dawdles: what is linear in time is linear on the even clock.
TEST(FeltSeries, SamplesOfAnUnevenClockAreInterpolatedToAnEvenOne) {
  Recording recording;
  recording.source = "uneven";
  for (int i = 0; i <= 200; ++i) {
    const double t = 1e-3 * (i + (i % 2 == 0 ? 0.0 : 0.3));
    recording.motion.t_s.push_back(t);
    recording.motion.p_W_m.emplace_back(0.0, 0.0, -0.02 * t);
    recording.f_W_N.emplace_back(0.0, 0.0, 3.0 + 5.0 * t);
  }
  const FeltSeries felt = felt_series(recording, Vec3::UnitZ());
  EXPECT_FALSE(felt.same_clock);
  EXPECT_NEAR(felt.rate_Hz, 1000.0, 1e-9);
  ASSERT_EQ(felt.size(), 201U);
  for (std::size_t i = 0; i < felt.size(); ++i) {
    EXPECT_NEAR(felt.force_N[0][i], 3.0 + 5.0 * felt.t_s(i), 1e-12) << i;
    EXPECT_NEAR(felt.rate_of_depth_m_per_s[i], 0.02, 1e-12) << i;
  }
}

// Nothing is left of the force that the response itself gives; of one that is off by a constant, its square a sample.
TEST(Response, ResidualSquaresAreTheSumOverAllSamples) {
  const auto process = judged_process(felt_series(record_presses({}, 5), Vec3::UnitZ()), {});
  FeltSeries felt = process.felt;
  for (const double off_N : {0.0, 0.25, -3.0}) {
    for (std::size_t i = 0; i < felt.size(); ++i)
      felt.force_N[0][i] = expected_force_N(*process.response, felt, process.response->contact_m, i)[0] + off_N;
    const double expected_N2 = off_N * off_N * static_cast<double>(felt.size());
    EXPECT_NEAR(residual_squares_N2(*process.response, felt), expected_N2, 1e-9 * (1.0 + expected_N2)) << off_N;
  }
}

}  // namespace
}  // namespace touchstone::perception

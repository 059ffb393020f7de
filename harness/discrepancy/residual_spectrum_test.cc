// Hum, a resonance and a buzz, which cancel in the means over blocks: each is named with its frequency.
#include "harness/discrepancy/residual_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

#include "harness/discrepancy/findings.h"
#include "harness/discrepancy/plane_for_test.h"
#include "harness/discrepancy/two_recordings_for_test.h"

namespace touchstone::discrepancy {
using rendering::Model;

namespace {

constexpr double noise_levels[] = {0.01, 0.03, 0.1};  // of the force [N]

Model spring_plane(double unit) {
  Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = 900.0 / unit;
  return model;
}

// A force beside the plane's at every sample of the true path.
using Series = std::function<std::vector<Vec3>(const MotionColumns& path, Random& random)>;

using Path = MotionColumns (*)(double phase, double unit);

Findings judge(double unit, double noise_N, std::uint64_t seed, const Series& hidden, const Model& known, Path along) {
  InstrumentDescription instrument = small_noise(unit);
  instrument.force_noise_N = noise_N;
  Random random(seed);
  const auto measure = [&](double phase, std::uint64_t number) {
    const MotionColumns path = along(phase, unit);
    auto f_W_N = PlanePredictor(path).predict(known).f_W_N;
    const auto beside = hidden(path, random);
    for (std::size_t i = 0; i < f_W_N.size(); ++i) f_W_N[i] += beside[i];
    return measured(path, std::move(f_W_N), instrument, seed + number);
  };
  const TwoRecordings recordings(measure(0.0, 100), measure(1.1, 200), instrument, known,
                                 [](const MotionColumns& motion) { return std::make_unique<PlanePredictor>(motion); });
  Findings findings;
  findings.search = search_effects(recordings.data, known, {}, {}, [](const std::string&) {});
  conclude(findings, {});
  return findings;
}

Findings judge(double unit, double noise_N, std::uint64_t seed, const Series& hidden) {
  return judge(unit, noise_N, seed, hidden, spring_plane(unit), hand);
}

std::vector<Vec3> nothing(const MotionColumns& path, Random&) { return {path.size(), Vec3::Zero()}; }

Series tone(double frequency_Hz, double amplitude_N) {
  return [=](const MotionColumns& path, Random& random) {
    const double phase = random.uniform(0.0, 2.0 * std::numbers::pi);
    std::vector<Vec3> force;
    for (const double t_s : path.t_s) {
      force.emplace_back(0.6 * amplitude_N * std::sin(2.0 * std::numbers::pi * frequency_Hz * t_s + phase), 0.0,
                         0.8 * amplitude_N * std::sin(2.0 * std::numbers::pi * frequency_Hz * t_s + phase));
    }
    return force;
  };
}

// A lightly damped mass on a spring, shaken by white noise: exact at the samples as a complex first-order recursion.
Series resonance(double frequency_Hz, double damping, double rms_N) {
  return [=](const MotionColumns& path, Random& random) {
    const double omega = 2.0 * std::numbers::pi * frequency_Hz;
    const double step_s = path.t_s[1] - path.t_s[0];
    const auto pole = std::exp(std::complex<double>(-damping * omega, omega) * step_s);
    std::complex<double> z(rms_N * random.normal(), rms_N * random.normal());
    std::vector<Vec3> force;
    for (std::size_t i = 0; i < path.size(); ++i) {
      force.emplace_back(z.real(), 0.0, 0.0);
      const double kick = rms_N * std::sqrt(1.0 - std::norm(pole));
      z = pole * z + std::complex<double>(kick * random.normal(), kick * random.normal());
    }
    return force;
  };
}

class SpectrumAtScale : public ::testing::TestWithParam<double> {};

TEST_P(SpectrumAtScale, ShowsNothingWhereNothingIsMissing) {
  for (const double noise_N : noise_levels) {
    for (const std::uint64_t seed : {31U, 32U}) {
      const Findings findings = judge(GetParam(), noise_N, seed, nothing);
      EXPECT_TRUE(findings.search.spectrum.peaks.empty()) << describe(findings.search.spectrum.peaks);
      EXPECT_EQ(findings.verdict, FindingsVerdict::consistent) << findings.explanation;
    }
  }
}

TEST_P(SpectrumAtScale, NamesMainsHumThatMeansOverBlocksCancel) {
  for (const double noise_N : noise_levels) {
    const Findings findings = judge(GetParam(), noise_N, 41, tone(60.0, 0.5));
    ASSERT_EQ(findings.verdict, FindingsVerdict::unexplained) << findings.explanation;
    const SpectralPeak& peak = findings.search.spectrum.peaks.at(0);
    EXPECT_EQ(peak.name, "mains hum");
    EXPECT_NEAR(peak.frequency_Hz, 60.0, 0.6);
    EXPECT_NEAR(peak.rms_N, 0.5 / std::numbers::sqrt2, 0.05);
    EXPECT_NE(findings.explanation.find("mains hum of 60 Hz"), std::string::npos) << findings.explanation;
  }
}

// Its harmonic does not make the fundamental another thing, and no peak stands twice.
TEST_P(SpectrumAtScale, NamesHumWithItsHarmonics) {
  const Series hum = [](const MotionColumns& path, Random& random) {
    auto force = tone(50.0, 0.5)(path, random);
    const auto second = tone(100.0, 0.2)(path, random);
    for (std::size_t i = 0; i < force.size(); ++i) force[i] += second[i];
    return force;
  };
  for (const double noise_N : noise_levels) {
    const ResidualSpectrum spectrum = judge(GetParam(), noise_N, 45, hum).search.spectrum;
    ASSERT_GE(spectrum.peaks.size(), 2U);
    EXPECT_EQ(spectrum.peaks.at(0).name, "mains hum") << describe(spectrum.peaks);
    EXPECT_NEAR(spectrum.peaks.at(0).frequency_Hz, 50.0, 0.1);
    EXPECT_EQ(spectrum.peaks.at(1).name, "mains hum") << describe(spectrum.peaks);
    EXPECT_NEAR(spectrum.peaks.at(1).frequency_Hz, 100.0, 0.1);
    EXPECT_LE(spectrum.share, 1.05) << describe(spectrum.peaks);
  }
}

TEST_P(SpectrumAtScale, NamesAResonance) {
  for (const double noise_N : noise_levels) {
    const Findings findings = judge(GetParam(), noise_N, 42, resonance(81.0, 0.02, 0.3));
    ASSERT_EQ(findings.verdict, FindingsVerdict::unexplained) << findings.explanation;
    const SpectralPeak& peak = findings.search.spectrum.peaks.at(0);
    EXPECT_EQ(peak.name, "resonance");
    EXPECT_NEAR(peak.frequency_Hz, 81.0, 0.81);
  }
}

TEST_P(SpectrumAtScale, NamesABuzzThatOnlySlidingMakes) {
  const double unit = GetParam();
  const Series buzz = [&](const MotionColumns& path, Random& random) {
    auto force = tone(90.0, 0.4)(path, random);
    for (std::size_t i = 0; i < force.size(); ++i) {
      const std::size_t before = i > 0 ? i - 1 : 0;
      const Vec3 v = (path.p_W_m[before + 1] - path.p_W_m[before]) / (path.t_s[before + 1] - path.t_s[before]);
      if (path.p_W_m[i].z() >= 0.0 || v.head<2>().norm() < 0.008 * unit) force[i].setZero();
    }
    return force;
  };
  for (const double noise_N : noise_levels) {
    const Findings findings = judge(unit, noise_N, 43, buzz);
    ASSERT_EQ(findings.verdict, FindingsVerdict::unexplained) << findings.explanation;
    const SpectralPeak& peak = findings.search.spectrum.peaks.at(0);
    EXPECT_EQ(peak.name, "buzz while sliding");
    EXPECT_NEAR(peak.frequency_Hz, 90.0, 0.9);
  }
}

// White noise of five times the declared size has no line: its level tells.
TEST_P(SpectrumAtScale, IsNotConsistentFarAboveTheDeclaredNoise) {
  const Series hiss = [](const MotionColumns& path, Random& random) {
    std::vector<Vec3> force;
    // The sign turns at every sample, so that means over blocks are small.
    for (std::size_t i = 0; i < path.size(); ++i) {
      force.emplace_back(0.0, 0.0, (i % 2 == 0 ? 0.2 : -0.2) * std::abs(random.normal()));
    }
    return force;
  };
  const Findings findings = judge(GetParam(), 0.03, 44, hiss);
  EXPECT_EQ(findings.verdict, FindingsVerdict::unexplained) << findings.explanation;
}

// Rubs to and fro as fast as a hand does, pressing lightly: what tells the motion from the noise is short.
MotionColumns rubbing(double phase, double unit) {
  MotionColumns motion;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.004 * i;
    motion.t_s.push_back(t);
    motion.p_W_m.emplace_back(unit * 0.012 * std::sin(17.0 * t + phase), unit * 0.009 * std::cos(23.0 * t),
                              unit * (-0.002 - 0.001 * std::sin(11.0 * t + phase)));
  }
  return motion;
}

// A damper turns the positions' noise into a fast force: 30 N s/m times 3 mm/s. It is what the model makes of the
// noise, and nothing is missing.
TEST_P(SpectrumAtScale, OfADamperTheTrackersNoiseIsNoUnknownForce) {
  const double unit = GetParam();
  Model damped = spring_plane(unit);
  damped.effects.push_back({"viscous-friction", {{"coefficient_N_s_per_m", 30.0 / unit}}, ""});
  for (const std::uint64_t seed : {51U, 52U, 53U}) {
    const Findings findings = judge(unit, 0.01, seed, nothing, damped, rubbing);
    const ResidualSpectrum& spectrum = findings.search.spectrum;
    EXPECT_FALSE(spectrum.far_above_noise()) << spectrum.raw_N << " of " << spectrum.null_N;
    EXPECT_GT(spectrum.raw_N, 0.5 * spectrum.null_N);
    EXPECT_EQ(findings.verdict, FindingsVerdict::consistent) << findings.explanation;
  }
}

INSTANTIATE_TEST_SUITE_P(Units, SpectrumAtScale, ::testing::Values(1e-3, 1.0, 1e3));

}  // namespace
}  // namespace touchstone::discrepancy

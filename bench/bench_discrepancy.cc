// What one candidate costs a search for missing effects: the joint fit of stiffness and damper to 12 s of presses and
// circles over a plane whose renderer costs next to nothing, so that the fit itself is measured; and making the blocks.
// Counter predictions: how often the fit ran the renderer, which is what it costs with a real one.
#include <benchmark/benchmark.h>

#include "harness/base/random.h"
#include "harness/discrepancy/joint_fit.h"
#include "harness/discrepancy/plane_for_test.h"

namespace touchstone::bench {
using discrepancy::FitData;
using rendering::Model;

namespace {

constexpr double window_s = 1.0 / 30.0;
constexpr double noise_N = 0.01;
constexpr std::uint64_t seed = 2006;

class CountingPredictor final : public rendering::Predictor {
 public:
  explicit CountingPredictor(const MotionColumns& motion) : plane_(motion) {}
  rendering::Prediction predict(const Model& model) override {
    ++runs_;
    return plane_.predict(model);
  }
  [[nodiscard]] std::size_t runs() const noexcept { return runs_; }

 private:
  discrepancy::PlanePredictor plane_;
  std::size_t runs_ = 0;
};

Model plane(double stiffness_N_per_m, double damping_N_s_per_m) {
  Model model;
  model.renderer = "plane";
  model.parameters["stiffness_N_per_m"] = stiffness_N_per_m;
  model.effects = {{"viscous-friction", {{"coefficient_N_s_per_m", damping_N_s_per_m}}, "/effects/0"}};
  return model;
}

FitData measured(CountingPredictor& predictor, const MotionColumns& motion) {
  const rendering::Prediction truth = predictor.predict(plane(900.0, 4.0));
  FitData data;
  data.predictor = &predictor;
  data.blocks = discrepancy::make_blocks(motion, window_s);
  data.measured_N = block_means(data.blocks, truth.f_W_N);
  const auto normals = block_means(data.blocks, truth.n_W);
  Random random(seed);
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    discrepancy::BlockNoise noise;
    noise.n_W = normals[b].norm() > 0.0 ? Vec3(normals[b].normalized()) : Vec3(Vec3::Zero());
    noise.along_normal_N = noise.tangential_N = noise_N;
    data.measured_N[b] += noise_N * Vec3(random.normal(), random.normal(), random.normal());
    data.noise.push_back(noise);
  }
  return data;
}

void candidate_fit(benchmark::State& state) {
  const MotionColumns motion = discrepancy::hand(0.0, 1.0);
  CountingPredictor predictor(motion);
  const FitData data = measured(predictor, motion);
  const std::vector<discrepancy::FreeParameter> free{
      discrepancy::log_base_parameter("stiffness_N_per_m", 1.0, 1e6),
      discrepancy::linear_parameter("viscous-friction", "coefficient_N_s_per_m", 1.0, 0.0, 100.0)};
  const std::size_t before = predictor.runs();
  discrepancy::JointFit fit;
  for (auto _ : state) {
    fit = fit_jointly(data, plane(972.0, 0.5), free, 12, state.range(0) == 1);
    benchmark::DoNotOptimize(fit);
  }
  if (!fit.ok && state.range(0) == 1) return state.SkipWithError("the fit failed");
  state.counters["predictions"] =
      static_cast<double>(predictor.runs() - before) / static_cast<double>(state.iterations());
  state.counters["stiffness_N_per_m"] = fit.model.parameters.at("stiffness_N_per_m");
  state.counters["blocks"] = static_cast<double>(data.blocks.size());
}
BENCHMARK(candidate_fit)->ArgName("with_covariance")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void blocks(benchmark::State& state) {
  const MotionColumns motion = discrepancy::hand(0.0, 1.0);
  for (auto _ : state) benchmark::DoNotOptimize(discrepancy::make_blocks(motion, window_s));
}
BENCHMARK(blocks)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace touchstone::bench

#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/random.h"
#include "harness/rendering/smooth_field.h"
#include "harness/surface/embree_surface.h"
#include "renderers/instrument/assemble.h"
#include "renderers/instrument/catalogue.h"
#include "renderers/model_predictor.h"

namespace touchstone::renderers {
using rendering::Model;
using rendering::Prediction;
using surface::TriangleMesh;

namespace {

struct Samples {
  std::vector<double> t_s;
  std::vector<Vec3> p_W_m;
  std::vector<Quat> q_WS;
  std::vector<Vec3> f_W_N;
  [[nodiscard]] rendering::MotionView view() const { return {t_s, p_W_m, q_WS}; }
};

Samples random_samples(std::uint64_t seed) {
  Random random(seed);
  Samples samples;
  for (int i = 0; i < 50; ++i) {
    samples.t_s.push_back(0.01 * i);
    samples.p_W_m.push_back(random.direction());
    samples.q_WS.push_back(random.rotation());
    samples.f_W_N.push_back(3.0 * random.direction());
  }
  return samples;
}

std::vector<Vec3> applied(const std::string& name, const std::vector<double>& values, const Samples& samples) {
  std::vector<Vec3> f_W_N = samples.f_W_N;
  find_instrument_effect(name)->make(values)->apply(samples.view(), f_W_N);
  return f_W_N;
}

TEST(InstrumentEffects, ActInTheSensorsFrame) {
  const Samples samples = random_samples(5);
  const auto bias = applied("force-bias", {0.1, -0.2, 0.3}, samples);
  const auto drift = applied("force-drift", {0.1, -0.2, 0.3}, samples);
  const auto crosstalk = applied("force-crosstalk", {0.1, -0.2}, samples);
  const auto saturation = applied("force-saturation", {1.0}, samples);
  const auto gain = applied("gain-drift", {0.3}, samples);
  for (std::size_t i = 0; i < samples.t_s.size(); ++i) {
    const Quat& q = samples.q_WS[i];
    const Vec3 f_S = q.conjugate() * samples.f_W_N[i];
    EXPECT_NEAR((q.conjugate() * bias[i] - f_S - Vec3(0.1, -0.2, 0.3)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((q.conjugate() * drift[i] - f_S - samples.t_s[i] * Vec3(0.1, -0.2, 0.3)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((q.conjugate() * crosstalk[i] - f_S - Vec3(0.1 * f_S.z(), -0.2 * f_S.z(), 0.0)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((gain[i] - (1.0 + 0.3 * samples.t_s[i]) * samples.f_W_N[i]).norm(), 0.0, 1e-12);
    EXPECT_LE((q.conjugate() * saturation[i]).cwiseAbs().maxCoeff(), 1.0 + 1e-12);
  }
}

TEST(InstrumentEffects, WeightPullsDownWhateverTheOrientation) {
  const Samples samples = random_samples(6);
  const auto heavy = applied("tool-weight", {0.5}, samples);
  for (std::size_t i = 0; i < heavy.size(); ++i) {
    EXPECT_NEAR((heavy[i] - samples.f_W_N[i] - Vec3(0, 0, -0.5 * 9.80665)).norm(), 0.0, 1e-12);
  }
}

TEST(InstrumentEffects, InertiaOfASteadyAccelerationIsExact) {
  Samples samples = random_samples(7);
  const Vec3 a(1.0, -2.0, 0.5);
  for (std::size_t i = 0; i < samples.t_s.size(); ++i) samples.p_W_m[i] = 0.5 * samples.t_s[i] * samples.t_s[i] * a;
  const auto forces = applied("tool-inertia", {0.2, 0.05}, samples);
  for (std::size_t i = 1; i + 1 < forces.size(); ++i) {
    EXPECT_NEAR((forces[i] - samples.f_W_N[i] + 0.2 * a).norm(), 0.0, 1e-8) << i;
  }
}

TEST(InstrumentEffects, ALagReadsTheForceOfEarlierInTheSensorsFrame) {
  Samples samples = random_samples(8);
  const auto reading_S_N = [](double t_s) { return Vec3(t_s * Vec3(1.0, 2.0, 3.0)); };
  const auto check = [&](const char* what) {
    const auto late = applied("time-lag", {0.025}, samples);
    for (std::size_t i = 3; i < late.size(); ++i) {
      const Quat q = samples.q_WS.empty() ? Quat::Identity() : samples.q_WS[i];
      EXPECT_NEAR((q.conjugate() * late[i] - reading_S_N(samples.t_s[i] - 0.025)).norm(), 0.0, 1e-12) << what << i;
    }
    EXPECT_NEAR((late[0] - samples.f_W_N[0]).norm(), 0.0, 1e-12) << what;
  };
  for (std::size_t i = 0; i < samples.t_s.size(); ++i) {
    samples.f_W_N[i] = samples.q_WS[i] * reading_S_N(samples.t_s[i]);
  }
  check("turning, sample ");
  samples.q_WS.clear();
  for (std::size_t i = 0; i < samples.t_s.size(); ++i) samples.f_W_N[i] = reading_S_N(samples.t_s[i]);
  check("not turned, sample ");
}

TEST(InstrumentEffects, RegistrationIsUndoneExactly) {
  const Vec3 d(1e-3, -2e-3, 3e-3);
  const Vec3 r(0.02, -0.03, 0.01);
  const Vec3 pivot(5.0, -7.0, 2.0);
  const auto effect =
      find_instrument_effect("registration")
          ->make(std::vector<double>{d.x(), d.y(), d.z(), r.x(), r.y(), r.z(), pivot.x(), pivot.y(), pivot.z()});
  Random random(9);
  for (int i = 0; i < 20; ++i) {
    const Vec3 truth = pivot + random.direction();
    EXPECT_NEAR((effect->true_position(truth + d + r.cross(truth - pivot)) - truth).norm(), 0.0, 1e-14);
  }
}

// Distances of two places come out longer by the scale, and the pivot where it is.
TEST(InstrumentEffects, ATrackersScaleIsUndoneExactly) {
  const Vec3 pivot(0.4, -0.2, 3.0);
  for (const double scale : {-0.3, 1e-3, 0.2}) {
    const auto effect =
        find_instrument_effect("tracker-scale")->make(std::vector<double>{scale, pivot.x(), pivot.y(), pivot.z()});
    EXPECT_NEAR((effect->true_position(pivot) - pivot).norm(), 0.0, 1e-15);
    Random random(10);
    for (int i = 0; i < 20; ++i) {
      const Vec3 a = random.direction();
      const Vec3 b = pivot + random.direction();
      const double apart_m = (effect->true_position(a) - effect->true_position(b)).norm();
      EXPECT_NEAR((1.0 + scale) * apart_m, (a - b).norm(), 1e-12);
    }
  }
}

// A file of the first versions has no rz_rad and no pivot: it turns about the object's origin.
TEST(Registration, ReadsTheFiveParametersAsEver) {
  const Vec3 d(1e-3, -2e-3, 3e-3);
  const Vec3 r(0.02, -0.03, 0.0);
  rendering::Model model;
  model.renderer = "god-object";
  model.instrument = {{"registration",
                       {{"dx_m", d.x()}, {"dy_m", d.y()}, {"dz_m", d.z()}, {"rx_rad", r.x()}, {"ry_rad", r.y()}},
                       "/instrument/0"}};
  const auto instrument = make_instrument(model);
  const Vec3 truth(0.3, -0.2, 0.1);
  EXPECT_NEAR((instrument.front().second->true_position(truth + d + r.cross(truth)) - truth).norm(), 0.0, 1e-15);
}

// A predictor that keeps its search for contact answers as one that starts anew.
TEST(ModelPredictor, KeptTracesChangeNothing) {
  TriangleMesh mesh;
  mesh.vertices_W_m = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::shared_ptr<const surface::Surface> surface = make_embree_surface(mesh);
  MotionColumns motion;
  Random random(10);
  for (int i = 0; i < 400; ++i) {
    motion.t_s.push_back(0.004 * i);
    motion.p_W_m.emplace_back(0.001 * i, 0.3 * std::sin(0.02 * i), 2e-3 * std::sin(0.05 * i));
    motion.q_WS.push_back(random.rotation());
  }
  Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = 500.0;
  model.effects = {{"coulomb-friction", {{"mu_static", 0.3}, {"mu_dynamic", 0.3}}, "/effects/0"}};
  model.instrument = {
      {"surface-geometry", {{"amplitude_m", 1e-3}, {"x_m", 0.2}, {"y_m", 0.1}, {"width_m", 0.1}}, "/instrument/0"},
      {"force-bias", {{"fx_N", 0.1}}, "/instrument/1"}};
  Model stiffer = model;
  stiffer.parameters["stiffness_N_per_m"] = 777.0;
  const auto kept = make_model_predictor(surface, motion);
  kept->predict(model);
  const Prediction warm = kept->predict(stiffer);
  const Prediction cold = make_model_predictor(surface, motion)->predict(stiffer);
  double largest = 0.0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    EXPECT_NEAR((warm.f_W_N[i] - cold.f_W_N[i]).norm(), 0.0, 1e-12);
    largest = std::max(largest, warm.f_W_N[i].norm());
  }
  EXPECT_GT(largest, 1.0);
}

// One that was asked for other models before answers each as one that starts anew, to the bit: whichever of the
// renderer, its parameters, an effect, its values or an entry of the instrument differs.
TEST(ModelPredictor, AnswersForTheModelThatItIsAsked) {
  TriangleMesh mesh;
  mesh.vertices_W_m = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::shared_ptr<const surface::Surface> surface = make_embree_surface(mesh);
  MotionColumns motion;
  for (int i = 0; i < 200; ++i) {
    motion.t_s.push_back(0.004 * i);
    motion.p_W_m.emplace_back(0.001 * i, 0.3 * std::sin(0.02 * i), 2e-3 * std::sin(0.05 * i));
  }
  std::vector<Model> models(8);
  for (Model& model : models) {
    model.renderer = "god-object";
    model.parameters["stiffness_N_per_m"] = 500.0;
    model.effects = {{"coulomb-friction", {{"mu_static", 0.3}, {"mu_dynamic", 0.3}}, "/effects/0"}};
    model.instrument = {{"registration", {{"dz_m", 1e-4}}, "/instrument/0"}};
  }
  models[1].effects[0].parameters["mu_dynamic"] = 0.1;
  models[2].effects[0] = {"viscous-friction", {{"coefficient_N_s_per_m", 3.0}}, "/effects/0"};
  models[3].effects.clear();
  models[4].instrument[0].parameters["dz_m"] = -2e-4;
  models[5].instrument.clear();
  models[6].parameters["tip_radius_m"] = 1e-3;
  models[7].renderer = "spring-linear";
  std::vector<Prediction> cold;
  for (const Model& model : models) cold.push_back(make_model_predictor(surface, motion)->predict(model));
  for (std::size_t i = 1; i < models.size(); ++i) {
    const bool differs = cold[i].f_W_N != cold[0].f_W_N;
    EXPECT_TRUE(differs || i == 7) << i << ": a model that gives the same shows nothing";
  }
  const auto kept = make_model_predictor(surface, motion);
  for (int round = 0; round < 2; ++round) {
    for (std::size_t i = 0; i < models.size(); ++i) {
      EXPECT_EQ(kept->predict(models[i]).f_W_N, cold[i].f_W_N) << "model " << i << " in round " << round;
    }
  }
}

// A ramp h = 0.01 x on the plane z = 0, touched from 1 mm below: as deep as the tip is below the ramp, and the force
// leans against it.
TEST(HeightField, IsDepthAndSlopeOfTheContact) {
  const std::vector<Vec3> vertices{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  TriangleMesh mesh;
  mesh.vertices_W_m = vertices;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.source = "square";
  std::map<std::string, double> ramp{{"x_low_m", -0.3}, {"x_high_m", 0.3}, {"y_low_m", -0.3},
                                     {"y_high_m", 0.3}, {"columns", 5.0},  {"rows", 4.0}};
  for (std::size_t column = 0; column < 5; ++column) {
    for (std::size_t row = 0; row < 4; ++row)
      ramp[rendering::field_coefficient(column, row)] = 0.01 * (-0.3 + 0.3 * (static_cast<double>(column) - 1.0));
  }
  Model model;
  model.renderer = "god-object";
  model.parameters["stiffness_N_per_m"] = 500.0;
  model.instrument = {{"height-field", ramp, "/instrument/0"}};
  MotionColumns motion;
  motion.t_s = {0.0, 0.01};
  motion.p_W_m = {{0.1, 0.0, -1e-3}, {0.2, 0.05, -1e-3}};
  const Prediction prediction = make_model_predictor(make_embree_surface(mesh), motion)->predict(model);
  for (std::size_t i = 0; i < 2; ++i) {
    const double depth_m = (1e-3 + 0.01 * motion.p_W_m[i].x()) / std::hypot(1.0, 0.01);
    EXPECT_NEAR(prediction.depth_m[i], depth_m, 1e-12);
    EXPECT_NEAR(prediction.f_W_N[i].norm(), 500.0 * depth_m, 1e-9);
    EXPECT_NEAR(prediction.f_W_N[i].x() / prediction.f_W_N[i].z(), -0.01, 1e-6);
  }
}

}  // namespace
}  // namespace touchstone::renderers

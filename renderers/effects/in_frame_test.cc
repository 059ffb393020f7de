// A map in a frame of its own does to a contact what the same map over the object's xy plane does to the same contact,
// seen from that frame.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "harness/rendering/effect.h"
#include "harness/rendering/model.h"
#include "harness/rendering/surface_frame.h"
#include "renderers/catalogue.h"
#include "renderers/effects/assemble.h"
#include "renderers/instrument/assemble.h"

namespace touchstone::renderers {
namespace {

using rendering::ContactState;
using rendering::Model;
using rendering::SurfaceFrame;

const std::map<std::string, std::map<std::string, double>> maps{
    {"stiffness-map", {{"amplitude", 0.5}, {"x_m", 2e-3}, {"y_m", -1e-3}, {"width_m", 4e-3}}},
    {"surface-texture", {{"amplitude_m", 2e-4}, {"wavelength_m", 3e-3}, {"direction_rad", 0.7}, {"phase_rad", 0.3}}},
    {"stiffness-field",
     {{"x_low_m", -0.01}, {"x_high_m", 0.01}, {"y_low_m", -0.01}, {"y_high_m", 0.01}, {"c_01_02", 0.4}}},
    {"friction-field",
     {{"x_low_m", -0.01}, {"x_high_m", 0.01}, {"y_low_m", -0.01}, {"y_high_m", 0.01}, {"c_02_01", 0.4}}},
    {"height-field",
     {{"x_low_m", -0.01}, {"x_high_m", 0.01}, {"y_low_m", -0.01}, {"y_high_m", 0.01}, {"c_01_02", 4e-4}}},
    {"surface-geometry", {{"amplitude_m", 3e-4}, {"x_m", 2e-3}, {"y_m", -1e-3}, {"width_m", 4e-3}}}};

std::unique_ptr<rendering::Effect> effect_of(const std::string& name, const std::map<std::string, double>& parameters) {
  Model model;
  model.renderer = "god-object";
  const bool measured = name == "height-field" || name == "surface-geometry";
  auto& entries = measured ? model.instrument : model.effects;
  entries.push_back({name, parameters, "/0"});
  return measured ? make_instrument(model).front().second->contact_effect()
                  : std::move(make_effects(model).front().effect);
}

ContactState touching() {
  ContactState contact;
  contact.dt_s = 1e-3;
  contact.tip_W_m = Vec3(1e-3, 5e-4, -1e-3);
  contact.tip_step_W_m = Vec3(1e-5, 2e-5, -3e-6);
  contact.n_W = Vec3(0.1, -0.2, 1.0).normalized();
  contact.depth_m = 1.2e-3;
  contact.proxy_W_m = contact.tip_W_m + contact.depth_m * contact.n_W;
  contact.stiffness_N_per_m = 700.0;
  contact.normal_force_N = 0.9;
  contact.tangential_W_N = Vec3(0.2, 0.1, 0.0);
  contact.contact = true;
  return contact;
}

TEST(InFrame, AMapSeesTheContactFromItsOwnFrame) {
  const SurfaceFrame frame{Vec3(10.0, -7.0, 5.0), Quat(Eigen::AngleAxisd(2.1, Vec3(0.3, -0.5, 0.8).normalized()))};
  for (const auto& [name, parameters] : maps) {
    ContactState own = touching();
    ContactState elsewhere = own;
    elsewhere.tip_W_m = frame.q_WF * own.tip_W_m + frame.origin_W_m;
    elsewhere.proxy_W_m = frame.q_WF * own.proxy_W_m + frame.origin_W_m;
    for (Vec3 ContactState::*const vector :
         {&ContactState::tip_step_W_m, &ContactState::n_W, &ContactState::tangential_W_N})
      elsewhere.*vector = frame.q_WF * own.*vector;
    std::map<std::string, double> in_frame = parameters;
    add_frame(frame, in_frame);
    effect_of(name, parameters)->apply(own);
    effect_of(name, in_frame)->apply(elsewhere);
    const ContactState before = touching();
    EXPECT_TRUE(own.depth_m != before.depth_m || own.normal_force_N != before.normal_force_N ||
                own.tangential_W_N != before.tangential_W_N)
        << name << " does nothing here, so that the test shows nothing";
    EXPECT_NEAR(elsewhere.depth_m, own.depth_m, 1e-13) << name;
    EXPECT_NEAR(elsewhere.normal_force_N, own.normal_force_N, 1e-11) << name;
    EXPECT_NEAR((elsewhere.n_W - frame.q_WF * own.n_W).norm(), 0.0, 1e-11) << name;
    EXPECT_NEAR((elsewhere.tangential_W_N - frame.q_WF * own.tangential_W_N).norm(), 0.0, 1e-11) << name;
    EXPECT_NEAR((elsewhere.proxy_W_m - (frame.q_WF * own.proxy_W_m + frame.origin_W_m)).norm(), 0.0, 1e-13) << name;
  }
}

// What is written is read again, upside down too.
TEST(InFrame, IsKeptByAModelFile) {
  for (const Vec3& normal : {Vec3(0.3, -0.5, 0.8), Vec3(0.0, 1e-9, -1.0), Vec3(0.0, 0.0, -1.0), Vec3(1.0, 0.0, 0.0)}) {
    const SurfaceFrame frame = SurfaceFrame::facing(normal, Vec3(1.0, 2.0, 3.0));
    EXPECT_NEAR((frame.q_WF * Vec3::UnitZ() - normal.normalized()).norm(), 0.0, 1e-8);
    std::map<std::string, double> parameters;
    add_frame(frame, parameters);
    const SurfaceFrame read = rendering::frame_of(parameters);
    EXPECT_EQ(read.origin_W_m, frame.origin_W_m);
    EXPECT_NEAR(read.q_WF.angularDistance(frame.q_WF), 0.0, 1e-7) << normal.transpose();
  }
  EXPECT_TRUE(rendering::frame_of(std::map<std::string, double>{{"x_m", 1.0}}).is_objects());
}

}  // namespace
}  // namespace touchstone::renderers

// The haptic device between a renderer and the hand, as the effect "haptic-device" of a model file: the renderer sees
// the position that the encoders resolve, at the controller's period; the hand feels what the motors and the frame can
// give. In this order, each left out where its parameter is 0:
//   servo_period_s             the renderer runs only when a period has passed; its force is held in between
//   resolution_m               each coordinate of the tip is rounded to a multiple of it
//   stiffness_limit_N_per_m    the force never exceeds limit * depth: the stiffest contact that the device shows
//   force_limit_N              the force's magnitude is cut there: saturation of the motors
//   time_constant_s            first order: the force follows the command with this time constant, exactly for a
//   command
//                              that is constant from step to step
// Source: the datasheet figures of Shao, Wu and Ouyang, table 1 (resolution, stiffness, maximum force). Servo period
// and first-order dynamics are the usual model of a sampled device (Colgate and Brown 1994), and not in that table.
#pragma once

#include <memory>
#include <optional>

#include "harness/rendering/model.h"
#include "harness/rendering/named_declaration.h"
#include "harness/rendering/parameters.h"
#include "harness/rendering/renderer.h"

namespace touchstone::renderers {

struct DeviceLimits {
  double servo_period_s = 0.0;
  double resolution_m = 0.0;
  double stiffness_limit_N_per_m = 0.0;
  double force_limit_N = 0.0;
  double time_constant_s = 0.0;
};

const rendering::NamedDeclaration& haptic_device_declaration();

// Takes the entry "haptic-device" out of the model's effects. Nothing where there is none; throws BadData for two of
// them or parameters that are wrong.
std::optional<DeviceLimits> take_haptic_device(rendering::Model& model);

std::unique_ptr<rendering::Renderer> make_haptic_device(std::unique_ptr<rendering::Renderer> rendering,
                                                        const DeviceLimits& limits);

}  // namespace touchstone::renderers

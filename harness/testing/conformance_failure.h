// What a failure of the conformance suite says to a renderer's author, who does not read the suite: on what was
// pressed, where, at which step, what was expected, what came, and what a renderer that cannot do it may declare
// instead. Lengths in metres, forces in newtons, in the world's frame.
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>

#include "harness/rendering/limitation.h"
#include "harness/rendering/renderer.h"

namespace touchstone::testing {

inline std::string place_text(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z()); }

inline std::string answer_text(const rendering::StepResult& answer) {
  return fmt::format("force {} N, {}", place_text(answer.f_W_N),
                     answer.contact ? fmt::format("contact at {} m", place_text(answer.contact_W_m)) : "no contact");
}

// " declares `thin_shells` ..."; "" where nothing may be declared.
inline std::string may_declare_text(std::span<const rendering::Ability> abilities) {
  if (abilities.empty()) return "\n  no ability covers this: a renderer that does it is wrong";
  std::string names;
  for (const rendering::Ability ability : abilities)
    names += fmt::format("{}\"{}\"", names.empty() ? "" : " or ", rendering::ability_name(ability));
  return fmt::format(
      "\n  a renderer that cannot do this by its method declares {} with the reason, and the test is skipped "
      "(`limitations` of a plug-in's description, `cannot` of a RendererEntry)",
      names);
}

// One step that went wrong. `above_m`: of the tip, over the surface; negative inside.
struct FailedStep {
  std::string_view shape;
  std::size_t step = 0;
  Vec3 tip_m = Vec3::Zero();
  double above_m = 0.0;
  rendering::StepResult answer;
};

inline std::string failure_text(const FailedStep& at, std::string_view expected,
                                std::span<const rendering::Ability> abilities) {
  return fmt::format("{}, step {}: the tip at {} m, {:.3g} mm {}\n  expected: {}\n  obtained: {}{}", at.shape, at.step,
                     place_text(at.tip_m), 1e3 * std::abs(at.above_m), at.above_m < 0.0 ? "inside" : "outside",
                     expected, answer_text(at.answer), may_declare_text(abilities));
}

}  // namespace touchstone::testing

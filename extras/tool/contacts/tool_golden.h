// Goldens of renderers of tools: what each answered to the scripted path of an exact case when that was accepted, and
// how far an answer may be from it, per axis of force and torque. One file says it for several renderers:
//   {"schema": "touchstone-tool-golden/1", "case": "peg-0.2mm", "seconds": 60, "keep_every": 200,
//    "stiffness_N_per_m": 1000, "rotational_stiffness_Nm_per_rad": 2,
//    "renderers": ["god-object-tool", ...],
//    "tolerance": {"force_N": [1e-6, 1e-6, 1e-6], "torque_Nm": [1e-7, 1e-7, 1e-7], "reason": "..."},
//    "accepted": [{"renderer": "god-object-tool", "reason": "...", "commit": "..."}]}
// The accepted answers stand beside it: CASE.RENDERER.csv, every keep_every-th sample of a path at 1 kHz.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "contacts/exact_cases.h"
#include "harness/recording/trajectory.h"
#include "harness/tool/tool_renderer_entry.h"

namespace touchstone::contacts {

struct ToolGolden {
  std::filesystem::path file;
  std::string exact_case;
  double seconds = 60.0;
  std::uint64_t keep_every = 1;
  tool::Coupling coupling;
  std::vector<std::string> renderers;
  Vec3 force_tolerance_N = Vec3::Zero();
  Vec3 torque_tolerance_Nm = Vec3::Zero();

  [[nodiscard]] std::filesystem::path answer(std::string_view renderer) const {
    return file.parent_path() / (exact_case + "." + std::string(renderer) + ".csv");
  }
};

// Throws BadData with the place.
ToolGolden read_tool_golden(const std::filesystem::path& file);

// What the renderer answers now, the samples that a golden keeps. Throws RendererFailed when it breaks down.
recording::Recording answer_now(const ToolGolden& golden, const tool::ToolRendererEntry& entry);

// Writes answer_now() as the golden and the reason into the file. Throws UsageError for a renderer that the golden does
// not name, or without a reason.
void accept_tool_golden(const ToolGolden& golden, const tool::ToolRendererEntry& entry, const std::string& reason,
                        const std::string& commit);

}  // namespace touchstone::contacts

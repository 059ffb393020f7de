// A sweep of renderers of tools with a shape: each case is one contact whose answer is known, rendered by one renderer,
// and its row holds how far off the renderer is (harness/tool/tool_errors.h).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/json_reader.h"
#include "harness/runs/case_engine.h"
#include "harness/tool/tool_errors.h"
#include "harness/tool/tool_renderer_entry.h"
#include "sweep/design.h"

namespace touchstone::sweep {

// A contact and a renderer of a specification. Throw BadData for a key that nothing reads.
struct SweptContact {
  std::string name;
  tool::ContactShape shape;
};
SweptContact read_swept_contact(JsonObject& object);
struct SweptToolRenderer {
  std::string renderer;
  tool::ToolSettings settings;
};
SweptToolRenderer read_swept_tool_renderer(JsonObject& object);

struct ToolSweep {
  std::vector<tool::ToolRendererEntry> renderers;
  // The contact of that name with its answers behind this coupling; thread-safe.
  std::function<tool::KnownContacts(std::string_view name, const tool::Coupling&, const tool::ContactShape&)> contacts;
};

runs::CaseTable tool_sweep_table(const SweepDesign& design);
// Both must live as long as the job. A case that cannot be run is a row with its error.
runs::CaseJob tool_sweep_job(const SweepDesign& design, const ToolSweep& sweep);

}  // namespace touchstone::sweep

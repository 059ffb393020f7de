// The atlas of tools as a report with its maps, as a picture, and as JSON.
#pragma once

#include <string>
#include <vector>

#include "harness/report/page.h"
#include "harness/report/provenance.h"
#include "tool_atlas/tool_atlas.h"

namespace touchstone::tool_atlas {

// "god-object-tool is off by more than a person notices (1 JND) in 2 of 96 cases, most in ..., ..."; one sentence a
// renderer.
std::string tool_atlas_sentence(const std::vector<ToolAtlasCase>& cases);
// A line for each renderer and contact.
std::string tool_atlas_text(const std::vector<ToolAtlasCase>& cases);
report::Page tool_atlas_page(const std::vector<ToolAtlasCase>& cases, const report::Provenance& provenance);
std::string tool_atlas_to_json(const std::vector<ToolAtlasCase>& cases);
// SVG: a map for each renderer (column) and contact (row), size or clearance across, stiffness upwards, JND in the
// cells.
std::string tool_atlas_picture(const std::vector<ToolAtlasCase>& cases);

}  // namespace touchstone::tool_atlas

// The atlas as a report with its maps, as pictures, and as JSON.
#pragma once

#include <string>
#include <vector>

#include "atlas/atlas.h"
#include "harness/report/page.h"
#include "harness/report/provenance.h"

namespace touchstone::atlas {

std::size_t failed_cases(const std::vector<AtlasCase>& cases);
// A line for each renderer, scene and friction: how many of the cases show what.
std::string atlas_table(const std::vector<AtlasCase>& cases);
report::Page atlas_page(const std::vector<AtlasCase>& cases, const report::Provenance& provenance);
std::string atlas_to_json(const std::vector<AtlasCase>& cases);
// SVG: a map for each renderer (row) and friction (column), sharpness across, stiffness upwards.
std::string atlas_picture(const std::vector<AtlasCase>& cases, Scene scene);

}  // namespace touchstone::atlas

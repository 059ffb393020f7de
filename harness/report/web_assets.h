// The files that every report carries inside: taken into the program when it is built.
#pragma once

#include <string_view>

namespace touchstone::report {

std::string_view web_asset_plotly();  // plotly.js, gl3d bundle, MIT licence (its notice is at its head)
std::string_view web_asset_script();  // web/report.js
std::string_view web_asset_style();   // web/report.css

}  // namespace touchstone::report

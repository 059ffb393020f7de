#include "tool_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/tool/tool_path.h"
#include "tool_metrics.h"

namespace touchstone::tool {

ToolErrors errors_of(ToolRenderer& renderer, const std::string& name, const KnownContacts& known) {
  ToolErrors errors;
  errors.contacts = known.name;
  errors.renderer = name;
  double force_sum = 0.0, torque_sum = 0.0;
  for (std::size_t i = 0; i < known.handles.size(); ++i) {
    const ToolResult result = known.slid_from.empty()
                                  ? settle(renderer, known.free, known.handles[i])
                                  : slide(renderer, known.free, known.slid_from[i], known.handles[i]);
    const Wrench& right = known.wrenches_W[i];
    const double force_error = (result.f_W_N - right.f_N).norm();
    const double torque_error = (result.torque_W_Nm - right.torque_Nm).norm();
    force_sum += force_error;
    torque_sum += torque_error;
    errors.max_force_N = worse(errors.max_force_N, force_error);
    errors.max_torque_Nm = worse(errors.max_torque_Nm, torque_error);
    errors.max_force_jnd = worse(errors.max_force_jnd, force_error_in_jnd(right.f_N, result.f_W_N));
    errors.max_torque_jnd = worse(errors.max_torque_jnd, torque_error_in_jnd(right.torque_Nm, result.torque_W_Nm));
    errors.largest_right_force_N = std::max(errors.largest_right_force_N, right.f_N.norm());
    errors.largest_right_torque_Nm = std::max(errors.largest_right_torque_Nm, right.torque_Nm.norm());
  }
  const auto n = static_cast<double>(known.handles.size());
  errors.mean_force_N = force_sum / n;
  errors.mean_torque_Nm = torque_sum / n;
  return errors;
}

std::string tool_error_table(std::span<const ToolErrors> rows) {
  std::string table =
      "| case | renderer | force error, mean (N) | max (N) | max (JND) | torque error, mean (mNm) | max (mNm) | max "
      "(JND) | force "
      "(N) | torque (mNm) |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n";
  for (const ToolErrors& row : rows) {
    table += fmt::format("| {} | {} | {:.2g} | {:.2g} | {:.2g} | {:.2g} | {:.2g} | {:.2g} | {:.3g} | {:.3g} |\n",
                         row.contacts, row.renderer, row.mean_force_N, row.max_force_N, row.max_force_jnd,
                         row.mean_torque_Nm * 1e3, row.max_torque_Nm * 1e3, row.max_torque_jnd,
                         row.largest_right_force_N, row.largest_right_torque_Nm * 1e3);
  }
  return table;
}

}  // namespace touchstone::tool

// The detectors one by one (harness/renderer_faults/diagnosis.h says what each looks for).
#pragma once

#include <optional>

#include "harness/renderer_faults/diagnosis.h"
#include "harness/renderer_faults/force_law.h"

namespace touchstone::renderer_faults {

// contact_faults.cc
std::optional<Finding> find_standoff(const Engine& engine);
std::optional<Finding> find_tie_break(const Engine& engine);
std::optional<Finding> find_gap_at_contact(const Engine& engine);
std::optional<Finding> find_late_contact(const Engine& engine);
std::optional<Finding> find_untouchable_triangles(const Engine& engine);
std::optional<Finding> find_pops_through_shell(const Engine& engine);

// sliding_faults.cc
std::optional<Finding> find_sticks_at_flat_edges(const Engine& engine);
std::optional<Finding> find_sticks_at_joints(const Engine& engine);
std::optional<Finding> find_jump_between_triangles(const Engine& engine);
std::optional<Finding> find_friction_lost(const Engine& engine);
std::optional<Finding> find_ball_at_edge(const Engine& engine);
// Beside what a map makes of the right force.
std::optional<Finding> find_ball_at_edge_under(const Engine& engine, const ForceMap& map);

// signal_faults.cc
std::optional<Finding> find_noise(const Engine& engine);
std::optional<Finding> find_wrong_frame(const Engine& engine);
std::optional<Finding> find_energy_gained(const Engine& engine);

// response_faults.cc
std::optional<Finding> find_mirrored_axis(const Engine& engine);
std::optional<Finding> find_exchanged_axes(const Engine& engine);
std::optional<Finding> find_lost_axis(const Engine& engine);
std::optional<Finding> find_saturation(const Engine& engine);
std::optional<Finding> find_quantised(const Engine& engine);
std::optional<Finding> find_place_dependent(const Engine& engine);
std::optional<Finding> find_rate_dependent(const Engine& engine);
std::optional<Finding> find_hysteresis(const Engine& engine);

// event_faults.cc
std::optional<Finding> find_dropout(const Engine& engine);
std::optional<Finding> find_one_bad_face(const Engine& engine);
std::optional<Finding> find_falls_through_block(const Engine& engine);

// running_faults.cc
std::optional<Finding> find_allocation(const Engine& engine);
std::optional<Finding> find_state_after_reset(const Engine& engine);
std::optional<Finding> find_shared_state(const Engine& engine);
std::optional<Finding> find_growing_cost(const Engine& engine);
std::optional<Finding> find_late_spike(const Engine& engine);

}  // namespace touchstone::renderer_faults

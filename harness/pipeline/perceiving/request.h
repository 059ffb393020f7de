// What a person would notice of renderings of one real process: the files, and how to treat them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "harness/perception/features/rate_hardness.h"
#include "harness/perception/filters/output_band.h"
#include "harness/recording/dataset.h"
#include "harness/rendering/model.h"

namespace touchstone::pipeline {

// Of the distance in perception space of Shao, Wu and Ouyang, as published.
struct PaperSettings {
  std::string answers;  // file of paired comparisons by people; empty: none
  std::string scaling = "reference-norm";
  std::optional<double> explained_share;  // of the variance, by the dimensions; 0.9 if not given, as in the paper
  double rate_Hz = 0.0;                   // common to all recordings; 0: the real recording's median rate
  double dead_zone_N = 0.0;               // of the force sensor
  double band_Hz = perception::finger_band_high_Hz;  // output band of the finger; 0: none
  double duration_tolerance = 0.2;                   // share of the real process's duration
  std::size_t window = perception::default_rate_hardness_window;
  bool hardness_in_band = false;
};

// Of the judge.
struct JudgeSettings {
  std::string thresholds;            // file that replaces just noticeable differences; empty: none
  std::string instrument;            // file of what the makers declare; empty: none
  std::vector<std::string> without;  // channels left out of the sum
  bool depth_known = false;          // the hand is led to the same depth, so that forces can be compared there
};

struct PerceiveRequest {
  struct Condition {
    std::string name, file;
  };
  struct Rendering {
    std::string name, file;  // of the model
    rendering::Model model;
  };
  std::string real;  // recording of the real process
  std::vector<std::string> repeats;
  std::vector<Condition> conditions;
  std::vector<Rendering> models;      // conditions that models render along the real path
  std::string mesh, mesh_unit = "m";  // the object that models render
  // Outward direction of pressing: "force" (that of the real process), "+x", "-x", "+y", "-y", "+z" or "-z".
  std::string direction = "force";
  // What models are fed; where not given, as models_path_of() says.
  std::optional<recording::InTrajectoryMode> in_trajectory;
  std::string extend_edges;  // width with its unit, "0" for none; empty: as needed
  bool flip_force = false;   // every recording that is read has the force BY the probe
  JudgeSettings judge;
  PaperSettings paper;
  std::vector<std::string> command_line;  // for provenance
};

}  // namespace touchstone::pipeline

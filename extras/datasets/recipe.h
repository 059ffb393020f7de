// The bundled data sets: what object, what hand, what instruments. Everything that follows is computed from here and a
// seed.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "harness/surface/mesh_file.h"
#include "measured_scan.h"
#include "synthetic/parameters.h"

namespace touchstone::datasets {

struct Recipe {
  std::string name;
  std::string object;                        // in words
  std::string shows;                         // what the recording is for
  std::string surface;                       // of the surface catalogue
  synthetic::ParameterOverrides parameters;  // its
  std::size_t triangles;
  std::string mesh_file;
  std::string mesh_unit;
  Contact contact;
  double stiffness_N_per_m;  // of the virtual probe: the paper's 0.5 N/mm
  ForceSensor sensor;
  Tracker tracker;
  std::unique_ptr<const Guide> (*guide)(const synthetic::AnalyticSurface& surface);
  ScanScript (*script)(std::uint64_t seed);
  synthetic::Tessellation (*mesh)() = nullptr;         // instead of the surface's own, of the same shape outside
  Tracker::Pose (*object_pose)(double t_s) = nullptr;  // of an object that moves: X_WB; the recording is made in B
  std::string motion = {};                             // the same in words
};

std::span<const Recipe> recipes();
// Families of shapes with exact answers, which are made when they are wanted instead of being bundled (families.cc):
// bumps, a saddle, a closed bumpy body, a convex crease, a thin shell, two blocks flush with one another, a plate that
// moves.
std::span<const Recipe> families();
// Of both. Throws UsageError listing what is known.
const Recipe& recipe(std::string_view name);

// The scan of a recipe; the surface is kept alive by it.
RigidScan make_scan(const Recipe& recipe, std::uint64_t seed);

}  // namespace touchstone::datasets

// The god-object beside two existing libraries on the same meshes and in-trajectories: how far each force is from that
// of the continuous god-object on the smooth surface that the mesh was sampled from.
//
// Data: TOUCHSTONE_DATA_DIR/peers (not part of this project): in/*.obj.gz (m), in/*.csv.gz (t_s, x, y, z), out/*.csv.gz
// (t_s, proxy, force, contacts) of CHAI3D 3.3.0 (static and dynamic proxy) and HAPI 1.1.1 (god-object), k = 500 N/m,
// point probe. The surfaces: plane z = 0; r = 30 mm (1 + 0.30 x y + 0.08 sin(3x + 1) cos(2z) + 0.05 sin(5y)) over unit
// directions; z = 2 mm exp(-(x^2 + y^2) / (2 (4 mm)^2)).
//
// The exact answer is k (q - p), q the closest surface point to p where p is inside: depths stay at 1 mm, well below
// every radius of curvature, where the god-object of a smooth surface is its closest point. It is solved to rounding
// (synthetic/surfaces), and its deviation from the mesh's own answer is part of the error of each.
//
// What of an error is the mesh's and what the renderer's own: off_mesh_N. Both libraries keep their proxy 1e-7 m above
// the triangles (all of their error on plane20k: 5e-5 N) and take one crossing per step; where the triangles lie inside
// the smooth body, as bumpy's do, the first happens to help.
//
// A peer's answer may be later than its input by whole samples: each is given the lag of 0 to 3 samples that suits it
// best, for the mean and for the maximum separately. Ours gets none.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/rendering/model.h"
#include "harness/rendering/renderer_entry.h"
#include "harness/rendering/replay.h"

namespace touchstone::experiments {

struct PeerResult {
  std::string method;   // "touchstone god-object", "CHAI3D static", ...
  double mean_N = 0.0;  // of |f - f_exact| over all samples
  double max_N = 0.0;
  int lag_samples = 0;      // that gave the mean
  double off_mesh_N = 0.0;  // mean of |f - f_mesh| at that lag, f_mesh the god-object of the triangles themselves
  double mean_us = 0.0;     // per step in this run; NaN for peers, which are not run here
};

struct PeerCase {
  std::string mesh;  // "plane20k"
  std::size_t triangles = 0;
  std::size_t samples = 0;
  std::vector<PeerResult> results;  // ours first
};

std::vector<std::string> peer_meshes();

// `peers` is the folder with in/ and out/; `besides` are models of other renderers to run on the same (their stiffness
// must be that of the peers). Throws BadData when a file is missing or malformed.
PeerCase compare_with_peers(const std::filesystem::path& peers, const std::string& mesh,
                            const std::vector<rendering::Model>& besides = {});
// The model of a renderer's entry at the peers' stiffness. Throws UsageError when it has no parameter
// stiffness_N_per_m.
rendering::Model peer_model(std::shared_ptr<const rendering::RendererEntry> entry);

// What our god-object makes of that case's positions when the mesh is given in another unit, in metres.
recording::RenderedTrajectory render_peer_case(const std::filesystem::path& peers, const std::string& mesh,
                                               double unit_m);

std::string peer_table(const std::vector<PeerCase>& cases);
std::string peer_json(const std::vector<PeerCase>& cases);

}  // namespace touchstone::experiments

// Several bodies, each with a pose of its own that may move in time, under one renderer.
//
// Bodies are moved by whoever moves them: no contact force disturbs them. Their poses are those of the sample at hand;
// between two samples each moves on its own way, and a renderer that follows contact looks along the way that its proxy
// makes relative to each body.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "harness/rendering/pose_track.h"
#include "harness/surface/surface.h"
#include "harness/surface/triangle_mesh.h"

namespace touchstone::rendering {

struct SceneBody {
  std::string name;
  std::shared_ptr<const surface::Surface> surface_B;  // in the body's own frame
  PoseTrack pose;
};

struct BodyScene {
  std::vector<SceneBody> bodies;  // at least one
  std::string source;             // for messages

  [[nodiscard]] bool moves() const {
    return std::any_of(bodies.begin(), bodies.end(), [](const SceneBody& body) { return body.pose.moves(); });
  }
};

// All bodies in one mesh in W, where they are at the beginning. Throws BadData for a body without triangles.
surface::TriangleMesh joined_mesh(const BodyScene& scene);

}  // namespace touchstone::rendering

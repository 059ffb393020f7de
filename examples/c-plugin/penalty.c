/* A haptic renderer as a plug-in, in C: the force pulls the tip to the closest point of the surface, F = k dx (the
 * vector-field or penalty method that Zilles and Salisbury, IROS 1995, describe before their own). It remembers
 * nothing, so that a tip pushed past the middle of a thin body is pulled out on the other side: it says so in
 * `limitations`. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <touchstone/plugin.h>

#include "closest_point.h"
#include "planted_fault.h"

struct touchstone_renderer {
  double stiffness_N_per_m;
  struct mesh mesh;
  struct planted_memory planted;
};

static const char* creation_error = "";

uint32_t touchstone_plugin_version(void) { return TOUCHSTONE_PLUGIN_VERSION; }

const touchstone_description* touchstone_describe(uint32_t index) {
  static const touchstone_parameter parameters[] = {
      {"stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "k of F = k dx"},
  };
  static const touchstone_limitation limitations[] = {
      {"thin_shells", "it remembers no side: past the middle of a thin body it pushes on"},
      {"large_jumps", "it remembers no side: a tip that jumps through is on the other side"},
      {"continuous_force", "the closest surface point jumps where two are equally close"},
      {"ball_tip", "it renders a point"},
  };
  static const touchstone_description penalty = {
      TOUCHSTONE_PLUGIN_SIZES,
      "penalty-in-c",
      "F = k dx from the closest surface point, without memory",
      "the vector-field method as described by Zilles and Salisbury 1995",
      parameters,
      sizeof parameters / sizeof parameters[0],
      limitations,
      sizeof limitations / sizeof limitations[0],
  };
  return index == 0 ? &penalty : NULL;
}

touchstone_renderer* touchstone_create(const touchstone_creation* creation) {
  touchstone_renderer* const made = calloc(1, sizeof *made);
  if (made == NULL) {
    creation_error = "out of memory";
    return NULL;
  }
  made->stiffness_N_per_m = creation->parameters[0];
  const char* const wrong =
      mesh_make(&made->mesh, creation->vertices_W_m, creation->triangles, creation->triangle_count);
  if (wrong != NULL) {
    creation_error = wrong;
    touchstone_destroy(made);
    return NULL;
  }
  return made;
}

int touchstone_step(touchstone_renderer* renderer, const touchstone_tip* tip, touchstone_result* result) {
  const vec p = {tip->p_W_m[0], tip->p_W_m[1], tip->p_W_m[2]};
  const struct foot foot = closest_of_mesh(&renderer->mesh, p);

  memset(result, 0, sizeof *result);
  memcpy(result->contact_W_m, tip->p_W_m, sizeof result->contact_W_m);
  if (foot.above_m < 0.0) {
    const vec out = sub(foot.point, p); /* the way out, as long as the tip is deep */
    const vec n = scaled(1.0 / foot.distance_m, out);
    const vec f = scaled(renderer->stiffness_N_per_m, out);
    *result = (touchstone_result){
        {f.x, f.y, f.z}, {foot.point.x, foot.point.y, foot.point.z}, {n.x, n.y, n.z}, foot.distance_m, 1, 0};
  }
  const vec* const corner = renderer->mesh.corners + 3 * foot.triangle;
  const vec side = sub(corner[1], corner[0]);
  plant_fault(&renderer->planted, tip, sqrt(dot(side, side)), result);
  return 0;
}

int touchstone_reset(touchstone_renderer* renderer) {
  memset(&renderer->planted, 0, sizeof renderer->planted);
  return 0;
}

void touchstone_destroy(touchstone_renderer* renderer) {
  if (renderer == NULL) return;
  mesh_free(&renderer->mesh);
  free(renderer);
}

const char* touchstone_error(const touchstone_renderer* renderer) { return renderer == NULL ? creation_error : ""; }

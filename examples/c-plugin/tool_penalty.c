/* A renderer of a tool with a shape as a plug-in, in C, behind version 2 of the interface: each vertex of the tool that
 * is inside the object is pushed to the closest point of the surface by a spring, F = k dx, and the hand feels the sum
 * of the forces and of their torques about the handle. There is no proxy apart from the handle: the tool is where the
 * hand is. What touches between the tool's vertices (an edge of the object, a vertex of it) is not felt: it says so in
 * `limitations`, by which `touchstone tool check` leaves out what cannot hold. */
#include <math.h>
#include <stdlib.h>
#include <touchstone/plugin2.h>

#include "closest_point.h"

struct touchstone2_renderer {
  double stiffness_N_per_m;
  struct mesh object;
  const touchstone2_mesh* tool; /* the program's: it stays until touchstone2_destroy() */
};

static const char* creation_error = "";

uint32_t touchstone_plugin_version(void) { return TOUCHSTONE_PLUGIN_VERSION_2; }

const touchstone2_description* touchstone2_describe(uint32_t index) {
  static const touchstone_parameter parameters[] = {
      {"contact_stiffness_N_per_m", "N/m", 1e-9, 1e9, 500.0, "k of F = k dx at each vertex"},
  };
  static const touchstone_limitation limitations[] = {
      {"rigid_motion", "only vertices of the tool touch: tool and object cannot change parts"},
  };
  static const touchstone2_description penalty = {
      .size = sizeof(touchstone2_description),
      .tip_kind = TOUCHSTONE2_TOOL,
      .name = "tool-penalty-in-c",
      .summary = "a spring at each vertex of the tool, no proxy",
      .source = "penalty forces at sampled points, as McNeely, Puterbaugh and Troy 1999 begin with",
      .parameters = parameters,
      .parameter_count = sizeof parameters / sizeof parameters[0],
      .limitations = limitations,
      .limitation_count = sizeof limitations / sizeof limitations[0],
      .epsilon_m = 0.0,
      .world_unit_m = 1.0,
  };
  return index == 0 ? &penalty : NULL;
}

touchstone2_renderer* touchstone2_create(const touchstone2_creation* creation) {
  if (creation->tool == NULL || creation->body_count != 1) {
    creation_error = "one tool and one body were expected";
    return NULL;
  }
  touchstone2_renderer* const made = calloc(1, sizeof *made);
  if (made == NULL) {
    creation_error = "out of memory";
    return NULL;
  }
  made->stiffness_N_per_m = creation->parameters[0];
  made->tool = &creation->tool->mesh;
  const touchstone2_mesh* const mesh = &creation->bodies[0].mesh;
  const char* const wrong = mesh_make(&made->object, mesh->vertices_m, mesh->triangles, mesh->triangle_count);
  if (wrong != NULL) {
    creation_error = wrong;
    touchstone2_destroy(made);
    return NULL;
  }
  return made;
}

/* v turned by the rotation of q = (w, x, y, z): v + 2 w (u x v) + 2 u x (u x v), u = (x, y, z). */
static vec turned(const double* q, vec v) {
  const vec u = {q[1], q[2], q[3]};
  const vec t = scaled(2.0, cross(u, v));
  return add(v, add(scaled(q[0], t), cross(u, t)));
}

static void copy(vec from, double* to) {
  to[0] = from.x;
  to[1] = from.y;
  to[2] = from.z;
}

int touchstone2_step(touchstone2_renderer* renderer, const touchstone2_input* input, touchstone2_result* result) {
  /* In the object's frame, which may move: X_BW = X_WB^-1. */
  const touchstone2_pose* const body = &input->bodies[0];
  const double back[4] = {body->q_WB[0], -body->q_WB[1], -body->q_WB[2], -body->q_WB[3]};
  const vec origin = {body->p_W_m[0], body->p_W_m[1], body->p_W_m[2]};
  const vec handle = {input->tip.p_W_m[0], input->tip.p_W_m[1], input->tip.p_W_m[2]};
  vec force = {0.0, 0.0, 0.0}, torque = {0.0, 0.0, 0.0};
  for (size_t i = 0; i < renderer->tool->vertex_count; ++i) {
    const double* const v = renderer->tool->vertices_m + 3 * i;
    const vec lever = turned(input->tip.q_WB, (vec){v[0], v[1], v[2]});
    const vec p = add(handle, lever);
    const vec p_B = turned(back, sub(p, origin));
    const struct foot foot = closest_of_mesh(&renderer->object, p_B);
    if (!(foot.above_m < 0.0)) continue;
    const vec out = turned(body->q_WB, sub(foot.point, p_B));
    const vec f = scaled(renderer->stiffness_N_per_m, out);
    force = add(force, f);
    torque = add(torque, cross(lever, f));
    result->contact = 1;
    if (result->contact_count < result->contact_capacity) {
      touchstone2_contact* const contact = &result->contacts[result->contact_count++];
      *contact = (touchstone2_contact){.body = 0};
      copy(p, contact->p_W_m);
      copy(scaled(1.0 / foot.distance_m, out), contact->n_W);
      copy(f, contact->f_W_N);
    }
  }
  copy(force, result->f_W_N);
  copy(torque, result->torque_W_Nm);
  return 0;
}

int touchstone2_reset(touchstone2_renderer* renderer) {
  (void)renderer; /* it remembers nothing */
  return 0;
}

void touchstone2_destroy(touchstone2_renderer* renderer) {
  if (renderer == NULL) return;
  mesh_free(&renderer->object);
  free(renderer);
}

const char* touchstone2_error(const touchstone2_renderer* renderer) { return renderer == NULL ? creation_error : ""; }

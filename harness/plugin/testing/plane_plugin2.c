/* A plug-in of version 2 that does one thing wrong, chosen by MISBEHAVE when it is compiled. Without it, a right one:
 * the plane z = 0 of body 0, below a point (F = k dx) and below the vertices of a tool (a spring each). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <touchstone/plugin2.h>

#define NOTHING_2 0
#define HAS_A_SHORT_DESCRIPTION 1
#define HAS_AN_UNKNOWN_TIP 2
#define HAS_A_NEGATIVE_EPSILON 3
#define WRITES_TOO_MANY_CONTACTS 4
#define RETURNS_NAN_TORQUE 5
#define CRASHES_IN_STEP_2 6
#define FAILS_WITH_A_REASON_2 7
#define RETURNS_A_NAN_CONTACT 8
#ifndef MISBEHAVE
#define MISBEHAVE NOTHING_2
#endif

enum { wrong_step = 5 };

struct touchstone2_renderer {
  double stiffness_N_per_m;
  const touchstone2_creation* creation;
  unsigned steps;
};

uint32_t touchstone_plugin_version(void) { return TOUCHSTONE_PLUGIN_VERSION_2; }

const touchstone2_description* touchstone2_describe(uint32_t index) {
  static const touchstone_parameter parameters[] = {{"stiffness_N_per_m", "N/m", 0.0, 1e6, 500.0, "k of F = k dx"}};
  static const touchstone_limitation limitations[] = {{"thin_shells", "it knows one plane only"}};
  static touchstone2_description descriptions[] = {
      {sizeof(touchstone2_description), TOUCHSTONE2_POINT, "plane-2", "the plane z = 0, F = k dx", "Hooke's law",
       parameters, 1, limitations, 1, 1e-9, 1e-3},
      {sizeof(touchstone2_description), TOUCHSTONE2_TOOL, "plane-tool-2", "the plane z = 0 below a tool's vertices",
       "Hooke's law", parameters, 1, limitations, 1, 0.0, 0.0}};
  if (MISBEHAVE == HAS_A_SHORT_DESCRIPTION) descriptions[0].size = 40;
  if (MISBEHAVE == HAS_AN_UNKNOWN_TIP) descriptions[0].tip_kind = 7;
  if (MISBEHAVE == HAS_A_NEGATIVE_EPSILON) descriptions[0].epsilon_m = -1.0;
  return index < 2 ? &descriptions[index] : NULL;
}

touchstone2_renderer* touchstone2_create(const touchstone2_creation* creation) {
  struct touchstone2_renderer* const made = calloc(1, sizeof *made);
  if (made == NULL) return NULL;
  made->stiffness_N_per_m = creation->parameters[0];
  made->creation = creation;
  return made;
}

int touchstone2_reset(touchstone2_renderer* renderer) {
  renderer->steps = 0;
  return 0;
}

static void rotate(const double q[4], const double v[3], double out[3]) {
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  out[0] = (1 - 2 * (y * y + z * z)) * v[0] + 2 * (x * y - w * z) * v[1] + 2 * (x * z + w * y) * v[2];
  out[1] = 2 * (x * y + w * z) * v[0] + (1 - 2 * (x * x + z * z)) * v[1] + 2 * (y * z - w * x) * v[2];
  out[2] = 2 * (x * z - w * y) * v[0] + 2 * (y * z + w * x) * v[1] + (1 - 2 * (x * x + y * y)) * v[2];
}

/* One spring at the vertex r (from the tip's origin, in W). */
static void push(touchstone2_renderer* renderer, const touchstone2_input* input, const double r[3],
                 touchstone2_result* result) {
  const double depth_m = input->bodies[0].p_W_m[2] - (input->tip.p_W_m[2] + r[2]);
  if (depth_m <= 0.0) return;
  const double f = renderer->stiffness_N_per_m * depth_m;
  result->contact = 1;
  result->f_W_N[2] += f;
  result->torque_W_Nm[0] += r[1] * f;
  result->torque_W_Nm[1] -= r[0] * f;
  if (result->contact_count < result->contact_capacity) {
    touchstone2_contact* const contact = &result->contacts[result->contact_count++];
    memset(contact, 0, sizeof *contact);
    for (int i = 0; i < 3; ++i) contact->p_W_m[i] = input->tip.p_W_m[i] + r[i];
    contact->n_W[2] = 1.0;
    contact->f_W_N[2] = f;
  }
}

int touchstone2_step(touchstone2_renderer* renderer, const touchstone2_input* input, touchstone2_result* result) {
  const touchstone2_tool* const tool = renderer->creation->tool;
  if (tool == NULL) {
    const double at[3] = {0.0, 0.0, 0.0};
    push(renderer, input, at, result);
    if (result->contact) {
      result->n_W[2] = 1.0;
      result->depth_m = -input->tip.p_W_m[2];
      result->proxy.p_W_m[2] = 0.0;
      memset(result->torque_W_Nm, 0, sizeof result->torque_W_Nm);
    }
  } else {
    for (size_t i = 0; i < tool->mesh.vertex_count; ++i) {
      double r[3];
      rotate(input->tip.q_WB, tool->mesh.vertices_m + 3 * i, r);
      push(renderer, input, r, result);
    }
  }
  if (++renderer->steps != wrong_step) return 0;
  if (MISBEHAVE == CRASHES_IN_STEP_2) abort();
  if (MISBEHAVE == WRITES_TOO_MANY_CONTACTS) result->contact_count = 1000000;
  if (MISBEHAVE == RETURNS_NAN_TORQUE) result->torque_W_Nm[1] = NAN;
  if (MISBEHAVE == RETURNS_A_NAN_CONTACT && result->contact_count > 0) result->contacts[0].f_W_N[2] = NAN;
  return MISBEHAVE == FAILS_WITH_A_REASON_2;
}

void touchstone2_destroy(touchstone2_renderer* renderer) { free(renderer); }

const char* touchstone2_error(const touchstone2_renderer* renderer) {
  return renderer == NULL ? "it does not want to be made" : "the solver did not converge";
}

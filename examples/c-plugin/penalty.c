/* A haptic renderer as a plug-in, in C: the force pulls the tip to the closest point of the surface, F = k dx (the
 * vector-field or penalty method that Zilles and Salisbury, IROS 1995, describe before their own). It remembers
 * nothing, so that a tip pushed past the middle of a thin body is pulled out on the other side: it says so in
 * `limitations`. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <touchstone/plugin.h>

#include "planted_fault.h"

typedef struct vec {
  double x, y, z;
} vec;

static vec add(vec a, vec b) { return (vec){a.x + b.x, a.y + b.y, a.z + b.z}; }
static vec sub(vec a, vec b) { return (vec){a.x - b.x, a.y - b.y, a.z - b.z}; }
static vec scaled(double s, vec a) { return (vec){s * a.x, s * a.y, s * a.z}; }
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b) { return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

struct touchstone_renderer {
  double stiffness_N_per_m;
  double tie_m; /* two distances that differ by less are equal but for rounding */
  size_t triangle_count;
  vec* corners; /* three per triangle */
  vec* normals; /* outward, unit length */
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
  made->triangle_count = creation->triangle_count;
  made->corners = malloc(3 * creation->triangle_count * sizeof *made->corners);
  made->normals = malloc(creation->triangle_count * sizeof *made->normals);
  if (creation->triangle_count == 0 || made->corners == NULL || made->normals == NULL) {
    creation_error = creation->triangle_count == 0 ? "the mesh has no triangles" : "out of memory";
    touchstone_destroy(made);
    return NULL;
  }
  double largest_m = 0.0;
  for (size_t i = 0; i < creation->triangle_count; ++i) {
    vec* const corner = made->corners + 3 * i;
    for (int j = 0; j < 3; ++j) {
      const double* const v = creation->vertices_W_m + 3 * (size_t)creation->triangles[3 * i + (size_t)j];
      corner[j] = (vec){v[0], v[1], v[2]};
      largest_m = fmax(largest_m, fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2]))));
    }
    const vec n = cross(sub(corner[1], corner[0]), sub(corner[2], corner[0]));
    const double length = sqrt(dot(n, n));
    /* A triangle without area has no normal; its neighbours have its points too. */
    made->normals[i] = length > 0.0 ? scaled(1.0 / length, n) : (vec){0.0, 0.0, 0.0};
  }
  made->tie_m = 64.0 * DBL_EPSILON * largest_m;
  return made;
}

/* The closest point of a triangle: Ericson, Real-Time Collision Detection (2005), section 5.1.5. */
static vec closest_of_triangle(const vec* corner, vec p) {
  const vec a = corner[0], b = corner[1], c = corner[2];
  const vec ab = sub(b, a), ac = sub(c, a), ap = sub(p, a);
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  const vec bp = sub(p, b);
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return add(a, scaled(d1 / (d1 - d3), ab));
  const vec cp = sub(p, c);
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return add(a, scaled(d2 / (d2 - d6), ac));
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) return add(b, scaled((d4 - d3) / ((d4 - d3) + (d5 - d6)), sub(c, b)));
  const double sum = va + vb + vc;
  return add(a, add(scaled(vb / sum, ab), scaled(vc / sum, ac)));
}

int touchstone_step(touchstone_renderer* renderer, const touchstone_tip* tip, touchstone_result* result) {
  const vec p = {tip->p_W_m[0], tip->p_W_m[1], tip->p_W_m[2]};
  vec closest = {0.0, 0.0, 0.0};
  double least_m = INFINITY; /* distance to the closest point */
  double above_m = 0.0;      /* height over the plane of its triangle: negative inside */
  size_t nearest = 0;
  for (size_t i = 0; i < renderer->triangle_count; ++i) {
    const vec point = closest_of_triangle(renderer->corners + 3 * i, p);
    const vec away = sub(p, point);
    const double distance_m = sqrt(dot(away, away));
    if (distance_m > least_m + renderer->tie_m) continue;
    /* On an edge or a corner several triangles are equally close: the one seen most from above knows the side. */
    const double height_m = dot(renderer->normals[i], away);
    if (distance_m < least_m - renderer->tie_m || fabs(height_m) > fabs(above_m)) {
      least_m = distance_m;
      above_m = height_m;
      closest = point;
      nearest = i;
    }
  }

  memset(result, 0, sizeof *result);
  memcpy(result->contact_W_m, tip->p_W_m, sizeof result->contact_W_m);
  if (above_m < 0.0) {
    const vec out = sub(closest, p); /* the way out, as long as the tip is deep */
    const vec n = scaled(1.0 / least_m, out);
    const vec f = scaled(renderer->stiffness_N_per_m, out);
    *result = (touchstone_result){{f.x, f.y, f.z}, {closest.x, closest.y, closest.z}, {n.x, n.y, n.z}, least_m, 1, 0};
  }
  const vec side = sub(renderer->corners[3 * nearest + 1], renderer->corners[3 * nearest]);
  plant_fault(&renderer->planted, tip, sqrt(dot(side, side)), result);
  return 0;
}

int touchstone_reset(touchstone_renderer* renderer) {
  memset(&renderer->planted, 0, sizeof renderer->planted);
  return 0;
}

void touchstone_destroy(touchstone_renderer* renderer) {
  if (renderer == NULL) return;
  free(renderer->corners);
  free(renderer->normals);
  free(renderer);
}

const char* touchstone_error(const touchstone_renderer* renderer) { return renderer == NULL ? creation_error : ""; }

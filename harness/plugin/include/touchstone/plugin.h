/* The plug-in interface of Touchstone: a haptic renderer as a shared library, in C (C99) and without dependencies.
 *
 * A plug-in exports the seven functions at the end of this file. Touchstone loads it with `--plugin libmine.so`, after
 * which model files may name its renderers. Each function is called by one thread at a time per renderer; different
 * renderers may be used by different threads. No C++ exception may leave a function.
 *
 * Units are SI: metres, newtons, seconds. Everything is in the frame of the object (the "world", W), in which the mesh
 * is given. q_WS turns vectors of the tip's frame S into W. Arrays that the plug-in receives belong to Touchstone.
 *
 * touchstone_step() is what a servo loop calls a thousand times a second: it allocates nothing, takes no lock, does no
 * input or output. touchstone_reset() makes the next step the first of a run; the same steps after it give the same
 * results to the bit. */
#ifndef TOUCHSTONE_PLUGIN_H
#define TOUCHSTONE_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface. It changes when a function or a structure does. */
#define TOUCHSTONE_PLUGIN_VERSION 1u

#if defined(_WIN32)
#define TOUCHSTONE_PLUGIN_EXPORT __declspec(dllexport)
#else
#define TOUCHSTONE_PLUGIN_EXPORT __attribute__((visibility("default")))
#endif

/* A parameter that a model file may set. One named "epsilon_m" states the length below which the renderer tells nothing
 * apart: contact points may be off by it, and forces by it times the stiffness. One named "lag_samples" states by how
 * many samples every answer may be late (an engine that renders in a thread of its own): the scorecard accuses it of no
 * more than what is later, and the conformance suite and golden cases wait for each answer. */
typedef struct touchstone_parameter {
  const char* name; /* with its unit: "stiffness_N_per_m" */
  const char* unit; /* "N/m"; "1" for a ratio. From it the tests know how the value changes with the unit of length */
  double minimum;   /* inclusive */
  double maximum;   /* inclusive */
  double initial;   /* where the model file does not set it */
  const char* meaning; /* one line */
} touchstone_parameter;

/* Something that the renderer cannot do: the tests that demand it are skipped with the reason shown. Whatever is not
 * declared is demanded. Abilities:
 *   "thin_shells"       a tip pushed through a thin shell from outside stays outside
 *   "large_jumps"       a tip that jumps through a body in one step stays on the side it came from
 *   "start_inside"      a run that starts inside is pushed out
 *   "continuous_force"  no jump of the force at first contact, on leaving, and across bends
 *   "rigid_motion"      moving and turning the whole world changes nothing
 *   "unit_scale"        nor does the unit of length
 *   "passive"           closed loops give no energy back beyond rounding
 *   "surface_contact"   the surface contact point lies on or above the surface
 *   "ball_tip"          renders a tip of finite radius */
typedef struct touchstone_limitation {
  const char* ability;
  const char* reason; /* one line */
} touchstone_limitation;

/* One kind of renderer that the plug-in has. Texts are UTF-8 and live as long as the library. */
typedef struct touchstone_description {
  /* Sizes as the plug-in was compiled; a plug-in built with another version of this file is found by them. Set them
   * with TOUCHSTONE_PLUGIN_SIZES. */
  uint32_t description_size, creation_size, tip_size, result_size;
  const char* name;    /* as model files spell it: "my-renderer"; not the name of a renderer that Touchstone has */
  const char* summary; /* one line */
  const char* source;  /* the publication that the algorithm follows */
  const touchstone_parameter* parameters;
  size_t parameter_count;
  const touchstone_limitation* limitations;
  size_t limitation_count;
} touchstone_description;

/* What a renderer is made of. */
typedef struct touchstone_creation {
  uint32_t index;    /* of the renderer's description */
  uint32_t reserved; /* 0 */
  const char*
      model_text; /* the model as JSON ("touchstone-model/1"), every parameter set; effects are not the plug-in's */
  const double*
      parameters; /* the same values in the order in which the description declares them, within their ranges */
  size_t parameter_count;
  const double* vertices_W_m; /* x, y, z of vertex 0, of vertex 1, ... */
  size_t vertex_count;
  const int32_t* triangles; /* three vertex indices each, counter-clockwise seen from outside */
  size_t triangle_count;
} touchstone_creation;

/* The tip at one servo tick. Always finite; t_s grows from step to step. */
typedef struct touchstone_tip {
  double t_s;
  double p_W_m[3]; /* the centre of the ball where the tip is a ball */
  double q_WS[4];  /* w, x, y, z; unit length */
} touchstone_tip;

/* The answer. All numbers must be finite. */
typedef struct touchstone_result {
  double f_W_N[3];       /* force on the probe by the object */
  double contact_W_m[3]; /* surface contact point (god-object); the tip itself when free. With a ball tip: its centre */
  double n_W[3];         /* outward unit normal of the contact; zero when free */
  double depth_m;        /* penetration along the force's normal part, >= 0 */
  int32_t contact;       /* 1 in contact, 0 free */
  int32_t reserved;      /* 0 */
} touchstone_result;

/* The plug-in's own. */
typedef struct touchstone_renderer touchstone_renderer;

/* For a designated or positional initialiser of touchstone_description: its first four members. */
#define TOUCHSTONE_PLUGIN_SIZES \
  sizeof(touchstone_description), sizeof(touchstone_creation), sizeof(touchstone_tip), sizeof(touchstone_result)

/* Returns TOUCHSTONE_PLUGIN_VERSION as the plug-in was compiled. */
TOUCHSTONE_PLUGIN_EXPORT uint32_t touchstone_plugin_version(void);

/* The description of renderer 0, 1, ...; NULL past the last. */
TOUCHSTONE_PLUGIN_EXPORT const touchstone_description* touchstone_describe(uint32_t index);

/* A renderer over the mesh, or NULL: touchstone_error(NULL) then says why. The mesh may be kept by pointer until
 * touchstone_destroy(); it must not be written to. */
TOUCHSTONE_PLUGIN_EXPORT touchstone_renderer* touchstone_create(const touchstone_creation* creation);

/* Forgets everything: the next step is the first one of a run. Also called before the first run. 0 when it went well,
 * else touchstone_error(renderer) says why. */
TOUCHSTONE_PLUGIN_EXPORT int touchstone_reset(touchstone_renderer* renderer);

/* One servo tick; fills all of `result`. 0 when it went well, else touchstone_error(renderer) says why. */
TOUCHSTONE_PLUGIN_EXPORT int touchstone_step(touchstone_renderer* renderer, const touchstone_tip* tip,
                                             touchstone_result* result);

TOUCHSTONE_PLUGIN_EXPORT void touchstone_destroy(touchstone_renderer* renderer);

/* Why the last call on the renderer failed; with NULL, why the last touchstone_create() of this thread did. Never NULL.
 * Lives until the next call. */
TOUCHSTONE_PLUGIN_EXPORT const char* touchstone_error(const touchstone_renderer* renderer);

#ifdef __cplusplus
}
#endif

#endif

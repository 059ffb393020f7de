/* Version 2 of the plug-in interface of Touchstone: renderers of points, balls and tools with a shape, as a shared
 * library, in C (C99) and without dependencies. Version 1 (<touchstone/plugin.h>) is taken as before; a plug-in of
 * points that needs nothing of what is new may stay with it. New here: torque and the tool's shape, the pose of the
 * proxy, the contacts one by one, bodies with a pose each, and lengths that the engine cannot tell apart.
 *
 * A plug-in exports the seven functions at the end of this file. Each is called by one thread at a time per renderer;
 * different renderers may be used by different threads. No C++ exception may leave a function.
 *
 * Structures grow at their end only, without a new version: the first member of each says how many bytes its maker
 * knows. What lies beyond that is not there.
 *
 * Units are SI: metres, newtons, newton metres, radians, seconds. W is the world's frame, B a body's, T the tip's (of a
 * tool: its origin is the handle, which the hand holds). A pose X_WB = (p, q) takes coordinates of B to W:
 * x_W = p + R(q) x_B, q = (w, x, y, z) of unit length. Forces and torques are on the tip by the bodies, in W; torques
 * are about the tip's origin (not the proxy's).
 *
 * touchstone2_step() is what a servo loop calls a thousand times a second: it allocates nothing, takes no lock, does no
 * input or output. touchstone2_reset() makes the next step the first of a run; the same steps after it give the same
 * results to the bit. */
#ifndef TOUCHSTONE_PLUGIN2_H
#define TOUCHSTONE_PLUGIN2_H

#include <touchstone/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TOUCHSTONE_PLUGIN_VERSION_2 2u

typedef struct touchstone2_pose {
  double p_W_m[3];
  double q_WB[4]; /* w, x, y, z; unit length */
} touchstone2_pose;

/* A closed mesh with outward orientation, unless the user gave an open one. */
typedef struct touchstone2_mesh {
  const double* vertices_m; /* x, y, z of vertex 0, of vertex 1, ..., in the mesh's own frame */
  size_t vertex_count;
  const int32_t* triangles; /* three vertex indices each, counter-clockwise seen from outside */
  size_t triangle_count;
} touchstone2_mesh;

/* A rigid body that can be touched. */
typedef struct touchstone2_body {
  uint32_t size;  /* sizeof(touchstone2_body) */
  uint32_t moves; /* 1 if its pose may change from step to step, else 0 */
  const char* name;
  touchstone2_mesh mesh; /* in B */
  touchstone2_pose pose; /* X_WB when the run begins */
} touchstone2_body;

/* A tool with a shape, behind a virtual coupling: the proxy is where the tool may be, the handle where the hand is, and
 * between them is a spring k_t (p_proxy - p_handle) and a torsional one k_r log(R_proxy R_handle^T). */
typedef struct touchstone2_tool {
  uint32_t size;         /* sizeof(touchstone2_tool) */
  uint32_t reserved;     /* 0 */
  touchstone2_mesh mesh; /* in T */
  double mass_kg;
  double center_T_m[3];                   /* of mass */
  double inertia_T_kg_m2[9];              /* about the centre of mass, axes of T, by rows */
  double stiffness_N_per_m;               /* k_t */
  double rotational_stiffness_Nm_per_rad; /* k_r */
} touchstone2_tool;

/* What a renderer renders. */
enum touchstone2_tip_kind {
  TOUCHSTONE2_POINT = 0, /* a point, or a ball whose radius is the parameter "tip_radius_m" */
  TOUCHSTONE2_TOOL = 1   /* a tool with a shape: the command `touchstone tool` */
};

/* One kind of renderer that the plug-in has. Texts are UTF-8 and live as long as the library. */
typedef struct touchstone2_description {
  uint32_t size;       /* sizeof(touchstone2_description) as the plug-in was compiled */
  uint32_t tip_kind;   /* enum touchstone2_tip_kind */
  const char* name;    /* as model files spell it: "my-renderer"; not the name of a renderer that Touchstone has */
  const char* summary; /* one line */
  const char* source;  /* the publication that the algorithm follows */
  const touchstone_parameter* parameters;
  size_t parameter_count;
  const touchstone_limitation*
      limitations; /* abilities: <touchstone/plugin.h>, several_bodies (without it: one object, at rest) */
  size_t limitation_count;
  /* Lengths below it are nothing to the renderer: contact points may be off by it, forces by it times the stiffness.
   * 0: none but rounding. */
  double epsilon_m;
  /* How long one unit of the engine's own world is: 0.001 if it counts millimetres. 0 is taken as 1. Said beside its
   * results; what the plug-in receives and answers is in metres whatever stands here. */
  double world_unit_m;
} touchstone2_description;

/* What a renderer is made of. All of it belongs to Touchstone and stays until touchstone2_destroy(). */
typedef struct touchstone2_creation {
  uint32_t size;  /* sizeof(touchstone2_creation) */
  uint32_t index; /* of the renderer's description */
  const char*
      model_text; /* the model as JSON ("touchstone-model/1"), every parameter set; effects are not the plug-in's */
  const double*
      parameters; /* the same values in the order in which the description declares them, within their ranges */
  size_t parameter_count;
  const touchstone2_body* bodies;
  size_t body_count;            /* at least 1 */
  const touchstone2_tool* tool; /* NULL for a point or ball */
} touchstone2_creation;

/* One servo tick. Always finite; t_s grows from step to step. */
typedef struct touchstone2_input {
  uint32_t size;     /* sizeof(touchstone2_input) */
  uint32_t reserved; /* 0 */
  double t_s;
  touchstone2_pose tip;           /* of a ball: its centre; of a tool: the handle */
  const touchstone2_pose* bodies; /* X_WB of each body now, in the order of the creation */
  size_t body_count;
} touchstone2_input;

/* One place where the tip's proxy touches a body. */
typedef struct touchstone2_contact {
  double p_W_m[3];
  double n_W[3];     /* unit, out of the body */
  double f_W_N[3];   /* on the tip */
  uint32_t body;     /* its place in the creation */
  uint32_t reserved; /* 0 */
} touchstone2_contact;

/* The answer. All numbers must be finite. Touchstone sets every member to zero but `size`, `contacts`,
 * `contact_capacity` and `proxy`, which is the tip itself. */
typedef struct touchstone2_result {
  uint32_t size;   /* sizeof(touchstone2_result) as the program knows it */
  int32_t contact; /* 1 in contact, 0 free */
  double f_W_N[3];
  double torque_W_Nm[3]; /* about the tip's origin; zero for a point or ball */
  /* Where the tip may be: of a point the surface contact point, of a ball its centre there, of a tool its pose. The tip
   * itself when free. */
  touchstone2_pose proxy;
  double n_W[3];                 /* point and ball: outward unit normal of the contact; zero when free */
  double depth_m;                /* point and ball: penetration along the force's normal part, >= 0 */
  touchstone2_contact* contacts; /* room for contact_capacity of them; in the same order for the same steps */
  size_t contact_capacity;       /* 0: nobody asks */
  size_t contact_count;          /* how many the plug-in wrote: at most contact_capacity */
} touchstone2_result;

/* The plug-in's own. */
typedef struct touchstone2_renderer touchstone2_renderer;

/* Returns TOUCHSTONE_PLUGIN_VERSION_2: declared in <touchstone/plugin.h>.
 * TOUCHSTONE_PLUGIN_EXPORT uint32_t touchstone_plugin_version(void); */

/* The description of renderer 0, 1, ...; NULL past the last. */
TOUCHSTONE_PLUGIN_EXPORT const touchstone2_description* touchstone2_describe(uint32_t index);

/* A renderer, or NULL: touchstone2_error(NULL) then says why. */
TOUCHSTONE_PLUGIN_EXPORT touchstone2_renderer* touchstone2_create(const touchstone2_creation* creation);

/* Forgets everything: the next step is the first one of a run. Also called before the first run. 0 when it went well,
 * else touchstone2_error(renderer) says why. */
TOUCHSTONE_PLUGIN_EXPORT int touchstone2_reset(touchstone2_renderer* renderer);

/* One servo tick. 0 when it went well, else touchstone2_error(renderer) says why. */
TOUCHSTONE_PLUGIN_EXPORT int touchstone2_step(touchstone2_renderer* renderer, const touchstone2_input* input,
                                              touchstone2_result* result);

TOUCHSTONE_PLUGIN_EXPORT void touchstone2_destroy(touchstone2_renderer* renderer);

/* Why the last call on the renderer failed; with NULL, why the last touchstone2_create() of this thread did. Never
 * NULL. Lives until the next call. */
TOUCHSTONE_PLUGIN_EXPORT const char* touchstone2_error(const touchstone2_renderer* renderer);

#ifdef __cplusplus
}
#endif

#endif

/* The Open Dynamics Engine as a renderer of a tool with a shape. Nothing of ODE is in this file or its folder: it is
 * linked with an ODE of your own (see CMakeLists.txt). Tried with Debian's libode-dev 0.16.2.
 *
 * ODE has rigid bodies, collision of triangle meshes and contact constraints, but no haptics. It becomes a haptic
 * renderer as CHAI3D's ODE module makes one: the tool is a body of ODE that a virtual coupling pulls to the handle, and
 * the hand feels that coupling (Colgate, Stanley and Brown 1995). Here the coupling is the one that the program gives,
 * with critical damping; the body's inertia is the coupling's stiffness divided by the square of kRate_per_s, in each
 * of its six directions about the handle, so that it follows within milliseconds and a step of a millisecond is stable
 * whatever the stiffness. Where it rests does not depend on it. */
#include <math.h>
#include <ode/ode.h>
#include <pthread.h>
#include <stdlib.h>
#include <touchstone/plugin2.h>

enum { kMostContacts = 64, kMostMoments = 250 };
static const double kRate_per_s = 200.0;
static const double kMoment_s = 1e-3; /* a fifth of 1 / kRate_per_s */
/* Meshes that meet face on face have contacts that stand twice, for which the hard equations of ODE are singular ("LCP
 * internal error"). With this much constraint force mixing a contact gives way by softness * force * kMoment_s / ERP:
 * 0.05 um a newton with ODE's ERP of 0.2. */
static const double kSoftness_m_per_Ns = 1e-5;

struct shape {
  double* vertices;
  dTriIndex* triangles;
  dTriMeshDataID data;
  dGeomID geom;
};

struct touchstone2_renderer {
  dWorldID world;
  dJointGroupID joints;
  dBodyID body;
  struct shape tool, object;
  double stiffness_N_per_m, rotational_stiffness_Nm_per_rad;
  double last_t_s;
  int placed;
};

static const char* creation_error = "";

uint32_t touchstone_plugin_version(void) { return TOUCHSTONE_PLUGIN_VERSION_2; }

const touchstone2_description* touchstone2_describe(uint32_t index) {
  static const touchstone_limitation limitations[] = {
      {"rigid_motion", "contacts of two meshes depend on which is which"},
  };
  static const touchstone2_description ode = {
      .size = sizeof(touchstone2_description),
      .tip_kind = TOUCHSTONE2_TOOL,
      .name = "ode-trimesh",
      .summary = "a rigid body of ODE behind a virtual coupling, contacts of triangle meshes",
      .source = "Colgate, Stanley and Brown 1995 with the contact solver of ODE 0.16 (dWorldStep)",
      .limitations = limitations,
      .limitation_count = sizeof limitations / sizeof limitations[0],
      .epsilon_m = 1e-4,
      .world_unit_m = 1.0,
  };
  return index == 0 ? &ode : NULL;
}

static int make_shape(struct shape* shape, const touchstone2_mesh* mesh) {
  shape->vertices = malloc(3 * mesh->vertex_count * sizeof *shape->vertices);
  shape->triangles = malloc(3 * mesh->triangle_count * sizeof *shape->triangles);
  if (shape->vertices == NULL || shape->triangles == NULL) return 0;
  for (size_t i = 0; i < 3 * mesh->vertex_count; ++i) shape->vertices[i] = mesh->vertices_m[i];
  for (size_t i = 0; i < 3 * mesh->triangle_count; ++i) shape->triangles[i] = (dTriIndex)mesh->triangles[i];
  shape->data = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(shape->data, shape->vertices, 3 * sizeof *shape->vertices, (int)mesh->vertex_count,
                              shape->triangles, (int)(3 * mesh->triangle_count), 3 * sizeof *shape->triangles);
  shape->geom = dCreateTriMesh(NULL, shape->data, NULL, NULL, NULL);
  return 1;
}

static void free_shape(struct shape* shape) {
  if (shape->geom != NULL) dGeomDestroy(shape->geom);
  if (shape->data != NULL) dGeomTriMeshDataDestroy(shape->data);
  free(shape->vertices);
  free(shape->triangles);
}

static void init_ode(void) { dInitODE2(0); }

touchstone2_renderer* touchstone2_create(const touchstone2_creation* creation) {
  static pthread_once_t once = PTHREAD_ONCE_INIT;
  if (creation->tool == NULL || creation->body_count != 1) {
    creation_error = "one tool and one body were expected";
    return NULL;
  }
  pthread_once(&once, init_ode);
  dAllocateODEDataForThread(dAllocateMaskAll);
  touchstone2_renderer* const made = calloc(1, sizeof *made);
  if (made == NULL || !make_shape(&made->tool, &creation->tool->mesh) ||
      !make_shape(&made->object, &creation->bodies[0].mesh)) {
    creation_error = "out of memory";
    touchstone2_destroy(made);
    return NULL;
  }
  made->stiffness_N_per_m = creation->tool->stiffness_N_per_m;
  made->rotational_stiffness_Nm_per_rad = creation->tool->rotational_stiffness_Nm_per_rad;
  made->world = dWorldCreate();
  made->joints = dJointGroupCreate(0);
  made->body = dBodyCreate(made->world);
  const double square = kRate_per_s * kRate_per_s;
  const double inertia = made->rotational_stiffness_Nm_per_rad / square;
  dMass mass;
  dMassSetParameters(&mass, made->stiffness_N_per_m / square, 0, 0, 0, inertia, inertia, inertia, 0, 0, 0);
  dBodySetMass(made->body, &mass);
  dBodySetGyroscopicMode(made->body, 0);
  dGeomSetBody(made->tool.geom, made->body);
  return made;
}

static void place(touchstone2_renderer* renderer, const touchstone2_pose* pose) {
  dBodySetPosition(renderer->body, pose->p_W_m[0], pose->p_W_m[1], pose->p_W_m[2]);
  dBodySetQuaternion(renderer->body, (dQuaternion){pose->q_WB[0], pose->q_WB[1], pose->q_WB[2], pose->q_WB[3]});
  dBodySetLinearVel(renderer->body, 0, 0, 0);
  dBodySetAngularVel(renderer->body, 0, 0, 0);
}

/* From the body to the handle: the way, and the rotation vector of R_handle R_body^T. */
static void apart(dBodyID body, const touchstone2_pose* handle, double* way, double* turn) {
  const dReal* const p = dBodyGetPosition(body);
  const dReal* const q = dBodyGetQuaternion(body);
  const double* const h = handle->q_WB;
  for (int k = 0; k < 3; ++k) way[k] = handle->p_W_m[k] - p[k];
  const double w = h[0] * q[0] + h[1] * q[1] + h[2] * q[2] + h[3] * q[3];
  const double v[3] = {-h[0] * q[1] + h[1] * q[0] - h[2] * q[3] + h[3] * q[2],
                       -h[0] * q[2] + h[2] * q[0] - h[3] * q[1] + h[1] * q[3],
                       -h[0] * q[3] + h[3] * q[0] - h[1] * q[2] + h[2] * q[1]};
  const double sine = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  const double scale = sine == 0.0 ? 0.0 : (w < 0.0 ? -2.0 : 2.0) * atan2(sine, fabs(w)) / sine;
  for (int k = 0; k < 3; ++k) turn[k] = scale * v[k];
}

static void pull(touchstone2_renderer* renderer, const touchstone2_pose* handle) {
  double way[3], turn[3];
  apart(renderer->body, handle, way, turn);
  const dReal* const v = dBodyGetLinearVel(renderer->body);
  const dReal* const w = dBodyGetAngularVel(renderer->body);
  const double k_t = renderer->stiffness_N_per_m, k_r = renderer->rotational_stiffness_Nm_per_rad;
  const double b = 2.0 / kRate_per_s; /* critical: 2 sqrt(k m), m = k / rate^2 */
  dBodyAddForce(renderer->body, k_t * (way[0] - b * v[0]), k_t * (way[1] - b * v[1]), k_t * (way[2] - b * v[2]));
  dBodyAddTorque(renderer->body, k_r * (turn[0] - b * w[0]), k_r * (turn[1] - b * w[1]), k_r * (turn[2] - b * w[2]));
}

/* What touched while the body moved last. */
struct touch {
  dContactGeom found[kMostContacts];
  dJointFeedback feedback[kMostContacts];
  int count;
};

/* How many moments of at most kMoment_s a step is divided into: the coupling is integrated explicitly, and over a gap
 * in the samples the body would be thrown (0.16 m, for 0.2 s and 0.1 mm). After kMostMoments it rests, by exp(-50): a
 * longer gap takes no more of them. */
static int moments_between(double from_s, double to_s) {
  const double moments = ceil((to_s - from_s) / kMoment_s - 1e-6);
  return moments < 1.0 ? 1 : moments > kMostMoments ? kMostMoments : (int)moments;
}

static void move(touchstone2_renderer* renderer, const touchstone2_pose* handle, double moment_s, struct touch* touch) {
  touch->count =
      dCollide(renderer->tool.geom, renderer->object.geom, kMostContacts, touch->found, sizeof touch->found[0]);
  for (int i = 0; i < touch->count; ++i) {
    dContact contact = {0};
    contact.surface.mode = dContactApprox0 | dContactSoftCFM;
    contact.surface.soft_cfm = kSoftness_m_per_Ns;
    contact.geom = touch->found[i];
    const dJointID joint = dJointCreateContact(renderer->world, renderer->joints, &contact);
    dJointAttach(joint, renderer->body, NULL);
    dJointSetFeedback(joint, &touch->feedback[i]);
  }
  pull(renderer, handle);
  dWorldStep(renderer->world, moment_s);
  dJointGroupEmpty(renderer->joints);
}

int touchstone2_step(touchstone2_renderer* renderer, const touchstone2_input* input, touchstone2_result* result) {
  const touchstone2_pose* const object = &input->bodies[0];
  dGeomSetPosition(renderer->object.geom, object->p_W_m[0], object->p_W_m[1], object->p_W_m[2]);
  dGeomSetQuaternion(renderer->object.geom,
                     (dQuaternion){object->q_WB[0], object->q_WB[1], object->q_WB[2], object->q_WB[3]});
  if (!renderer->placed) {
    place(renderer, &input->tip);
    renderer->placed = 1;
    renderer->last_t_s = input->t_s;
    return 0;
  }
  struct touch touch;
  const int moments = moments_between(renderer->last_t_s, input->t_s);
  const double moment_s = fmin((input->t_s - renderer->last_t_s) / moments, kMoment_s);
  for (int i = 0; i < moments; ++i) move(renderer, &input->tip, moment_s, &touch);
  renderer->last_t_s = input->t_s;
  const dReal* const p = dBodyGetPosition(renderer->body);
  const dReal* const q = dBodyGetQuaternion(renderer->body);
  for (int k = 0; k < 3; ++k) result->proxy.p_W_m[k] = p[k];
  for (int k = 0; k < 4; ++k) result->proxy.q_WB[k] = q[k];
  if (touch.count == 0) return 0;
  result->contact = 1;
  double way[3], turn[3];
  apart(renderer->body, &input->tip, way, turn);
  for (int k = 0; k < 3; ++k) {
    result->f_W_N[k] = -renderer->stiffness_N_per_m * way[k];
    result->torque_W_Nm[k] = -renderer->rotational_stiffness_Nm_per_rad * turn[k];
  }
  for (int i = 0; i < touch.count && result->contact_count < result->contact_capacity; ++i) {
    touchstone2_contact* const contact = &result->contacts[result->contact_count++];
    *contact = (touchstone2_contact){.body = 0};
    for (int k = 0; k < 3; ++k) {
      contact->p_W_m[k] = touch.found[i].pos[k];
      contact->n_W[k] = touch.found[i].normal[k]; /* into the first geometry: the tool */
      contact->f_W_N[k] = touch.feedback[i].f1[k];
    }
  }
  return 0;
}

int touchstone2_reset(touchstone2_renderer* renderer) {
  renderer->placed = 0;
  return 0;
}

void touchstone2_destroy(touchstone2_renderer* renderer) {
  if (renderer == NULL) return;
  free_shape(&renderer->tool);
  free_shape(&renderer->object);
  if (renderer->joints != NULL) dJointGroupDestroy(renderer->joints);
  if (renderer->world != NULL) dWorldDestroy(renderer->world);
  free(renderer);
}

const char* touchstone2_error(const touchstone2_renderer* renderer) { return renderer == NULL ? creation_error : ""; }

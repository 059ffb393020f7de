/* A plug-in that does one thing wrong, chosen by MISBEHAVE when it is compiled. Without it, a right one: the plane z =
 * 0 below a point, F = k dx. Each wrong thing is one that a program must survive and report. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <touchstone/plugin.h>
#include <unistd.h>

#define NOTHING 0
#define CRASHES_IN_STEP 1
#define HANGS_IN_STEP 2
#define RETURNS_NAN 3
#define CRASHES_IN_CREATE 4
#define FOLLOWS_ANOTHER_VERSION 5
#define LIES_ABOUT_ITS_VERSION 6
#define LACKS_A_FUNCTION 7
#define CRASHES_WHEN_LOADED 8
#define FAILS_WITH_A_REASON 9
#define WRITES_TO_THE_MESH 10
#define EXITS 11
#define HANGS_WHEN_DESCRIBED 12
#define REFUSES_TO_BE_MADE 13
#define DESCRIBES_NONSENSE 14
#define PRINTS 15
#define CRASHES_WHEN_RUN_AGAIN 16
#ifndef MISBEHAVE
#define MISBEHAVE NOTHING
#endif

/* Long enough that a step in which it goes wrong is not the first. */
enum { wrong_step = 5 };

struct touchstone_renderer {
  double stiffness_N_per_m;
  unsigned steps;
  const double* vertices_W_m;
};

static void crash(void) { abort(); }

static void hang(void) {
  for (;;) sleep(1);
}

uint32_t touchstone_plugin_version(void) {
  return MISBEHAVE == FOLLOWS_ANOTHER_VERSION ? TOUCHSTONE_PLUGIN_VERSION + 98u : TOUCHSTONE_PLUGIN_VERSION;
}

const touchstone_description* touchstone_describe(uint32_t index) {
  static const touchstone_parameter parameters[] = {
      {"stiffness_N_per_m", "N/m", MISBEHAVE == DESCRIBES_NONSENSE ? 1e9 : 0.0, 1e6, 500.0, "k of F = k dx"}};
  static const touchstone_limitation limitations[] = {{"thin_shells", "it knows one plane only"}};
  static touchstone_description description = {
      TOUCHSTONE_PLUGIN_SIZES, "plane", "the plane z = 0, F = k dx", "Hooke's law", parameters, 1, limitations, 1};
  if (MISBEHAVE == HANGS_WHEN_DESCRIBED) hang();
  if (MISBEHAVE == LIES_ABOUT_ITS_VERSION) description.result_size = 24;
  return index == 0 ? &description : NULL;
}

touchstone_renderer* touchstone_create(const touchstone_creation* creation) {
  if (MISBEHAVE == REFUSES_TO_BE_MADE) return NULL;
  if (MISBEHAVE == CRASHES_IN_CREATE) crash();
  if (MISBEHAVE == PRINTS) puts("a word on standard output");
  struct touchstone_renderer* const made = malloc(sizeof *made);
  if (made == NULL) return NULL;
  made->stiffness_N_per_m = creation->parameters[0];
  made->steps = 0;
  made->vertices_W_m = creation->vertices_W_m;
  return made;
}

int touchstone_reset(touchstone_renderer* renderer) {
  renderer->steps = 0;
  return 0;
}

#if MISBEHAVE != LACKS_A_FUNCTION
int touchstone_step(touchstone_renderer* renderer, const touchstone_tip* tip, touchstone_result* result) {
  const double depth_m = -tip->p_W_m[2];
  memset(result, 0, sizeof *result);
  memcpy(result->contact_W_m, tip->p_W_m, sizeof result->contact_W_m);
  if (depth_m > 0.0) {
    result->contact = 1;
    result->n_W[2] = 1.0;
    result->depth_m = depth_m;
    result->f_W_N[2] = renderer->stiffness_N_per_m * depth_m;
    result->contact_W_m[2] = 0.0;
  }
  if (++renderer->steps != wrong_step) return 0;
  if (MISBEHAVE == CRASHES_IN_STEP) crash();
  if (MISBEHAVE == HANGS_IN_STEP) hang();
  if (MISBEHAVE == RETURNS_NAN) result->f_W_N[1] = NAN;
  /* Around `const`, as a plug-in must not. NOLINTNEXTLINE(performance-no-int-to-ptr) */
  if (MISBEHAVE == WRITES_TO_THE_MESH) *(double*)(uintptr_t)renderer->vertices_W_m = 0.0;
  if (MISBEHAVE == EXITS) exit(7);
  if (MISBEHAVE == CRASHES_WHEN_RUN_AGAIN) {
    FILE* const mark = fopen("ran-once", "wx"); /* fails if it is there */
    if (mark == NULL) crash();
    fclose(mark);
  }
  return MISBEHAVE == FAILS_WITH_A_REASON;
}
#endif

void touchstone_destroy(touchstone_renderer* renderer) { free(renderer); }

const char* touchstone_error(const touchstone_renderer* renderer) {
  return renderer == NULL ? "it does not want to be made" : "the solver did not converge";
}

#if MISBEHAVE == CRASHES_WHEN_LOADED
__attribute__((constructor)) static void at_load(void) { crash(); }
#endif

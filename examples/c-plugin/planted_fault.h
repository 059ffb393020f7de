/* Faults for the example's renderer, to see which tests catch them: build with -DPLANTED_FAULT=WRONG_SIGN and so on. A
 * renderer of your own does not need this file. */
#ifndef PLANTED_FAULT_H
#define PLANTED_FAULT_H

#include <stdlib.h>
#include <touchstone/plugin.h>

#define NO_FAULT 0
#define WRONG_SIGN 1            /* the force pulls inward */
#define STIFFNESS_ONE_PERCENT 2 /* too high */
#define ONE_SAMPLE_DELAY 3      /* answers what was right a step ago */
#define OUTSIDE_FRICTION_CONE 4 /* a tangential force although there is no friction */
#define ALLOCATES_IN_STEP 5
#define DEPENDS_ON_UNIT 6       /* an absolute epsilon: contact begins at 10 micrometres, whatever the unit */
#define TURNS_WITH_THE_TIP 7    /* the force is given in the tip's frame */
#define LOSES_SMALL_TRIANGLES 8 /* no contact with triangles below 10 micrometres */
#define SHARES_ITS_MEMORY 9     /* the last depth is kept for all renderers of the process, not for each */
#define COSTS_MORE_EVERY_STEP 10
#define SPIKES_LATE 11 /* step 1,000,000 takes a millisecond */
#ifndef PLANTED_FAULT
#define PLANTED_FAULT NO_FAULT
#endif

struct planted_memory {
  touchstone_result last;
  int steps;
};

/* Work that the compiler cannot leave out. */
static void planted_work(int additions) {
  volatile double sum = 0.0;
  for (int i = 0; i < additions; ++i) sum = sum + 1.0;
}

/* `size_m` is that of the triangle touched. */
static void plant_fault(struct planted_memory* memory, const touchstone_tip* tip, double size_m,
                        touchstone_result* result) {
  const touchstone_result right = *result;
  /* Not every fault needs them. NOLINTNEXTLINE(clang-analyzer-deadcode.DeadStores) */
  double* const f = result->f_W_N;
  const double* const n = result->n_W; /* NOLINT(clang-analyzer-deadcode.DeadStores) */
  if (PLANTED_FAULT == WRONG_SIGN) {
    for (int i = 0; i < 3; ++i) f[i] = -f[i];
  }
  if (PLANTED_FAULT == STIFFNESS_ONE_PERCENT) {
    for (int i = 0; i < 3; ++i) f[i] *= 1.01;
  }
  if (PLANTED_FAULT == ONE_SAMPLE_DELAY && memory->steps > 0) {
    *result = memory->last;
    if (!result->contact) {
      for (int i = 0; i < 3; ++i) result->contact_W_m[i] = tip->p_W_m[i];
    }
  }
  if (PLANTED_FAULT == OUTSIDE_FRICTION_CONE && result->contact) {
    /* A tenth of the force, across the normal and x. */
    const double strength_N = 0.1 * (f[0] * n[0] + f[1] * n[1] + f[2] * n[2]);
    f[1] += strength_N * n[2];
    f[2] -= strength_N * n[1];
  }
  if (PLANTED_FAULT == ALLOCATES_IN_STEP) {
    void* volatile memory_of_step = malloc(16);
    free(memory_of_step);
  }
  if (PLANTED_FAULT == TURNS_WITH_THE_TIP) {
    /* v + 2 w (u x v) + 2 u x (u x v) of the quaternion (w, u). */
    const double* const q = tip->q_WS;
    const double c[3] = {q[2] * f[2] - q[3] * f[1], q[3] * f[0] - q[1] * f[2], q[1] * f[1] - q[2] * f[0]};
    f[0] += 2.0 * (q[0] * c[0] + q[2] * c[2] - q[3] * c[1]);
    f[1] += 2.0 * (q[0] * c[1] + q[3] * c[0] - q[1] * c[2]);
    f[2] += 2.0 * (q[0] * c[2] + q[1] * c[1] - q[2] * c[0]);
  }
  if (PLANTED_FAULT == SHARES_ITS_MEMORY) {
    static double last_depth_m = 0.0;
    /* A damper, between the depths of two renderers. */
    for (int i = 0; i < 3; ++i) f[i] += 10.0 * (result->depth_m - last_depth_m) * n[i];
    last_depth_m = result->depth_m;
  }
  if (PLANTED_FAULT == COSTS_MORE_EVERY_STEP) planted_work(memory->steps / 50);
  if (PLANTED_FAULT == SPIKES_LATE && memory->steps == 1000000) planted_work(2000000);
  const int lost = (PLANTED_FAULT == DEPENDS_ON_UNIT && result->depth_m < 1e-5) ||
                   (PLANTED_FAULT == LOSES_SMALL_TRIANGLES && size_m < 1e-5);
  if (lost && result->contact) {
    const touchstone_result free_space = {
        {0.0, 0.0, 0.0}, {tip->p_W_m[0], tip->p_W_m[1], tip->p_W_m[2]}, {0.0, 0.0, 0.0}, 0.0, 0, 0};
    *result = free_space;
  }
  memory->last = right;
  ++memory->steps;
}

#endif

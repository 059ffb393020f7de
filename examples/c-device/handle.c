/* A haptic device behind <touchstone/device.h>: here an emulated one, a handle of 0.1 kg in a damped hand that moves it
 * up and down through the plane z = 0, integrated in steps of 0.1 ms over real time. `settings`: "press" (default) moves
 * along z, "slide" along x as well. For a device of your own replace what is between open_device() and exchange().
 *
 * Physics: a mass on a spring and a damper whose other end moves as the hand means it to; 300 N/m is in the range of a
 * fingertip (Hajian and Howe, J. Biomech. Eng. 119, 1997), with 0.55 of critical damping. */
#define _POSIX_C_SOURCE 199309L /* clock_gettime */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <touchstone/device.h>

struct handle {
  double start_s, last_s;
  double p_m[3], v_m_per_s[3], f_N[3];
  int slides;
};

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Where the hand means the handle to be, t seconds after it was opened: 4 mm above and below the plane. */
static void aim(const struct handle* h, double t, double p_m[3]) {
  p_m[0] = h->slides ? 0.02 * sin(2.0 * t) : 0.001;
  p_m[1] = 0.002;
  p_m[2] = 0.004 * cos(5.0 * t);
}

static void* open_device(const char* settings, char* message, size_t message_size) {
  struct handle* h;
  if (strcmp(settings, "") != 0 && strcmp(settings, "press") != 0 && strcmp(settings, "slide") != 0) {
    snprintf(message, message_size, "settings \"%.40s\": \"press\" or \"slide\" was expected", settings);
    return NULL;
  }
  h = calloc(1, sizeof *h);
  if (h == NULL) {
    snprintf(message, message_size, "no memory");
    return NULL;
  }
  h->slides = strcmp(settings, "slide") == 0;
  h->start_s = h->last_s = now_s();
  aim(h, 0.0, h->p_m);
  return h;
}

/* The handle's motion up to now under the force that was commanded last. */
static void advance(struct handle* h) {
  const double mass_kg = 0.1, stiffness_N_per_m = 300.0, damping_N_s_per_m = 6.0, step_s = 1e-4, longest_s = 0.1;
  const double now = now_s();
  int k;
  if (now - h->last_s > longest_s) h->last_s = now - longest_s; /* nobody asked for a while: it stood still */
  for (; h->last_s + step_s <= now; h->last_s += step_s) {
    double aim_m[3];
    aim(h, h->last_s - h->start_s, aim_m);
    for (k = 0; k < 3; ++k) {
      const double f = h->f_N[k] + stiffness_N_per_m * (aim_m[k] - h->p_m[k]) - damping_N_s_per_m * h->v_m_per_s[k];
      h->v_m_per_s[k] += step_s / mass_kg * f;
      h->p_m[k] += step_s * h->v_m_per_s[k];
    }
  }
}

static int exchange(void* device, const double f_W_N[3], double timeout_s, touchstone_device_state* state,
                    char* message, size_t message_size) {
  struct handle* h = device;
  (void)timeout_s, (void)message, (void)message_size;
  advance(h);
  memcpy(h->f_N, f_W_N, sizeof h->f_N);
  state->age_s = 0.0;
  memcpy(state->p_W_m, h->p_m, sizeof h->p_m);
  memcpy(state->v_W_m_per_s, h->v_m_per_s, sizeof h->v_m_per_s);
  state->buttons = 0;
  state->motor_temperature_C = NAN;
  return 0;
}

static int zero_force(void* device) {
  struct handle* h = device;
  advance(h);
  memset(h->f_N, 0, sizeof h->f_N);
  return 0;
}

static void close_device(void* device) { free(device); }

static const char* serial(void* device) { return ((struct handle*)device)->slides ? "SLIDE" : "PRESS"; }

static int calibrated(void* device) {
  (void)device;
  return 1;
}

static double watchdog_s(void* device) {
  (void)device;
  return 0.0;
}

TOUCHSTONE_DEVICE_EXPORT const touchstone_device_functions* touchstone_device(uint32_t version) {
  static const touchstone_device_functions functions = {
      TOUCHSTONE_DEVICE_VERSION, "emulated-handle", 1,    open_device, close_device, serial,
      exchange,                  zero_force,        NULL, calibrated,  watchdog_s};
  return version == TOUCHSTONE_DEVICE_VERSION ? &functions : NULL;
}

/* A device plug-in that does one thing wrong, chosen by MISBEHAVE when it is compiled. Each wrong thing is one that a
 * program must survive and report. */
#define _POSIX_C_SOURCE 200112L /* getppid */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <touchstone/device.h>
#include <unistd.h>

#define FOLLOWS_ANOTHER_VERSION 1
#define LACKS_ZERO_FORCE 2
#define OPENS_NOTHING_AND_IS_SILENT 3
#define CRASHES_IN_EXCHANGE 4
#define FAILS_IN_EXCHANGE 5
#define RETURNS_NAN 6
#define RUNS_AWAY 7

static int opened;

static void* open_device(const char* settings, char* message, size_t message_size) {
  (void)settings, (void)message, (void)message_size;
  return MISBEHAVE == OPENS_NOTHING_AND_IS_SILENT ? NULL : &opened;
}

static void close_device(void* device) { (void)device; }

/* One of its own for each guard, so that tests beside one another have devices of their own. */
static const char* serial(void* device) {
  static char text[32];
  (void)device;
  snprintf(text, sizeof text, "WRONG-%ld", (long)getppid());
  return text;
}

static int exchange(void* device, const double f_W_N[3], double timeout_s, touchstone_device_state* state,
                    char* message, size_t message_size) {
  const int pushed = f_W_N[0] != 0.0 || f_W_N[1] != 0.0 || f_W_N[2] != 0.0;
  int k;
  (void)device, (void)timeout_s;
  if (pushed && MISBEHAVE == CRASHES_IN_EXCHANGE) abort();
  if (pushed && MISBEHAVE == FAILS_IN_EXCHANGE) {
    for (k = 0; k < 8 && (size_t)k + 1 < message_size; ++k) message[k] = "no power"[k];
    message[k] = '\0';
    return 1;
  }
  state->age_s = 0.0;
  for (k = 0; k < 3; ++k) {
    state->p_W_m[k] = pushed && MISBEHAVE == RETURNS_NAN ? NAN : 0.0;
    /* Along the force, as fast as the speed limit allows: an active environment. */
    state->v_W_m_per_s[k] = pushed && MISBEHAVE == RUNS_AWAY ? 0.9 * (f_W_N[k] > 0.0) : 0.0;
  }
  state->buttons = 0;
  state->motor_temperature_C = NAN;
  return 0;
}

static int zero_force(void* device) {
  (void)device;
  return 0;
}

static int calibrated(void* device) {
  (void)device;
  return 1;
}

static double watchdog_s(void* device) {
  (void)device;
  return 0.0;
}

const touchstone_device_functions* touchstone_device(uint32_t version) {
  static const touchstone_device_functions functions = {
      TOUCHSTONE_DEVICE_VERSION + (MISBEHAVE == FOLLOWS_ANOTHER_VERSION),
      "misbehaving",
      1,
      open_device,
      close_device,
      serial,
      exchange,
      MISBEHAVE == LACKS_ZERO_FORCE ? NULL : zero_force,
      NULL,
      calibrated,
      watchdog_s};
  (void)version;
  return &functions;
}

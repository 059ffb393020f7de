/* The device interface of Touchstone: a haptic device as a shared library, in C (C99) and without dependencies.
 *
 * A library exports touchstone_device(), which returns a table of functions. Touchstone loads it with
 * `touchstone hil render --device-plugin ./libmine.so`. It runs in a process of its own behind the guard
 * (docs/how-to/lab.md), which holds the limits of force, speed, workspace, power and energy: a call that blocks or
 * crashes costs that process only. Each function is called by one thread at a time. No C++ exception may leave one.
 *
 * Units are SI: metres, newtons, seconds. Positions are those of the handle's tip, forces act on the hand; both are in
 * the device's frame W. The library may be opened more than once, also in two processes at the same time: the guard's
 * rescuer opens the device anew if the first process blocks. */
#ifndef TOUCHSTONE_DEVICE_H
#define TOUCHSTONE_DEVICE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface. It changes when a function or a structure does. */
#define TOUCHSTONE_DEVICE_VERSION 1u

#if defined(_WIN32)
#define TOUCHSTONE_DEVICE_EXPORT __declspec(dllexport)
#else
#define TOUCHSTONE_DEVICE_EXPORT __attribute__((visibility("default")))
#endif

typedef struct touchstone_device_state {
  double age_s;               /* how old the state is when the call returns; 0 if it is fresh */
  double p_W_m[3];            /* position of the tip */
  double v_W_m_per_s[3];      /* its velocity */
  uint32_t buttons;           /* bit n: button n is down */
  double motor_temperature_C; /* of the hottest motor; NaN if the device does not say */
} touchstone_device_state;

/* Functions that return int return 0 for success. `message` takes a text for the user that ends in 0 and has at most
 * message_size bytes. Only motors_off may be NULL. */
typedef struct touchstone_device_functions {
  uint32_t version; /* TOUCHSTONE_DEVICE_VERSION */
  const char* name; /* of the kind of device: "my-device" */
  int emulated;     /* not 0: no hardware behind it; every result says so */

  /* Opens the device and leaves it at zero force. `settings` is the user's text. NULL for failure, with a message. */
  void* (*open)(const char* settings, char* message, size_t message_size);
  /* Zero force first; then everything is released. */
  void (*close)(void* device);
  /* Tells this device from others of the same name: one run at a time has it. */
  const char* (*serial)(void* device);
  /* One servo exchange, within timeout_s: commands the force on the hand and reads the state. */
  int (*exchange)(void* device, const double f_W_N[3], double timeout_s, touchstone_device_state* state, char* message,
                  size_t message_size);
  /* From any state: zero force. 0 only if the device confirmed it; else it is called again, until it does. */
  int (*zero_force)(void* device);
  /* The amplifiers off, after zero was confirmed or could not be. NULL if the device cannot. */
  int (*motors_off)(void* device);
  /* Not 0 once position and force are trustworthy (homed, calibrated). No force is commanded before. */
  int (*calibrated)(void* device);
  /* After this long without an exchange the device itself lets go; 0: it has no watchdog. */
  double (*watchdog_s)(void* device);
} touchstone_device_functions;

/* The table for this version of the interface; NULL if the library does not have it. It lives as long as the library.
 */
TOUCHSTONE_DEVICE_EXPORT const touchstone_device_functions* touchstone_device(uint32_t version);

#ifdef __cplusplus
}
#endif

#endif

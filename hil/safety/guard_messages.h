// Messages between the processes of a guard: plain structs over local SEQPACKET sockets between processes of one
// program, so that a message comes whole or not at all.
#pragma once

#include <algorithm>
#include <string_view>

#include "devices/interfaces.h"
#include "safety/force_supervisor.h"

namespace touchstone::hil {

// With its closing zero. Paths and what a vendor's library says make messages long.
inline constexpr std::size_t longest_message = 1024;

struct GuardHello {
  int status = 0;  // DeviceStatus
  int calibrated = 0;
  int emulated = 0;
  int advised = 0;  // the message ends with what to do
  double watchdog_s = 0.0;
  char message[longest_message] = {};
  char id[64] = {}, serial[64] = {}, firmware[96] = {}, calibration[160] = {};
};

enum class GuardAsk : int { exchange, zero, motors_off, end };

struct GuardRequest {
  GuardAsk ask = GuardAsk::exchange;
  unsigned number = 0;  // of the request; its reply carries it, so that a late reply is not confused with another's
  double f_N[3] = {};
};

struct GuardReply {
  int status = 0;  // DeviceStatus of the exchange
  unsigned number = 0;
  int calibrated = 0;
  int confirmed = 0;  // zero, or motors off
  int advised = 0;    // as in GuardHello
  Trip trip = Trip::none;
  double t_s = 0.0, p_m[3] = {}, v_m_per_s[3] = {}, temperature_C = 0.0, allowed_N[3] = {};
  unsigned buttons = 0;
  char message[longest_message] = {};
};

template <std::size_t n>
void copy_text(char (&to)[n], std::string_view from) {
  const std::size_t size = std::min(n - 1, from.size());
  std::copy_n(from.data(), size, to);
  to[size] = '\0';
}

// Of a message that is too long still, the middle goes: its end says what to do.
void copy_message(char (&to)[longest_message], std::string_view from);

// What a hello or a reply says is wrong.
template <class Message>
DeviceError problem_of(const Message& message) {
  const auto status = static_cast<DeviceStatus>(message.status);
  if (message.advised != 0) return DeviceError::passed_on(status, message.message);
  return DeviceError(status, message.message);
}

enum class Received { message, nothing, gone };

bool send_bytes(int fd, const void* bytes, std::size_t size);
// Waits until the deadline (MonotonicClock's seconds) for a message of exactly that size.
Received receive_bytes(int fd, void* bytes, std::size_t size, double deadline_s);

template <class T>
bool send_message(int fd, const T& message) {
  return send_bytes(fd, &message, sizeof message);
}
template <class T>
Received receive_message(int fd, T& message, double deadline_s) {
  return receive_bytes(fd, &message, sizeof message, deadline_s);
}

}  // namespace touchstone::hil

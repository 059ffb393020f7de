#include <algorithm>

#include "emulators/usb_emulator.h"

namespace touchstone::hil {
namespace {

constexpr std::size_t frame_bytes = 16;

// libnifalcon, FalconFirmwareNovintSDK::formatInput: `<`, three motors of four nibbles, lowest first, LEDs with the
// homing bit lowest, an unused nibble, `>`; every nibble + 0x41.
int nibbles_at(const unsigned char* from) {
  unsigned value = 0;
  for (unsigned i = 0; i < 4; ++i) value |= (static_cast<unsigned>(from[i] - 0x41) & 0xfU) << (4 * i);
  return static_cast<std::int16_t>(value);
}

// FalconFirmwareNovintSDK::formatOutput: encoders in the motors' places, then homed arms << 4 | buttons.
std::vector<unsigned char> answer_of(const std::array<int, 3>& encoders, unsigned homed) {
  std::vector<unsigned char> frame(frame_bytes, 0x41);
  frame.front() = '<', frame.back() = '>';
  for (std::size_t i = 0; i < 12; ++i) {
    const auto value = static_cast<unsigned>(encoders[i / 4]) >> (4 * (i % 4));
    frame[1 + i] = static_cast<unsigned char>(0x41 + (value & 0xfU));
  }
  frame[13] = static_cast<unsigned char>(0x41 + (homed << 4U));
  return frame;
}

}  // namespace

void FalconModel::send(const std::vector<unsigned char>& bytes) {
  // At most 62 bytes after the two modem bytes, as a full-speed packet holds.
  for (std::size_t at = 0; at < bytes.size(); at += 62) {
    std::vector<unsigned char> packet{0x01, 0x60};
    packet.insert(packet.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                  bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), at + 62)));
    out_.push_back(std::move(packet));
  }
}

void FalconModel::control(unsigned request, unsigned value) {
  const std::scoped_lock lock(mutex_);
  if (request == 0) out_.clear(), in_.clear();  // purge
  if (request == 1 && value == 0x0101)
    booting_ = true, running_ = loading_ = false, firmware_bytes_ = 0;  // DTR high: the boot loader starts
  if (request == 3 && value == 0x2 && loading_ && firmware_bytes_ >= firmware_size_)
    loading_ = booting_ = false, running_ = true;
}

void FalconModel::received(const std::vector<unsigned char>& bytes) {
  const std::scoped_lock lock(mutex_);
  if (booting_ && !loading_) {
    if (bytes == std::vector<unsigned char>{0x0a, 0x43, 0x0d}) send({0x0a, 0x44, 0x2c, 0x0d});
    if (bytes == std::vector<unsigned char>{0x41}) send({0x41}), loading_ = true;
    return;
  }
  if (loading_) {
    firmware_bytes_ += bytes.size();
    auto echo = bytes;
    if (bad_echo_.exchange(false)) echo[0] = static_cast<unsigned char>(echo[0] ^ 1U);
    send(echo);
    return;
  }
  if (!running_) return;
  in_.insert(in_.end(), bytes.begin(), bytes.end());
  while (in_.size() >= frame_bytes) {
    const bool whole = in_[0] == '<' && in_[frame_bytes - 1] == '>';
    const bool homing = whole && ((in_[13] - 0x41) & 1) != 0;
    for (std::size_t i = 0; whole && i < 3; ++i) motors_[i] = nibbles_at(in_.data() + 1 + 4 * i);
    in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(frame_bytes));
    // The arms pass their index marks within three frames; a frame without the bit makes the firmware forget them.
    frames_ = homing ? frames_ + 1 : 0;
    auto bytes_out = answer_of(encoders_, frames_ > 3 ? 7U : 0U);
    if (damaged_ > 0) --damaged_, bytes_out[5] = 0x7f;
    send(bytes_out);
  }
}

std::optional<std::vector<unsigned char>> FalconModel::packet() {
  const std::scoped_lock lock(mutex_);
  if (out_.empty()) return std::nullopt;
  auto packet = std::move(out_.front());
  out_.pop_front();
  return packet;
}

void FalconModel::set_encoders(const std::array<int, 3>& counts) {
  const std::scoped_lock lock(mutex_);
  encoders_ = counts;
}

std::array<int, 3> FalconModel::motors() const {
  const std::scoped_lock lock(mutex_);
  return motors_;
}

std::size_t FalconModel::firmware_bytes() const {
  const std::scoped_lock lock(mutex_);
  return firmware_bytes_;
}

}  // namespace touchstone::hil

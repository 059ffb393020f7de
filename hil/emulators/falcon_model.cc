#include <algorithm>

#include "hil/emulators/usb_emulator.h"

namespace touchstone::hil {

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
  while (in_.size() >= falcon::frame_bytes) {
    falcon::Frame frame;
    std::copy_n(in_.begin(), frame.size(), frame.begin());
    in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(frame.size()));
    motors_ = falcon::decode_command(frame).motors;
    falcon::Answer answer;
    answer.encoders = encoders_;
    answer.homed = ++frames_ > 3 ? 7U : 0U;  // the arms pass their index marks
    auto bytes_out = falcon::encode(answer);
    if (damaged_ > 0) --damaged_, bytes_out[5] = 0x7f;
    send({bytes_out.begin(), bytes_out.end()});
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

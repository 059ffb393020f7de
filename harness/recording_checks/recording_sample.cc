#include "harness/recording_checks/recording_sample.h"

#include "harness/recording/recording_stream.h"

namespace touchstone::recording_checks {
using recording::Recording;

namespace {

// Keeps every second value.
template <class T>
void halve(std::vector<T>& values) {
  for (std::size_t i = 0; 2 * i < values.size(); ++i) values[i] = values[2 * i];
  values.resize((values.size() + 1) / 2);
}

}  // namespace

Recording sample_recording(const std::filesystem::path& path, std::size_t most) {
  Recording sample;
  sample.source = path.string();
  recording::RecordingStream stream = recording::RecordingStream::open(path);
  std::uint64_t stride = 1;
  recording::SampleBlock block;
  while (stream.next(block)) {
    for (std::size_t i = 0; i < block.size(); ++i) {
      if ((block.first_sample + i) % stride != 0) continue;
      sample.motion.t_s.push_back(block.motion.t_s[i]);
      sample.motion.p_W_m.push_back(block.motion.p_W_m[i]);
      if (!block.motion.q_WS.empty()) sample.motion.q_WS.push_back(block.motion.q_WS[i]);
      if (!block.f_W_N.empty()) sample.f_W_N.push_back(block.f_W_N[i]);
      if (sample.size() < most) continue;
      halve(sample.motion.t_s);
      halve(sample.motion.p_W_m);
      halve(sample.motion.q_WS);
      halve(sample.f_W_N);
      stride *= 2;
    }
  }
  return sample;
}

void flip_force(Recording& recording) {
  for (Vec3& f : recording.f_W_N) f = -f;
  for (Vec3& torque : recording.torque_W_Nm) torque = -torque;
}

}  // namespace touchstone::recording_checks

// Would a person tell a rendering from the real thing? A statement about one pair of recordings: d' and the share of
// right answers in a two-alternative forced choice, with 95 % intervals, and the channel that gives it away.
//
// Channels: force (magnitude over depth), stiffness, rate (damping, or a delay of force behind motion), direction of
// force, friction, vibration, contact transient, position of first contact, force in free air and on release. Evidence
// of each is in just noticeable differences (thresholds.h). Force and stiffness are two cues of one curve: the stronger
// counts. The others are independent: d' is the root of the sum of squares (Green and Swets 1966, section 9.3; for
// touch Ernst and Banks 2002).
//
// The recordings are compared as responses to motion (response.h), so that hands that press deeper, faster or more
// often are no difference. Force is compared from place to place too (place.h), where both recordings were; where the
// two motions are the same to the last digit, sample by sample.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/perception/judge/felt_series.h"
#include "harness/perception/judge/free_air.h"
#include "harness/perception/judge/response.h"
#include "harness/perception/judge/surface_shape.h"
#include "harness/perception/judge/thresholds.h"
#include "harness/perception/judge/vibration.h"

namespace touchstone::perception {

enum class Channel : unsigned char { force, stiffness, rate, direction, friction, vibration, transient, position, air };
inline constexpr std::size_t channel_count = 9;
std::string_view name_of(Channel channel);

// What the makers of the instrument declare; 0: not declared. Used where no repeats say more.
struct DeclaredNoise {
  double force_N = 0.0;
  double force_time_constant_s = 0.0;  // 0: white up to half the rate
  double geometry_m = 0.0;             // error of the surface, or of where it stands
};

// A process, prepared once for all its pairs.
struct JudgedProcess {
  std::optional<SurfaceShape> shape;  // of the real process's object; nothing: flat, or no paraboloid
  FeltSeries felt;                    // with the motion of lag ago, as the response has it
  FirstContact contact;
  std::optional<Response> response;  // nothing: never in contact
  FastForce fast;
  FreeAir air;
  // Depth and sliding before the lag was taken out: by these two processes move alike.
  std::vector<double> prompt_depth_m;
  std::vector<double> prompt_slide_x;
};
// `reference`: the real process, whose depths it is compared at; null for the real process itself.
JudgedProcess judged_process(FeltSeries felt, const Thresholds& thresholds, const JudgedProcess* reference = nullptr);

struct ChannelEvidence {
  Channel channel = Channel::force;
  bool known = false;           // false: these recordings do not show it; `why` says so
  double jnd = 0.0;             // never below 0; what noise adds is taken off
  double measured_jnd = 0.0;    // before that: the middle of the interval
  double standard_error = 0.0;  // of what is measured
  double probability = 0.5;     // of this channel alone
  std::string what;             // "38 % softer", "0.35 N near 200 Hz"
  std::string remedy;           // what gets it below one JND; empty where it is below
  std::string why;
  std::string would_tell;  // what would make the error smaller, if the channel knows
  double depth_m = 0.0;    // where it is strongest, from contact; NaN: has no depth
};

// A stretch of the condition's recording.
struct FeltMoment {
  double t_s = 0.0;             // middle
  double jnd = 0.0;             // of the force against what the real process gives for this motion
  double sideways_share = 0.0;  // of the squared difference that lies across the direction of pressing
  std::size_t sample = 0;       // in the middle
};

enum class Verdict : unsigned char { noticed, not_noticed, cannot_tell };
std::string_view name_of(Verdict verdict);

struct Judgement {
  double d_prime = 0.0;
  double d_prime_low95 = 0.0;
  double d_prime_high95 = 0.0;
  double noticed_probability = 0.5;
  double noticed_low95 = 0.5;
  double noticed_high95 = 0.5;
  // noticed: the interval lies above one JND; not_noticed: below; else these recordings cannot tell.
  Verdict verdict = Verdict::cannot_tell;
  bool above_noise = false;               // d' is not explained by the noise of the recordings
  std::vector<ChannelEvidence> channels;  // in the order of Channel
  std::optional<Channel> gives_away;      // the strongest, if it is above noise
  bool same_motion = false;
  std::vector<FeltMoment> moments;  // in contact
  PlaceMaps places;
  double noticed_share = 0.0;  // of the moments, above one JND; NaN without moments
  // Where it cannot tell: which channels leave it open, what would tell, and the verdict without them.
  std::string open;
  std::vector<std::string> remarks;
};
// The share of people that tell the two apart, for a reader: "76 %"; "-" where these recordings cannot tell, and the
// interval alone says anything.
std::string told_share(const Judgement& judgement);

struct JudgeOptions {
  Thresholds thresholds;
  DeclaredNoise declared;
  std::vector<Channel> without;  // left out of d', still reported
  bool keep_moments = true;
};

// How much repeats of the real process differ from it, by channel, root mean square in JND; nothing without repeats.
struct NoiseFloor {
  std::vector<double> jnd;
  std::size_t repeats = 0;
};
NoiseFloor noise_floor(const JudgedProcess& real, const std::vector<JudgedProcess>& repeats,
                       const JudgeOptions& options);

// Depends on nothing but its arguments. Throws BadData where the real process is never in contact.
Judgement judge(const JudgedProcess& real, const JudgedProcess& rendered, const NoiseFloor& floor,
                const JudgeOptions& options);

}  // namespace touchstone::perception

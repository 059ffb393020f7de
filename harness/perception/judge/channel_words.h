// What a channel says to a reader: the difference, and what would have to change.
#pragma once

#include "harness/perception/judge/judge.h"
#include "harness/perception/judge/slow_channels.h"

namespace touchstone::perception {

void describe_slow(ChannelEvidence& evidence, const SlowEvidence& found, const Thresholds& thresholds);
void describe_vibration(ChannelEvidence& evidence, const VibrationDifference& found, const Thresholds& thresholds);
void describe_air(ChannelEvidence& evidence, const AirDifference& found, const Thresholds& thresholds);
std::string why_unknown(Channel channel);

}  // namespace touchstone::perception

// Two conditions against one real process: one pressed at one place, one differing from place to place, for tests of
// the report.
#pragma once

#include <string>

#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::report {

// 5 by 4 places of 4 mm across z; the 5 at the largest y are not known, of the rest those above x = 0 are stiffer.
inline perception::PlaceMap sample_places() {
  perception::PlaceMap map;
  map.cell_m = 0.004;
  for (int x = 0; x < 5; ++x) {
    for (int y = 0; y < 4; ++y) {
      perception::PlaceDifference cell;
      cell.centre_m = Vec3(0.004 * (x - 2), 0.004 * y, 0.0);
      cell.known = y < 3;
      cell.real_N = 1.0;
      cell.rendered_N = x > 2 ? 2.0 : 0.99;
      cell.jnd = x > 2 ? 2.5 : 0.1;
      cell.standard_error = 0.1;
      cell.share = 0.05;
      map.cells.push_back(cell);
    }
  }
  return map;
}

inline perception::JudgedConditions sample_judgement() {
  perception::JudgedConditions judged;
  for (const char* const name : {"a rendering with a lump", "plain"}) {
    perception::JudgedCondition& condition = judged.conditions.emplace_back();
    condition.name = name;
    condition.rank = judged.conditions.size();
    condition.group = 1;
    for (std::size_t c = 0; c < perception::channel_count; ++c) {
      perception::ChannelEvidence& own = condition.judgement.channels.emplace_back();
      own.channel = static_cast<perception::Channel>(c);
      own.known = c != 4;
      own.jnd = 12.34;
      own.standard_error = 10.01;
      own.what = "vibration in contact near 202 Hz: 0.0022 N instead of 0.00027 N (felt from 0.0011 N on)";
      own.why = "at no common depth do both recordings slide to and fro, or both one way";
    }
    for (const char* const metric :
         {"perception-space", "euclidean", "structural-similarity", "maximum-absolute-error"})
      condition.others.push_back({metric, "N", false, 123.4567, ""});
  }
  judged.conditions[0].judgement.places.force = sample_places();
  return judged;
}

}  // namespace touchstone::report

// A renderer's entry as a subject of the conformance suite.
#pragma once

#include "harness/renderer_faults/entry_engine.h"
#include "harness/testing/renderer_conformance.h"

namespace touchstone::testing {

using renderer_faults::in_unit;
using SubjectFacts = renderer_faults::EngineFacts;

// Throws as renderer_faults::engine_of() does.
inline RendererSubject subject_of(const rendering::RendererEntry& entry, const SubjectFacts& facts) {
  RendererSubject subject;
  static_cast<renderer_faults::Engine&>(subject) = renderer_faults::engine_of(entry, facts);
  return subject;
}

}  // namespace touchstone::testing

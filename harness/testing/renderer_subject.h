// A renderer's entry as a subject of the conformance suite.
#pragma once

#include "harness/diagnosis/entry_engine.h"
#include "harness/testing/renderer_conformance.h"

namespace touchstone::testing {

using diagnosis::in_unit;
using SubjectFacts = diagnosis::EngineFacts;

// Throws as diagnosis::engine_of() does.
inline RendererSubject subject_of(const rendering::RendererEntry& entry, const SubjectFacts& facts) {
  RendererSubject subject;
  static_cast<diagnosis::Engine&>(subject) = diagnosis::engine_of(entry, facts);
  return subject;
}

}  // namespace touchstone::testing

// Engines made of an engine, to ask what a finding follows from: the same answers but for one thing.
#pragma once

#include "harness/renderer_faults/engine.h"

namespace touchstone::renderer_faults {

// Asked again, within half a sample, where there is no force, and where it falls from one sample to the next to less
// than half: what drops out is there then.
Engine asked_again(const Engine& engine);

// Over the same body, its triangles counted from another one, this share of them later: a face that is bad by its index
// is elsewhere.
Engine counted_from(const Engine& engine, double share);

// With a force on top that swings by so much in all while there is contact.
Engine with_noise(const Engine& engine, double swing_N);

// Its whole world leaning over: what is level to the probe has a force along every axis of the engine.
Engine leaning(const Engine& engine);

}  // namespace touchstone::renderer_faults

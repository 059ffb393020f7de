// The experiments that are run over several seeds, each seed a case (apps/experiments/seed_cases.h).
#pragma once

#include <array>

#include "experiments/perception_bench.h"
#include "experiments/seed_cases.h"
#include "experiments/voxel_experiment.h"

namespace touchstone::experiments {

// The coefficients of the scans that a seed of the friction experiment takes, one scan and one number each.
inline constexpr std::array friction_coefficients{0.25, 0.15, 0.40};

// Their documents are what voxel_from(), friction_from_json(), density_from_json() and spring_seed_from_json() read.
// `options.seed` is the first; the series that the report draws are kept of the first seed alone.
SeededExperiment seeded_voxel(const VoxelExperimentOptions& options, std::uint64_t seeds);
SeededExperiment seeded_friction(std::uint64_t first_seed, std::uint64_t seeds);
// The same file serves both: `shading` is which of the two commands a Slurm task calls.
SeededExperiment seeded_density(std::uint64_t first_seed, std::uint64_t seeds, bool shading);
// Where the values and findings of one of the two stand.
SpreadPart density_part(bool shading);
SeededExperiment seeded_springs(std::uint64_t first_seed, std::uint64_t seeds);
// Both truths; `options.truth` does not count.
SeededExperiment seeded_perception(const PerceptionBenchOptions& options);
// Of one truth, from the documents of its seeds, at least one.
PerceptionBench stored_bench(PerceptionBenchOptions options, BenchTruth truth, const std::vector<StoredSeed>& seeds);

}  // namespace touchstone::experiments

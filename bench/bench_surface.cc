// What one query of a surface costs: closest point and first crossing, Embree and exact, on 1k, 10k and 140k triangles,
// next to the surface (as a servo loop asks) and anywhere around the object; and what building costs.
// Run: bench_surface [--benchmark_filter=...] [--benchmark_format=json]. Counter queries_per_us: more is better.
#include <benchmark/benchmark.h>

#include <map>
#include <stdexcept>

#include "harness/base/random.h"
#include "harness/surface/cgal/exact_surface.h"
#include "harness/surface/embree_surface.h"
#include "harness/surface/mesh_topology.h"
#include "harness/testing/tiny_meshes.h"

namespace touchstone::bench {
using surface::Surface;
using surface::TriangleMesh;

namespace {

// A torus of 0.1 m with that many triangles.
TriangleMesh object(std::int64_t triangles) {
  switch (triangles) {
    case 1000:
      return testing::torus(0.035, 0.015, 25, 20);
    case 10000:
      return testing::torus(0.035, 0.015, 100, 50);
    case 140000:
      return testing::torus(0.035, 0.015, 350, 200);
    case 1000000:
      return testing::torus(0.035, 0.015, 1000, 500);
    default:
      throw std::invalid_argument("no object of that size");
  }
}

enum class Kind { embree, exact };

const Surface& surface(Kind kind, std::int64_t triangles) {
  static std::map<std::pair<Kind, std::int64_t>, std::shared_ptr<Surface>> made;
  auto& found = made[{kind, triangles}];
  if (!found)
    found = kind == Kind::embree ? make_embree_surface(object(triangles)) : make_exact_surface(object(triangles));
  return *found;
}

// Positions within 2 mm of the surface, and a step of a moving probe away (0.2 mm: 0.2 m/s at 1 kHz).
struct Queries {
  std::vector<Vec3> from;
  std::vector<Vec3> to;
};

const Queries& queries(bool near) {
  static const auto make = [](bool close) {
    Random random(2006);
    const Surface& where = surface(Kind::embree, 10000);
    Queries out;
    for (int i = 0; i < 4096; ++i) {
      Vec3 p = 0.1 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      if (close) p = where.closest(p).p_W_m + random.uniform(0.0, 0.002) * random.direction();
      out.from.push_back(p);
      out.to.push_back(close ? Vec3(p + 0.0002 * random.direction()) : Vec3(0.1 * random.direction()));
    }
    return out;
  };
  static const Queries close = make(true);
  static const Queries anywhere = make(false);
  return near ? close : anywhere;
}

void count(benchmark::State& state) {
  state.counters["queries_per_us"] =
      benchmark::Counter(1e-6 * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

template <Kind kind>
void closest(benchmark::State& state) {
  const Surface& object_surface = surface(kind, state.range(0));
  const Queries& q = queries(state.range(1) == 1);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(object_surface.closest(q.from[i % q.from.size()]));
    ++i;
  }
  count(state);
}

template <Kind kind>
void crossing(benchmark::State& state) {
  const Surface& object_surface = surface(kind, state.range(0));
  const Queries& q = queries(state.range(1) == 1);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(object_surface.first_crossing(q.from[i % q.from.size()], q.to[i % q.from.size()]));
    ++i;
  }
  count(state);
}

template <Kind kind>
void build(benchmark::State& state) {
  const TriangleMesh mesh = object(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(kind == Kind::embree ? make_embree_surface(mesh) : make_exact_surface(mesh));
  }
}

void topology(benchmark::State& state) {
  const TriangleMesh mesh = object(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(make_topology(mesh));
}

void add(Kind kind) {
  const bool fast = kind == Kind::embree;
  const std::string name = fast ? "embree" : "exact";
  const auto sizes = [](benchmark::internal::Benchmark* b) {
    b->ArgNames({"triangles", "near"})->ArgsProduct({{1000, 10000, 140000}, {1, 0}});
  };
  sizes(benchmark::RegisterBenchmark((name + "/closest").c_str(), fast ? closest<Kind::embree> : closest<Kind::exact>));
  sizes(benchmark::RegisterBenchmark((name + "/crossing").c_str(),
                                     fast ? crossing<Kind::embree> : crossing<Kind::exact>));
  benchmark::RegisterBenchmark((name + "/build").c_str(), fast ? build<Kind::embree> : build<Kind::exact>)
      ->ArgName("triangles")
      ->Arg(1000)
      ->Arg(10000)
      ->Arg(140000)
      ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace touchstone::bench

int main(int argc, char** argv) {
  touchstone::bench::add(touchstone::bench::Kind::embree);
  if (touchstone::surface::exact_surface_available()) touchstone::bench::add(touchstone::bench::Kind::exact);
  benchmark::RegisterBenchmark("topology", touchstone::bench::topology)
      ->ArgName("triangles")
      ->Arg(10000)
      ->Arg(140000)
      ->Arg(1000000)
      ->Unit(benchmark::kMillisecond);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

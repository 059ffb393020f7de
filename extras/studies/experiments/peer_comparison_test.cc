#include "experiments/peer_comparison.h"

#include <gtest/gtest.h>

#include "harness/testing/shared_data.h"

namespace touchstone::experiments {
namespace {

class PeerComparison : public ::testing::TestWithParam<std::string> {};

TEST_P(PeerComparison, OursIsNoWorseThanTheBetterPeerInMeanAndMaximum) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(peers, "peers");
  const PeerCase result = compare_with_peers(peers, GetParam());
  std::cout << peer_table({result});
  ASSERT_EQ(result.results.size(), 4U);
  EXPECT_GT(result.samples, 9000U);
  const PeerResult& ours = result.results.front();
  // On bumpy all errors are the tessellation's (a thousandth of it on bumpy10k is 8e-6 N): what a peer's proxy gains by
  // hovering 1e-7 m above triangles that lie inside the smooth body is 0.1 % there, and no merit. Elsewhere no
  // allowance.
  const double allowance = GetParam().starts_with("bumpy") ? 2e-3 : 0.0;
  for (std::size_t i = 1; i < result.results.size(); ++i) {
    const PeerResult& peer = result.results[i];
    EXPECT_LE(ours.mean_N, peer.mean_N * (1.0 + allowance)) << peer.method;
    EXPECT_LE(ours.max_N, peer.max_N * (1.0 + allowance)) << peer.method;
    // The renderer's own part: none of ours; theirs exceeds whatever they gained many times.
    EXPECT_GT(peer.off_mesh_N, 5.0 * std::max(0.0, ours.mean_N - peer.mean_N)) << peer.method;
  }
}

TEST_P(PeerComparison, TheUnitOfTheMeshFileChangesNothing) {
  TOUCHSTONE_SHARED_DATA_OR_SKIP(peers, "peers");
  const recording::RenderedTrajectory metres = render_peer_case(peers, GetParam(), 1.0);
  for (const double unit_m : {1e-3, 1e3}) {
    const recording::RenderedTrajectory other = render_peer_case(peers, GetParam(), unit_m);
    ASSERT_EQ(other.size(), metres.size());
    double most_N = 0.0;
    for (std::size_t i = 0; i < metres.size(); ++i) {
      most_N = std::max(most_N, (other.f_W_N[i] - metres.f_W_N[i]).norm());
      ASSERT_EQ(other.contact[i], metres.contact[i]) << "sample " << i;
    }
    // A coordinate of 0.05 m times 1e3 and back is off by one unit in its last place, 7e-18 m: over the shortest edges
    // (bumpy10k: 0.1 mm) that tilts a normal by 1e-13, at 1 mm of depth and 500 N/m 5e-14 N.
    EXPECT_LE(most_N, 1e-12) << "unit " << unit_m << " m";
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, PeerComparison, ::testing::ValuesIn(peer_meshes()),
                         [](const auto& of) { return of.param; });

}  // namespace
}  // namespace touchstone::experiments

// Structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004) of two force series in sliding windows, pooled over
// time (Minkowski): eq 10 and 11 of Shao, Wu and Ouyang (2019), with which they describe the HSSIM of Hassen and
// Steinbach ("HSSIM: An objective haptic quality assessment measure for force-feedback signals", QoMEX 2018).
// It is NOT their HSSIM: that paper could not be had, and what is said of it names neither the windows, nor the
// constants, nor a perceptual mapping of the force. Windows and pooling below are ours.
//
//   l = (2 m_r m_v + C1) / (m_r^2 + m_v^2 + C1)     luminance: means
//   c = (2 s_r s_v + C2) / (s_r^2 + s_v^2 + C2)     contrast: standard deviations
//   s = (s_rv + C3) / (s_r s_v + C3)                structure: covariance
//   S_p = l^alpha c^beta s^gamma, pooled to 1/N sum S_p^r
#pragma once

#include <cstddef>
#include <span>

namespace touchstone::perception {

struct StructuralSimilarityConstants {
  std::size_t window = 100;  // samples (0.1 s at 1 kHz); ours
  std::size_t stride = 50;   // samples from window to window; ours
  double k1 = 0.01;          // C1 = (k1 L)^2, L the range of the real series; Wang et al. for images
  double k2 = 0.03;          // C2 = (k2 L)^2; Wang et al.
                             // C3 = C2 / 2; Wang et al.
  double alpha = 1.0;        // Wang et al.
  double beta = 1.0;
  double gamma = 1.0;
  double r = 1.0;  // Minkowski power; ours: the plain mean
};

// 1 for equal series. Images have no negative values and forces do: a luminance term below 0
// (means of opposite sign) counts as 0, ours. A negative structure term counts as 0 where gamma or r is not a whole
// number. Two series that are constant and equal are 1. Throws BadData when shorter than one window or of unequal
// length.
double structural_similarity(std::span<const double> real, std::span<const double> rendered,
                             const StructuralSimilarityConstants& constants = {});

}  // namespace touchstone::perception

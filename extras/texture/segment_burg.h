// An autoregressive model of one process from several short series.
//
// Source: de Waele and Broersen 2000, "The Burg algorithm for segments", IEEE Trans. Signal Processing 48:2876: each
// reflection coefficient is the one that minimises the forward and backward errors of all series together. It is less
// than 1, so that the filter is stable. The axes of a force are taken as series too: the power of all axes is what is
// felt (Landin, Romano, McMahan and Kuchenbecker 2010), and has one spectrum.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace touchstone::texture {

struct SegmentBurg {
  // polynomials[p]: 1, a1 ... ap of the model of order p, and the mean square of its error, of one series.
  std::vector<std::vector<double>> polynomials;
  std::vector<double> errors;
};

// Orders 0 to `largest`. Series no longer than that are left out.
SegmentBurg segment_burg(std::span<const std::vector<double>> series, std::size_t largest);

}  // namespace touchstone::texture

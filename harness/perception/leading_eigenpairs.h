// The eigenpairs of a symmetric, positive semi-definite matrix that hold a share of its trace: all of them from a dense
// solver where the matrix is small, the largest by Lanczos iterations (Spectra; Lehoucq and Sorensen 1996) where it is
// large and few hold the share: a dense solver takes seconds for a thousand rows, where three pairs are wanted.
#pragma once

#include <Eigen/Core>

namespace touchstone::perception {

struct EigenPairs {
  Eigen::VectorXd values;   // descending; at least as many as hold the share, all of them where the matrix is small
  Eigen::MatrixXd vectors;  // columns, orthonormal, in the order of the values
};

// Matrices with more rows than this are tried by Lanczos iterations first.
inline constexpr Eigen::Index dense_up_to = 300;

// The values beyond the returned ones sum to trace() less theirs.
EigenPairs leading_eigenpairs(const Eigen::MatrixXd& symmetric, double share_of_trace);

}  // namespace touchstone::perception

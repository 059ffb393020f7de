#include "harness/perception/leading_eigenpairs.h"

#include <Spectra/SymEigsSolver.h>

#include <Eigen/Eigenvalues>

namespace touchstone::perception {
namespace {

EigenPairs dense(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues().reverse(), solver.eigenvectors().rowwise().reverse()};
}

}  // namespace

EigenPairs leading_eigenpairs(const Eigen::MatrixXd& symmetric, double share_of_trace) {
  const double trace = symmetric.trace();
  if (symmetric.rows() <= dense_up_to || !(trace > 0.0)) return dense(symmetric);
  Spectra::DenseSymMatProd<double> product(symmetric);
  for (Eigen::Index wanted = 8; wanted <= symmetric.rows() / 6; wanted *= 4) {
    Spectra::SymEigsSolver<Spectra::DenseSymMatProd<double>> solver(product, wanted, 2 * wanted + 8);
    solver.init();
    solver.compute(Spectra::SortRule::LargestAlge, 300, 1e-13);
    // What did not converge has equals or next to equals beside it: the dense solver tells them apart.
    if (solver.info() != Spectra::CompInfo::Successful) break;
    EigenPairs found{solver.eigenvalues(), solver.eigenvectors()};
    if (found.values.sum() >= share_of_trace * trace) return found;
  }
  return dense(symmetric);
}

}  // namespace touchstone::perception

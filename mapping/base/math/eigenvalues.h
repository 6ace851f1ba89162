#pragma once

#include <Eigen/Eigenvalues>

#include "mapping/base/math/pose.h"

// Each of these takes the compiler several seconds; eigenvalues.cpp does it once for all sources that include
// this header. Matrices, not expressions, have to be handed to the solver.
namespace Eigen {

#define LOCI_EIGENVALUES(Matrix) \
  SelfAdjointEigenSolver<Matrix>& SelfAdjointEigenSolver<Matrix>::compute(const EigenBase<Matrix>&, int)

extern template LOCI_EIGENVALUES(Matrix2f);
extern template LOCI_EIGENVALUES(Matrix2d);
extern template LOCI_EIGENVALUES(Matrix3f);
extern template LOCI_EIGENVALUES(Matrix3d);
extern template LOCI_EIGENVALUES(MatrixXd);
extern template LOCI_EIGENVALUES(loci::Matrix6d);

}  // namespace Eigen

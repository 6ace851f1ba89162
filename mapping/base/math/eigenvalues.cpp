#include "mapping/base/math/eigenvalues.h"

namespace Eigen {

template LOCI_EIGENVALUES(Matrix2f);
template LOCI_EIGENVALUES(Matrix2d);
template LOCI_EIGENVALUES(Matrix3f);
template LOCI_EIGENVALUES(Matrix3d);
template LOCI_EIGENVALUES(MatrixXd);
template LOCI_EIGENVALUES(loci::Matrix6d);

}  // namespace Eigen

#pragma once

#include <Eigen/Core>

namespace loci {

/// Sums over points, from which mean and covariance follow. The moments of a neighbourhood are the sum of
/// those of its cells.
template <int Dimensions>
struct Moments {
  using Vector = Eigen::Matrix<double, Dimensions, 1>;
  using Matrix = Eigen::Matrix<double, Dimensions, Dimensions>;

  double count = 0;
  Vector sum = Vector::Zero();
  Matrix products = Matrix::Zero();

  void add(const Vector& point) {
    ++count;
    sum += point;
    products += point * point.transpose();
  }
  void add(const Moments& other) {
    count += other.count;
    sum += other.sum;
    products += other.products;
  }
  Vector mean() const { return sum / count; }
  Matrix covariance() const { return products / count - mean() * mean().transpose(); }
};

}  // namespace loci

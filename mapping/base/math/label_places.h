#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "mapping/base/math/polygon.h"

namespace loci {

/// Finds room for the labels of a drawing, so that none covers another. In the units and along the axes of
/// the drawing; a label is a rectangle.
class LabelPlaces {
 public:
  /// Takes room for a label of this size within an outline, as far from its edges as possible; returns the
  /// label's middle. Nothing where it does not fit.
  std::optional<Eigen::Vector2d> take_inside(const Polygon& outline, const Eigen::Vector2d& size);

  /// Takes room for a label that does not fit inside: its middle is as far inside as other labels leave room.
  std::optional<Eigen::Vector2d> take_about(const Polygon& outline, const Eigen::Vector2d& size);

  /// Takes the first of some middles at which a label covers no other; nothing where none is free.
  std::optional<Eigen::Vector2d> take_first(const std::vector<Eigen::Vector2d>& middles,
                                            const Eigen::Vector2d& size);

  /// What a text takes up in a usual proportional font.
  static Eigen::Vector2d size_of_text(size_t characters, double font_size) {
    return {0.6 * font_size * static_cast<double>(characters), 1.2 * font_size};
  }

 private:
  bool is_free(const Eigen::AlignedBox2d& label) const;
  /// The free middle for a label whose part of size `inside` is farthest from the edges of an outline.
  std::optional<Eigen::Vector2d> innermost(const Polygon& outline, const Eigen::Vector2d& size,
                                           const Eigen::Vector2d& inside) const;

  std::vector<Eigen::AlignedBox2d> taken_;
};

}  // namespace loci

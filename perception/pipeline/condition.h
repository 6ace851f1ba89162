#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// A question that a pipeline asks about each cluster before it goes on:
///
///     GeometryAnnotation.height > 0.02 and not ColorAnnotation.names == "white"
///     Scene.clusters <= 20
///     BarcodeAnnotation or (TextAnnotation.confidence >= 0.8)
///
/// A type alone asks whether the cluster has one. `Type.feature` (and on, over references) is compared with a
/// number, true, false or a text (`~ 'milk'`: contains it, in any case); of a list of texts any may fit, a
/// list of structures stands for their number. `Cluster` is the cluster, `Scene` the scene, `PlanarSupport`
/// what the cluster stands on, any other type an annotation or hypothesis of the cluster (its subtypes too),
/// of which any may fit. "Annotation" at the end of a type's name may be left out. A feature that is not set
/// fits nothing but `!=`.
class Condition {
 public:
  /// Throws Error that says what was expected.
  static Condition parse(const std::string& text, const FileLocation& place);

  const std::string& text() const { return text_; }
  /// The types that it asks for, as they are written.
  std::vector<std::string> types() const;
  /// Whether it asks about the scene alone, so that the answer is the same for all clusters.
  bool about_scene() const;
  /// Throws Error, with the nearest name, when there is no such type or feature, or it cannot be compared so.
  void check(const cas::TypeSystem& types) const;
  /// `cluster` may be null when it is about the scene.
  bool holds(const types::SceneCas& scene, const types::Cluster& cluster) const;

 private:
  struct Node;
  class Parser;
  std::string text_;
  FileLocation place_;
  std::shared_ptr<const Node> root_;
};

/// The type of this name: full, short, or short without "Annotation". Throws Error with the nearest one.
cas::Type named_type(const cas::TypeSystem& types, const std::string& name, const FileLocation& place = {});

}  // namespace loci::perception

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mapping/sensor/camera.h"
#include "memory/belief/scene.h"
#include "memory/store/rows/rows.h"
#include "perception/cas/cas.h"

namespace loci::memory {

/// An annotation and its searchable value.
struct AnnotationRecord {
  std::string type;  ///< type name
  std::string value;
  std::optional<double> confidence;
  perception::cas::FeatureStructure structure;  ///< all of it; may be null
};

/// As a row, without the structure, which is stored apart.
inline AnnotationRow annotation_row(const AnnotationRecord& annotation, Id scene,
                                    std::optional<Id> observation) {
  return {.scene = scene,
          .observation = observation,
          .type = annotation.type,
          .value = annotation.value,
          .confidence = annotation.confidence};
}

/// An image or other bytes with their media type; empty = none.
struct BlobRecord {
  std::string bytes;
  std::string media;
};

/// One observation: what the belief compares, and what the memory stores.
struct ObservationRecord {
  belief::Observation evidence;  ///< its id is given by the memory; its place is a name
  ObservationRow row;            ///< without id, scene, place, crop and mask, which the recorder fills in
  BlobRecord crop;
  BlobRecord mask;
  BlobRecord cloud;  ///< encode_cluster_depth() of the pixels of the mask
  std::vector<AnnotationRecord> annotations;
  std::vector<perception::cas::FeatureStructure> structures;  ///< further feature structures to store with it
};

/// Output of a pipeline or another detector for one moment.
struct SceneRecord {
  std::string source = "perceive";  ///< program or detector
  SceneRow row;                     ///< without id, depth and image, which the recorder fills in
  belief::SceneView view;
  std::optional<double> seconds_to_next;
  std::vector<belief::PlacePose> place_poses;  ///< current poses of moving places
  /// Furniture that is not where the scene's map has it, with its motion from there.
  std::vector<belief::PlacePose> moved_places = {};
  BlobRecord image;
  std::optional<mapping::RgbdCamera> cameras;  ///< of the image, where `structures` do not have them
  std::vector<PlaceRow> places;                ///< in view or in the map
  std::vector<ObservationRecord> observations;
  std::vector<AnnotationRecord> annotations;                  ///< about the scene as a whole
  std::vector<perception::cas::FeatureStructure> structures;  ///< of the scene
  cv::Mat kinds;            ///< CV_8U, mapping::PixelKind per pixel of view.depth; empty = not known
  std::vector<LogRow> log;  ///< without scene and number, which the recorder fills in
};

}  // namespace loci::memory

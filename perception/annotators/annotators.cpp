#include "perception/annotators/annotators.h"

#include "perception/annotators/description/color_histogram.h"
#include "perception/annotators/description/color_name.h"
#include "perception/annotators/description/geometry_annotator.h"
#include "perception/annotators/description/location_annotator.h"
#include "perception/annotators/description/object_views.h"
#include "perception/annotators/description/perceptual_hash_annotator.h"
#include "perception/annotators/description/primitive_annotator.h"
#include "perception/annotators/description/recognition_annotators.h"
#include "perception/annotators/description/relations_annotator.h"
#include "perception/annotators/description/shape_annotators.h"
#include "perception/annotators/description/template_annotator.h"
#include "perception/annotators/description/visual_search.h"
#include "perception/annotators/hypotheses/asserted_volumes.h"
#include "perception/annotators/hypotheses/flat_object_extractor.h"
#include "perception/annotators/hypotheses/known_structure_filter.h"
#include "perception/annotators/hypotheses/normal_estimator.h"
#include "perception/annotators/hypotheses/plane_cluster_extractor.h"
#include "perception/annotators/hypotheses/superpixel_annotators.h"
#include "perception/annotators/hypotheses/transparent_extractor.h"
#include "perception/annotators/io/recording_reader.h"

namespace loci::perception {

void add_annotators(AnnotatorRegistry& registry) {
  registry.add_reader<RecordingReader>();
  registry.add<NormalEstimator>();
  registry.add<KnownStructureFilter>();
  registry.add<PlaneClusterExtractor>();
  registry.add<FlatObjectExtractor>();
  registry.add<TransparentExtractor>();
  registry.add<AssertedVolumes>();
  registry.add<SuperpixelExtractor>();
  registry.add<SaliencyDetector>();
  registry.add<ColorHistogramAnnotator>();
  registry.add<ColorNameAnnotator>();
  registry.add<GeometryAnnotator>();
  registry.add<LocationAnnotator>();
  registry.add<PerceptualHashAnnotator>();
  registry.add<ProductAnnotator>();
  registry.add<BarcodeAnnotator>();
  registry.add<TextAnnotator>();
  registry.add<PclFeatureAnnotator>();
  registry.add<ImageFeatureAnnotator>();
  registry.add<FeatureClassifier>();
  registry.add("ImageClassifier", [] { return std::make_unique<FeatureClassifier>(true); });
  registry.add<PrimitiveShapeAnnotator>();
  registry.add<SizeAnnotator>();
  registry.add<RelationsAnnotator>();
  registry.add<TemplateAnnotator>();
  registry.add<VisualSearch>();
  registry.add_multiplier<ObjectViews>();
}

const std::string& default_pipeline() {
  static const std::string text = R"(# The pipeline that loci-perceive run uses when none is given.
reader: RecordingReader
flow:
  - NormalEstimator          # smoothed depth, cloud, normals
  - KnownStructureFilter     # what the map explains goes (does nothing without a map)
  - PlaneClusterExtractor    # supports, and one cluster per object
  - FlatObjectExtractor      # what is too low to be told from its support by height alone
  - PlaceNaming              # without a map: plane_1, plane_2, ... stay the same surfaces
  - ColorHistogram
  - ColorName
  - GeometryAnnotator        # oriented box, pose in the map and in the frame of its place
  - LocationAnnotator        # where it is, with a sentence
)";
  return text;
}

}  // namespace loci::perception

#include "perception/annotators/annotators.h"

#include "perception/annotators/description/color_annotators.h"
#include "perception/annotators/description/geometry_annotators.h"
#include "perception/annotators/description/network_embedding.h"
#include "perception/annotators/description/object_views.h"
#include "perception/annotators/description/recognition_annotators.h"
#include "perception/annotators/description/shape_annotators.h"
#include "perception/annotators/description/texture_annotator.h"
#include "perception/annotators/description/visual_search.h"
#include "perception/annotators/io/recording_reader.h"
#include "perception/annotators/people/person_annotator.h"
#include "perception/annotators/segmentation/asserted_volumes.h"
#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"
#include "perception/annotators/segmentation/detections2d.h"
#include "perception/annotators/segmentation/flat_objects.h"
#include "perception/annotators/segmentation/network_detections.h"
#include "perception/annotators/segmentation/superpixels.h"
#include "perception/annotators/segmentation/transparent_objects.h"
#include "perception/annotators/segmentation/unsupported_objects.h"
#include "perception/annotators/structure/known_structure.h"
#include "perception/annotators/structure/normals.h"

namespace loci::perception {

void add_annotators(AnnotatorRegistry& registry) {
  registry.add_reader<RecordingReader>();
  registry.add<NormalEstimator>();
  registry.add<KnownStructureFilter>();
  registry.add<PersonAnnotator>();
  registry.add<PlaneClusterExtractor>();
  registry.add<FlatObjectExtractor>();
  registry.add<UnsupportedObjectExtractor>();
  registry.add<TransparentExtractor>();
  registry.add<Detections2D>();
  registry.add<NetworkDetector>();
  registry.add<AssertedVolumes>();
  registry.add<SuperpixelExtractor>();
  registry.add<SaliencyDetector>();
  registry.add<ColorHistogramAnnotator>();
  registry.add<ColorNameAnnotator>();
  registry.add<TextureAnnotator>();
  registry.add<GeometryAnnotator>();
  registry.add<LocationAnnotator>();
  registry.add<PerceptualHashAnnotator>();
  registry.add<ProductAnnotator>();
  registry.add<BarcodeAnnotator>();
  registry.add<TextAnnotator>();
  registry.add<PclFeatureAnnotator>();
  registry.add<ImageFeatureAnnotator>();
  registry.add<NetworkEmbedding>();
  registry.add<FeatureClassifier>();
  registry.add("ImageClassifier", [] { return std::make_unique<FeatureClassifier>(true); });
  registry.add<HouseholdClassifier>();
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
  - NormalEstimator          # smoothed depth, point cloud, normals
  - KnownStructureFilter     # removes map-explained points (no effect without a map)
  - PersonAnnotator          # people: no objects, and their faces are blurred in what is stored
  - PlaneClusterExtractor    # supports, and one cluster per object
  - FlatObjectExtractor      # objects too low to be separated from their support by height alone
  - UnsupportedObjectExtractor  # objects in bins and on shelves, in close-ups without a support
  - PlaceNaming              # without a map: stable names plane_1, plane_2, ...
  - ColorHistogram
  - ColorName
  - Texture                  # key points of prints and labels, by which objects are recognised
  - GeometryAnnotator        # oriented box, in the map and in the frame of its place
  - LocationAnnotator        # place of the object, as text
  - HouseholdClassifier      # cup, plate, box, ...: by shape, size and colour, where it is sure enough
)";
  return text;
}

}  // namespace loci::perception

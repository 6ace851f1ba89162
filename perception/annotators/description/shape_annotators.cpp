#include "perception/annotators/description/shape_annotators.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <numeric>

#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"
#include "perception/conversions/pcl.h"

namespace loci::perception {
namespace {

/// Descriptors that a cluster has already.
ObjectFeatures annotated_features(const types::Cluster& cluster) {
  ObjectFeatures all;
  const auto values_of = [](const auto& annotation) {
    const auto values = annotation.feature.get();
    return FeatureVector(values.begin(), values.end());
  };
  for (const std::string& name : shape_feature_names())
    for (const auto& annotation : cluster.annotations.filter<types::PclFeatureAnnotation>())
      if (annotation.name.get() == shape_feature_signature(name)) all.features[name] = values_of(annotation);
  for (const auto& annotation : cluster.annotations.filter<types::ImageFeatureAnnotation>())
    if (annotation.name.get() == "HOG") all.features["HOG"] = values_of(annotation);
  for (const auto& annotation : cluster.annotations.filter<types::LocalFeaturesAnnotation>()) {
    const auto places = annotation.places.get(), values = annotation.descriptors.get();
    LocalFeatures local;
    for (size_t i = 0; i + 2 < places.size(); i += 3)
      local.places.emplace_back(places[i], places[i + 1], places[i + 2]);
    if (local.count() == 0) continue;
    local.values.assign(values.begin(), values.end());
    local.length = local.values.size() / local.count();
    all.local[annotation.name.get()] = std::move(local);
  }
  return all;
}

void annotate_local(cas::Cas& cas, const types::Cluster& cluster, const std::string& source,
                    const std::string& name, const LocalFeatures& local) {
  if (local.count() == 0) return;
  std::vector<float> places;
  for (const Eigen::Vector3f& place : local.places) places.insert(places.end(), place.begin(), place.end());
  const auto annotation = types::LocalFeaturesAnnotation::create(cas);
  annotation.source.set(source);
  annotation.name.set(name);
  annotation.places.set(places);
  annotation.descriptors.set(local.values);
  cluster.annotations.push_back(annotation);
}

/// Colour of the image where each point falls on it, black outside; empty when the scene has none.
std::vector<Eigen::Vector3f> colors_of(const types::SceneCas& scene,
                                       const std::vector<Eigen::Vector3f>& points) {
  if (!scene.has(types::SceneCas::kColor) || !scene.has_camera("color") || !scene.has_camera("depth"))
    return {};
  const cv::Mat image = types::view_image(scene, types::SceneCas::kColor);
  if (image.type() != CV_8UC3) return {};
  const mapping::RgbdCamera camera = types::cameras(scene);
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  std::vector<Eigen::Vector3f> colors;
  for (const Eigen::Vector3f& point : points) {
    const Vector3d in_color = color_from_depth * point.cast<double>();
    const bool before = in_color.z() > 0;
    const Vector2d at = before ? camera.color.project(in_color) : Vector2d(-1, -1);
    const cv::Point pixel(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    const bool inside = before && cv::Rect({}, image.size()).contains(pixel);
    const cv::Vec3b color = inside ? image.at<cv::Vec3b>(pixel) : cv::Vec3b();
    colors.emplace_back(color[0], color[1], color[2]);
  }
  return colors;
}

std::string joined(const Ensemble& model, const std::string& between,
                   const std::function<std::string(const ExpertSpec&)>& text_of) {
  std::string text;
  for (const ExpertSpec& expert : model.experts()) text += (text.empty() ? "" : between) + text_of(expert);
  return text;
}

/// The image of a cluster, without its surface.
ObjectView image_view(const types::Cluster& cluster) {
  ObjectView view;
  const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
  if (!roi) return view;
  view.image = types::from<cv::Mat>(roi.image.get());
  if (roi.mask.is_set()) view.mask = types::from<cv::Mat>(roi.mask.get());
  if (view.mask.size() != view.image.size()) view.mask.release();
  return view;
}

/// Classes less probable than this are not stored.
constexpr double kMinStored = 0.02;

/// A part of the surface is enough: the features need no more points.
ObjectView household_view(const types::SceneCas& scene, const types::Cluster& cluster, const cv::Mat& points,
                          const cv::Mat& normals) {
  constexpr size_t kEnough = 1500;
  ObjectView view = image_view(cluster);
  const auto indices = cluster_indices(cluster);
  const size_t step = std::max<size_t>(1, indices.size() / kEnough);
  for (size_t k = 0; k < indices.size(); k += step) {
    view.surface.points.push_back(to_vector3f(points.ptr<cv::Vec3f>()[indices[k]]));
    view.surface.normals.push_back(to_vector3f(normals.ptr<cv::Vec3f>()[indices[k]]));
  }
  view.ground = cluster_ground(scene, cluster);
  return view;
}

}  // namespace

SurfacePoints cluster_surface(const types::SceneCas& scene, const types::Cluster& cluster) {
  const cas::Buffer<pcl::PointXYZ> points = types::points_of<pcl::PointXYZ>(scene.cloud());
  const cas::Buffer<pcl::Normal> normals = types::points_of<pcl::Normal>(scene.normals());
  SurfacePoints surface;
  for (const int32_t index : cluster_indices(cluster)) {
    surface.points.emplace_back(points[static_cast<size_t>(index)].getVector3fMap());
    surface.normals.emplace_back(normals[static_cast<size_t>(index)].getNormalVector3fMap());
  }
  surface.colors = colors_of(scene, surface.points);
  return surface;
}

ObjectView cluster_view(const types::SceneCas& scene, const types::Cluster& cluster) {
  ObjectView view = image_view(cluster);
  if (scene.has(types::SceneCas::kCloud) && scene.has(types::SceneCas::kNormals)) {
    view.surface = cluster_surface(scene, cluster);
    if (scene.scene().map_from_camera.is_set()) view.ground = cluster_ground(scene, cluster);
  }
  return view;
}

Ground cluster_ground(const types::SceneCas& scene, const types::Cluster& cluster) {
  const Isometry3d map_from_points = map_from_camera(scene.scene());
  Vector3d normal = Vector3d::UnitZ();
  double offset = std::numeric_limits<double>::infinity();
  if (const types::PlanarSupport support = cluster.support.get()) {
    normal = types::from<Vector3d>(support.normal.get());
    offset = support.offset.get();
  } else {
    for (const Vector3d& point : cluster_points(scene, cluster)) offset = std::min(offset, point.z());
  }
  if (const types::Cluster below = cluster.stands_on.get()) {
    constexpr double kTop = 0.98;
    std::vector<double> heights;
    for (const Vector3d& point : cluster_points(scene, below)) heights.push_back(normal.dot(point));
    if (!heights.empty()) offset = std::max(offset, quantile(heights, kTop));
  }
  return {map_from_points.linear().transpose() * normal, offset - normal.dot(map_from_points.translation())};
}

AnnotatorDescriptor PclFeatureAnnotator::descriptor() const {
  return {"PclFeature",
          "Computes PCL shape descriptors of each object.",
          {"Cluster", "ReferenceClusterPoints", "view:cloud", "view:normals"},
          {"PclFeatureAnnotation", "LocalFeaturesAnnotation"},
          {"CameraInfo", "view:color"}};
}

void PclFeatureAnnotator::declare(OptionTable& table) {
  std::string names;
  for (const std::string& name : shape_feature_names()) names += (names.empty() ? "" : ", ") + name;
  table.texts("features", features_, "Descriptors: " + names + ".");
  table.texts("keypoints", keypoints_, "Descriptors of key points: SHOT, FPFH.");
}

void PclFeatureAnnotator::start(Context& /*context*/) {
  for (const std::string& name : features_) shape_feature_signature(name);
  for (const std::string& name : keypoints_)
    if (is_of_image(name))
      throw Error("PclFeature knows no key points of images", {}, "there are SHOT, FPFH");
    else
      local_features(name, {});
}

void PclFeatureAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    const ObjectView view{cluster_surface(scene, cluster), {}, {}, {}};
    for (const std::string& name : keypoints_)
      annotate_local(cas, cluster, descriptor().name, name, local_features(name, view));
    for (const auto& [name, vector] : feature_set(features_, view.surface)) {
      const auto annotation = types::PclFeatureAnnotation::create(cas);
      annotation.source.set(descriptor().name);
      annotation.name.set(shape_feature_signature(name));
      annotation.feature.set(vector);
      cluster.annotations.push_back(annotation);
    }
  }
}

AnnotatorDescriptor ImageFeatureAnnotator::descriptor() const {
  return {"ImageFeature",
          "Computes descriptors of each object's image: HOG, SIFT and ORB.",
          {"Cluster", "StandaloneImageROI"},
          {"ImageFeatureAnnotation", "LocalFeaturesAnnotation"}};
}

void ImageFeatureAnnotator::declare(OptionTable& table) {
  table.texts("features", features_, "Descriptors: HOG, SIFT, ORB.");
}

void ImageFeatureAnnotator::start(Context& /*context*/) {
  for (const std::string& name : features_)
    if (!is_of_image(name))
      throw Error("there is no descriptor " + name + " of images", {}, "there are HOG, SIFT, ORB");
}

void ImageFeatureAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    ObjectView view = cluster_view(scene, cluster);
    view.surface = {};
    for (const std::string& name : features_) {
      if (name != "HOG") {
        annotate_local(cas, cluster, descriptor().name, name, local_features(name, view));
        continue;
      }
      const FeatureVector values = hog_of(view.image, view.mask);
      if (values.empty()) continue;
      const auto annotation = types::ImageFeatureAnnotation::create(cas);
      annotation.source.set(descriptor().name);
      annotation.name.set(name);
      annotation.feature.set(values);
      cluster.annotations.push_back(annotation);
    }
  }
}

AnnotatorDescriptor FeatureClassifier::descriptor() const {
  AnnotatorDescriptor descriptor;
  descriptor.name = images_only_ ? "ImageClassifier" : "FeatureClassifier";
  descriptor.description = images_only_
                               ? "Classifies objects by descriptors of their images with a trained model."
                               : "Classifies objects by descriptors of shape and image with a trained model.";
  descriptor.inputs = {"Cluster", "StandaloneImageROI"};
  if (!images_only_) descriptor.inputs = {"Cluster", "ReferenceClusterPoints", "view:cloud", "view:normals"};
  descriptor.outputs = {"ClassificationAnnotation"};
  descriptor.optional_inputs = {"ImageFeatureAnnotation", "LocalFeaturesAnnotation"};
  if (!images_only_)
    descriptor.optional_inputs = {"PclFeatureAnnotation",
                                  "ImageFeatureAnnotation",
                                  "LocalFeaturesAnnotation",
                                  "StandaloneImageROI",
                                  "CameraInfo",
                                  "view:color"};
  descriptor.needs_options = true;
  return descriptor;
}

void FeatureClassifier::declare(OptionTable& table) {
  table.text("model", path_, "Model file, written by `loci-perceive train`.");
  table.text("kind", kind_, "Kind of the classes: shape, object, ...");
  table.number("min_confidence", min_confidence_, "",
               "Minimum probability of the best class; less certain objects are not annotated.", 0, 1);
}

void FeatureClassifier::start(Context& /*context*/) {
  if (path_.empty())
    throw Error(descriptor().name + " has no model", {}, "give `model: FILE`, made by `loci-perceive train`");
  model_ = Ensemble::load(path_);
  const std::vector<std::string> names = model_->features();
  const auto other = std::find_if_not(names.begin(), names.end(), is_of_image);
  if (images_only_ && other != names.end())
    throw Error("the model needs " + *other + " of clouds", {path_, 0, {}}, "use FeatureClassifier");
}

void FeatureClassifier::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    ObjectFeatures known = annotated_features(cluster);
    std::vector<std::string> missing = model_->features();
    std::erase_if(missing, [&](const std::string& name) {
      return known.features.contains(name) || known.local.contains(local_name_of(name));
    });
    if (!missing.empty()) {
      ObjectFeatures found = object_features(missing, cluster_view(scene, cluster));
      known.features.merge(found.features);
      known.local.merge(found.local);
    }
    if (!model_->knows_enough(known.features, known.local)) continue;  // Too little is seen for a descriptor.
    const Classification result = model_->classify(known.features, known.local);
    if (result.probabilities[result.best] < min_confidence_) continue;
    const auto annotation = types::ClassificationAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(result.probabilities[result.best]);
    annotation.kind.set(kind_);
    annotation.label.set(model_->classes()[result.best]);
    annotation.feature.set(joined(*model_, "+", [](const ExpertSpec& e) { return e.feature; }));
    annotation.classifier.set(joined(*model_, "+", [](const ExpertSpec& e) { return e.options.method; }));
    annotation.model.set(std::filesystem::path(path_).stem().string());
    std::vector<size_t> order(result.probabilities.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return result.probabilities[a] > result.probabilities[b]; });
    for (const size_t c : order) {
      const auto confidence = types::ClassConfidence::create(cas);
      confidence.name.set(model_->classes()[c]);
      confidence.confidence.set(result.probabilities[c]);
      confidence.accuracy.set(model_->accuracies()[c]);
      annotation.confidences.push_back(confidence);
    }
    cluster.annotations.push_back(annotation);
  }
}

AnnotatorDescriptor HouseholdClassifier::descriptor() const {
  return {"HouseholdClassifier",
          "Names household objects by shape, size and colour, where it is sure enough.",
          {"Scene", "Cluster", "ReferenceClusterPoints", "PlanarSupport", "view:cloud", "view:normals"},
          {"ClassificationAnnotation"},
          {"StandaloneImageROI"}};
}

void HouseholdClassifier::declare(OptionTable& table) {
  table.text("model", path_,
             "Model file, written by `loci-evaluate description --household`; empty = the shipped one.");
}

void HouseholdClassifier::start(Context& /*context*/) {
  if (!path_.empty()) own_ = HouseholdModel::load(path_);
}

void HouseholdClassifier::process(cas::Cas& cas, Context& /*context*/) {
  const HouseholdModel& model = own_ ? *own_ : HouseholdModel::shipped();
  const types::SceneCas scene(cas);
  const cv::Mat points = cloud_points(scene), normals = cloud_normals(scene);
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto answer = model.classify(household_view(scene, cluster, points, normals));
    if (!answer) continue;
    const auto annotation = types::ClassificationAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(answer->probability);
    annotation.kind.set("object");
    if (answer->sure) annotation.label.set(answer->label);
    annotation.feature.set("Household");
    annotation.classifier.set("network");
    annotation.model.set("household");
    std::vector<std::pair<std::string, double>> classes = answer->classes;
    if (answer->label != classes.front().first)
      classes.emplace(classes.begin(), answer->label, answer->probability);
    for (const auto& [name, probability] : classes) {
      if (probability < kMinStored) break;
      const auto confidence = types::ClassConfidence::create(cas);
      confidence.name.set(name);
      confidence.confidence.set(probability);
      annotation.confidences.push_back(confidence);
    }
    cluster.annotations.push_back(annotation);
  }
}

AnnotatorDescriptor PrimitiveShapeAnnotator::descriptor() const {
  return {"PrimitiveShape",
          "Fits a box, cylinder, cone or sphere to each object.",
          {"Scene", "Cluster", "ReferenceClusterPoints", "PlanarSupport", "view:cloud", "view:normals"},
          {"PrimitiveShapeAnnotation"}};
}

void PrimitiveShapeAnnotator::declare(OptionTable& table) {
  options_.declare(table);
  table.number("min_explained", min_explained_, "",
               "Minimum share of the points on the best shape; other objects are not annotated.", 0, 1);
}

void PrimitiveShapeAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    const std::optional<PrimitiveShape> shape =
        fit_primitive(cluster_surface(scene, cluster), cluster_ground(scene, cluster), options_);
    if (!shape || shape->explained < min_explained_) continue;
    const auto annotation = types::PrimitiveShapeAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(shape->probability * shape->explained);
    annotation.kind.set(name_of(shape->kind));
    annotation.map_from_shape.set(
        types::to(cas, Isometry3d(map_from_camera(scene.scene()) * shape->frame_from_shape)));
    annotation.size.set(types::to(cas, shape->size));
    const bool box = shape->kind == PrimitiveShape::Kind::box,
               sphere = shape->kind == PrimitiveShape::Kind::sphere;
    if (!box) annotation.radius.set(shape->radius());
    if (!sphere) annotation.height.set(shape->size.z());
    if (!box && !sphere) {
      annotation.radius_low.set(shape->radius_low);
      annotation.radius_high.set(shape->radius_high);
    }
    annotation.explained.set(shape->explained);
    annotation.error.set(shape->error);
    cluster.annotations.push_back(annotation);
  }
}

AnnotatorDescriptor SizeAnnotator::descriptor() const {
  return {"Size",
          "Classifies each object as small, medium or large.",
          {"Cluster", "GeometryAnnotation"},
          {"SizeAnnotation"}};
}

void SizeAnnotator::declare(OptionTable& table) {
  table.number("medium_m", medium_m_, "m", "Minimum extent of medium objects.", 0.01, 10);
  table.number("large_m", large_m_, "m", "Minimum extent of large objects.", 0.01, 10);
}

void SizeAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto geometry = cluster.annotations.first<types::GeometryAnnotation>();
    if (!geometry) continue;
    const double extent = types::from<Vector3d>(geometry.size.get()).maxCoeff();
    // An extent is good to about a centimetre (half of it: two ends): so sure is the word near a limit.
    constexpr double kScatter = 0.01;
    const double off = std::min(std::abs(extent - medium_m_), std::abs(extent - large_m_));
    const auto annotation = types::SizeAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(0.5 * (1 + std::erf(off / (kScatter * std::sqrt(2.0)))));
    annotation.extent.set(extent);
    annotation.size.set(extent < medium_m_ ? "small" : extent < large_m_ ? "medium" : "large");
    cluster.annotations.push_back(annotation);
  }
}

}  // namespace loci::perception

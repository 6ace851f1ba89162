#include "perception/annotators/description/recognition_annotators.h"

#include <algorithm>
#include <filesystem>

#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"
#include "perception/conversions/opencv.h"
#include "perception/recognition/barcode_reader.h"
#include "perception/recognition/image_features.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {
namespace {

/// Calls task(cluster, image, corner) for every cluster with an image; corner: where it lies in the
/// scene's image.
template <class Task>
void for_each_image(cas::Cas& cas, const Task& task) {
  for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const cv::Mat image = types::from<cv::Mat>(roi.image.get());
    if (!image.empty()) task(cluster, image, types::from<cv::Rect>(roi.roi.get()).tl());
  }
}

std::string category_of(const Product& product) {
  for (const auto& [key, value] : product.properties)
    if (key == "category") return value;
  return product.name;
}

/// The cluster whose image overlaps a region most, by at least `least` of both together; null = none.
types::Cluster cluster_at(const types::SceneCas& scene, const cv::Rect& region, double least) {
  types::Cluster best;
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const auto box = types::from<cv::Rect>(roi.roi.get());
    const double both = (box & region).area();
    const double overlap = both / std::max(1.0, box.area() + region.area() - both);
    if (overlap < least) continue;
    least = overlap;
    best = cluster;
  }
  return best;
}

types::Cluster new_cluster(const types::SceneCas& scene, const cv::Rect& region, const std::string& source) {
  const auto cluster = types::Cluster::create(scene.cas());
  add_image(cluster, source, {region, cv::Mat(region.size(), CV_8U, cv::Scalar(255))}, scene);
  scene.add_cluster(cluster);
  return cluster;
}

}  // namespace

AnnotatorDescriptor ProductAnnotator::descriptor() const {
  AnnotatorDescriptor descriptor{"ProductRecognition",
                                 "Recognises products of a catalogue by image features.",
                                 {"Cluster", "StandaloneImageROI"},
                                 {"ProductAnnotation", "ClassificationAnnotation"}};
  descriptor.needs_options = true;
  return descriptor;
}

void ProductAnnotator::declare(OptionTable& table) {
  table.text("index", path_, "Index file, written by `loci-perceive index`.");
  options_.declare(table);
}

void ProductAnnotator::start(Context& /*context*/) {
  if (path_.empty())
    throw Error("ProductRecognition has no index", {}, "give `index: FILE`, made by `loci-perceive index`");
  index_ = ProductIndex::load(path_);
}

void ProductAnnotator::process(cas::Cas& cas, Context& context) {
  for_each_image(cas, [&](const types::Cluster& cluster, const cv::Mat& image, cv::Point /*corner*/) {
    const std::vector<ProductMatch> matches = index_->recognise(image, options_, context.threads, 1);
    if (matches.empty() || !matches[0].verified) return;
    const Product& product = index_->products()[matches[0].product];
    const auto annotation = types::ProductAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(matches[0].confidence());
    annotation.name.set(product.name);
    for (const auto& [key, value] : product.properties) {
      const auto property = types::KeyValue::create(cas);
      property.key.set(key);
      property.value.set(value);
      annotation.properties.push_back(property);
    }
    cluster.annotations.push_back(annotation);
    const auto classified = types::ClassificationAnnotation::create(cas);
    classified.source.set(descriptor().name);
    classified.confidence.set(matches[0].confidence());
    classified.kind.set("product");
    classified.label.set(category_of(product));
    classified.feature.set("SIFT");
    cluster.annotations.push_back(classified);
  });
}

AnnotatorDescriptor BarcodeAnnotator::descriptor() const {
  return {"BarcodeReader",
          "Reads barcodes, QR, Data Matrix, PDF417 and Aztec codes on objects.",
          {"Cluster", "StandaloneImageROI"},
          {"BarcodeAnnotation"}};
}

void BarcodeAnnotator::declare(OptionTable& table) {
  table.flag("thorough", thorough_,
             "Also tries rotated and filtered versions of the image. Slow where there is no code.");
}

void BarcodeAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  for_each_image(cas, [&](const types::Cluster& cluster, const cv::Mat& image, cv::Point corner) {
    for (const Barcode& code : read_barcodes(image, thorough_)) {
      const auto annotation = types::BarcodeAnnotation::create(cas);
      annotation.source.set(descriptor().name);
      annotation.symbology.set(code.symbology);
      annotation.code.set(code.code);
      annotation.roi.set(types::to(cas, code.region + corner));
      cluster.annotations.push_back(annotation);
    }
  });
}

AnnotatorDescriptor TextAnnotator::descriptor() const {
  return {"TextReader",
          "Reads the words printed on objects.",
          {"Cluster", "StandaloneImageROI"},
          {"TextAnnotation"}};
}

void TextAnnotator::declare(OptionTable& table) {
  table.text("language", language_, "Tesseract's name of the language.");
  table.number("min_confidence", min_confidence_, "", "Minimum confidence of a word.", 0, 1);
  table.integer("max_words", max_words_, "", "Maximum number of words per object.", 1, 1000);
}

void TextAnnotator::start(Context& /*context*/) {
  reader_.emplace(language_);
}

void TextAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  for_each_image(cas, [&](const types::Cluster& cluster, const cv::Mat& image, cv::Point corner) {
    for (const RankedWord& word :
         rank_words(reader_->read(image, min_confidence_), static_cast<size_t>(max_words_))) {
      const auto annotation = types::TextAnnotation::create(cas);
      annotation.source.set(descriptor().name);
      annotation.confidence.set(word.confidence);
      annotation.text.set(word.word);
      const std::vector<std::string> words(1, word.word);
      annotation.words.set(words);
      annotation.roi.set(types::to(cas, word.region + corner));
      cluster.annotations.push_back(annotation);
    }
  });
}

AnnotatorDescriptor TemplateAnnotator::descriptor() const {
  AnnotatorDescriptor descriptor{"TemplateDetector",
                                 "Detects known views of objects in the whole image (LINEMOD).",
                                 {"Scene", "view:color", "view:depth"},
                                 {"ClassificationAnnotation", "Cluster", "StandaloneImageROI"},
                                 {"Cluster", "StandaloneImageROI"}};
  descriptor.needs_options = true;
  return descriptor;
}

void TemplateAnnotator::declare(OptionTable& table) {
  table.text("templates", path_, "Template file, written by `loci-perceive train --templates`.");
  table.text("kind", kind_, "Kind of the names: object, shape, ...");
  table.flag("hypotheses", hypotheses_, "Adds a cluster without points for detections outside of clusters.");
  options_.declare(table);
}

void TemplateAnnotator::start(Context& /*context*/) {
  if (path_.empty())
    throw Error("TemplateDetector has no templates", {},
                "give `templates: FILE`, made by `loci-perceive train --templates`");
  detector_ = TemplateDetector::load(path_);
}

void TemplateAnnotator::process(cas::Cas& cas, Context& context) {
  constexpr double kSameThing = 0.3;
  const types::SceneCas scene(cas);
  const cv::Mat color = types::view_image(scene, types::SceneCas::kColor),
                depth = types::view_image(scene, types::SceneCas::kDepth);
  if (color.size() != depth.size()) {
    context.warnings.add("TemplateDetector: colour and depth are not of the same size");
    return;
  }
  for (const TemplateMatch& match : detector_->detect(color, depth, options_)) {
    types::Cluster cluster = cluster_at(scene, match.region, kSameThing);
    if (!cluster && !hypotheses_) continue;
    if (!cluster) cluster = new_cluster(scene, match.region, descriptor().name);
    const auto annotation = types::ClassificationAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(match.similarity);
    annotation.kind.set(kind_);
    annotation.label.set(match.name);
    annotation.feature.set("gradients+normals");
    annotation.classifier.set("LINEMOD");
    annotation.model.set(std::filesystem::path(path_).stem().string());
    cluster.annotations.push_back(annotation);
  }
}

AnnotatorDescriptor PerceptualHashAnnotator::descriptor() const {
  return {"PerceptualHash",
          "Computes a perceptual hash and mean cell colours of each object's image, for change detection.",
          {"Cluster", "StandaloneImageROI"},
          {"StandaloneImageROI.phash"}};
}

void PerceptualHashAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const cv::Mat image = types::from<cv::Mat>(roi.image.get());
    if (image.empty() || image.type() != CV_8UC3) continue;
    roi.phash.set(static_cast<int64_t>(perceptual_hash(image)));
    const cv::Mat colors = cell_colors(image);
    const auto* begin = colors.ptr<float>();
    roi.cell_colors.set(std::vector<float>(begin, begin + colors.total() * 3));
  }
}

}  // namespace loci::perception

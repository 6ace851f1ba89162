#include "perception/annotators/description/recognition_annotators.h"

#include <algorithm>

#include "perception/conversions/opencv.h"
#include "perception/recognition/barcode_reader.h"
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

}  // namespace

AnnotatorDescriptor ProductAnnotator::descriptor() const {
  AnnotatorDescriptor descriptor{"ProductRecognition",
                                 "Recognises products of a catalogue by their images.",
                                 {"Cluster", "StandaloneImageROI"},
                                 {"ProductAnnotation", "ClassificationAnnotation"}};
  descriptor.needs_options = true;
  return descriptor;
}

void ProductAnnotator::declare(OptionTable& table) {
  table.text("index", path_, "Made by `loci-perceive index`.");
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
          "Reads barcodes and QR codes on objects.",
          {"Cluster", "StandaloneImageROI"},
          {"BarcodeAnnotation"}};
}

void BarcodeAnnotator::declare(OptionTable& table) {
  table.flag("thorough", thorough_, "Try changed images, too: slow where there is no code.");
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
  table.text("language", language_, "As Tesseract names it.");
  table.number("min_confidence", min_confidence_, "", "Words that are less sure are left out.", 0, 1);
  table.integer("max_words", max_words_, "", "So many words of each object.", 1, 1000);
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

}  // namespace loci::perception

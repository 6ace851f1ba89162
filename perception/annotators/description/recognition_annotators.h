#pragma once

#include <optional>

#include "perception/pipeline/annotator.h"
#include "perception/recognition/product_index.h"
#include "perception/recognition/template_detector.h"
#include "perception/recognition/text_reader.h"

namespace loci::perception {

/// Names each object's product (§5.3): a ProductAnnotation with what the catalogue says, and a
/// ClassificationAnnotation with its category (its name where the catalogue has none).
class ProductAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::string path_;
  RecognitionOptions options_;
  std::optional<ProductIndex> index_;
};

/// Barcodes and codes of areas on objects.
class BarcodeAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  bool thorough_ = false;
};

/// Words printed on objects: one TextAnnotation for each of the words that describe it best (§5.4.5).
class TextAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::string language_ = "eng";
  double min_confidence_ = 0.6;
  int max_words_ = 5;
  std::optional<TextReader> reader_;
};

/// Finds objects in the whole image as they were shown before (LINEMOD): what a cluster shows is annotated,
/// elsewhere a match is a hypothesis of its own.
class TemplateAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::string path_;
  std::string kind_ = "object";
  bool hypotheses_ = false;
  TemplateOptions options_;
  std::optional<TemplateDetector> detector_;
};

/// Makes regions of the image comparable (§3.2.2): a perceptual hash, and what that does not tell, colours.
class PerceptualHashAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void process(cas::Cas& cas, Context& context) override;
};

}  // namespace loci::perception

#pragma once

#include <optional>
#include <string>

#include "perception/detection/image_encoder.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// A vector of each object's image by a network: an ImageFeatureAnnotation, which similarity and search by
/// text use.
class NetworkEmbedding : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::string path_;
  std::optional<ImageEncoder> encoder_;
};

}  // namespace loci::perception

#pragma once

#include <memory>

#include "perception/pipeline/annotator.h"
#include "perception/search/search_client.h"

namespace loci::perception {

/// Asks a visual-search server about each object (§5.4): a VisualSearchAnnotation per result, and besides
/// what the category means (product, text, book, logo, landmark, similar image, barcode, what somebody
/// submitted), and a TermsAnnotation with the words that the whole answer repeats most (§5.4.5). The
/// perceptual hash of each image is kept with it.
///
/// Images are sent several at a time. A server that is away is an error, for the step's policy; one that
/// refuses an image is a warning. Answers take their time: put `asynchronous: true` beside it.
class VisualSearch : public Annotator {
 public:
  /// Asks nobody until it is told whom.
  VisualSearch() { options_.server.clear(); }
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  SearchOptions options_;
  int at_once_ = 4;
  int max_terms_ = 5;
  std::shared_ptr<SearchClient> client_;
};

}  // namespace loci::perception

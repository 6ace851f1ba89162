#include "perception/annotators/description/visual_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "mapping/base/parallel.h"
#include "perception/conversions/opencv.h"
#include "perception/recognition/image_features.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {
namespace {

/// One object's image, what became of the question, and where the image lies in the scene's.
struct Question {
  types::Cluster cluster;
  cv::Mat image;
  cv::Point corner;
  std::optional<SearchClient::Outcome> outcome;
  std::string refused;
};

std::vector<Question> questions(cas::Cas& cas) {
  std::vector<Question> all;
  for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const cv::Mat image = types::from<cv::Mat>(roi.image.get());
    if (image.empty() || image.type() != CV_8UC3) continue;
    if (!roi.phash.is_set()) roi.phash.set(static_cast<int64_t>(perceptual_hash(image)));
    all.push_back({cluster, image, types::from<cv::Rect>(roi.roi.get()).tl(), {}, {}});
  }
  return all;
}

/// Makes annotations of the results for one object.
class Writer {
 public:
  Writer(cas::Cas& cas, const Question& question) : cas_(cas), question_(question) {}

  void write(const SearchResult& result) const {
    write_generic(result);
    switch (result.category) {
      case SearchCategory::kProduct:
        return write_product(annotation<types::ProductAnnotation>(result), result);
      case SearchCategory::kBook:
        return write_book(result);
      case SearchCategory::kText:
        return write_text(result);
      case SearchCategory::kLogo: {
        const auto logo = placed<types::LogoAnnotation>(result);
        return logo.brand.set(result.title);
      }
      case SearchCategory::kLandmark: {
        const auto landmark = placed<types::LandmarkAnnotation>(result);
        landmark.name.set(result.title);
        return set(landmark.location, result.property("location"));
      }
      case SearchCategory::kSimilarImage: {
        const auto similar = placed<types::SimilarImageAnnotation>(result);
        similar.name.set(result.title);
        set(similar.image_url, image_of(result));
        return set(similar.site_url, result.property("image_site"));
      }
      case SearchCategory::kBarcode: {
        const auto code = placed<types::BarcodeAnnotation>(result);
        code.code.set(result.title);
        return code.symbology.set(result.category_text.substr(0, result.category_text.find(' ')));
      }
      case SearchCategory::kUserSubmitted:
        return write_submitted(result);
      case SearchCategory::kOther:
        return;
    }
  }

  void write_terms(const std::vector<RankedWord>& words) const {
    if (words.empty()) return;
    std::vector<std::string> terms;
    std::vector<int32_t> counts;
    for (const RankedWord& word : words) {
      terms.push_back(word.word);
      counts.push_back(word.count);
    }
    const auto annotation = types::TermsAnnotation::create(cas_);
    annotation.terms.set(terms);
    annotation.counts.set(counts);
    question_.cluster.annotations.push_back(annotation);
  }

 private:
  template <class A>
  A annotation(const SearchResult& result) const {
    const A made = A::create(cas_);
    const std::string confidence = result.property("confidence");
    char* end = nullptr;
    const double value = std::strtod(confidence.c_str(), &end);
    if (end != confidence.c_str() && value >= 0 && value <= 1) made.confidence.set(value);
    question_.cluster.annotations.push_back(made);
    return made;
  }

  template <class A>
  A placed(const SearchResult& result) const {
    const A made = annotation<A>(result);
    if (!result.region.empty()) made.roi.set(types::to(cas_, result.region + question_.corner));
    return made;
  }

  template <class Feature>
  static void set(const Feature& feature, const std::string& text) {
    if (!text.empty()) feature.set(text);
  }

  static std::string image_of(const SearchResult& result) {
    const std::string large = result.property("image_url");
    return large.empty() ? result.preview_url : large;
  }

  template <class List>
  void write_properties(const List& list, const SearchResult& result) const {
    for (const auto& [key, value] : result.properties) {
      const auto property = types::KeyValue::create(cas_);
      property.key.set(key);
      property.value.set(value);
      list.push_back(property);
    }
  }

  void write_generic(const SearchResult& result) const {
    const auto made = placed<types::VisualSearchAnnotation>(result);
    made.category.set(name_of(result.category));
    made.title.set(result.title);
    set(made.language, result.language);
    set(made.result_text, result.text);
    set(made.description, result.description);
    set(made.preview_url, result.preview_url);
    for (const auto& [name, url] : result.links) {
      const auto link = types::NamedLink::create(cas_);
      link.name.set(name);
      link.url.set(url);
      made.links.push_back(link);
    }
    write_properties(made.properties, result);
  }

  void write_product(const types::ProductAnnotation& product, const SearchResult& result) const {
    product.name.set(result.title);
    write_properties(product.properties, result);
  }

  void write_book(const SearchResult& result) const {
    const auto book = annotation<types::BookAnnotation>(result);
    write_product(book, result);
    set(book.authors, result.property("authors"));
    set(book.publisher, result.property("publisher"));
    set(book.year, result.property("year"));
    set(book.isbn, result.property("isbn"));
  }

  void write_text(const SearchResult& result) const {
    const auto text = placed<types::TextAnnotation>(result);
    text.text.set(result.text.empty() ? result.title : result.text);
    set(text.language, result.language);
    std::vector<std::string> words;
    for (const SearchWord& word : result.words) {
      words.push_back(word.text);
      const auto place = types::TextWord::create(cas_);
      place.text.set(word.text);
      place.roi.set(types::to(cas_, word.region + question_.corner));
      text.word_places.push_back(place);
    }
    text.words.set(words);
    if (!result.translations.empty()) text.translations.set(result.translations);
  }

  void write_submitted(const SearchResult& result) const {
    const auto submitted = placed<types::UserSubmittedAnnotation>(result);
    submitted.name.set(result.title);
    set(submitted.text, result.property("user_text"));
    set(submitted.uploader, result.property("uploader"));
    set(submitted.uploader_url, result.property("uploader_url"));
    set(submitted.image_url, image_of(result));
  }

  cas::Cas& cas_;
  const Question& question_;
};

}  // namespace

AnnotatorDescriptor VisualSearch::descriptor() const {
  AnnotatorDescriptor descriptor{
      "VisualSearch",
      "Sends each object's image to a visual-search server and annotates the results.",
      {"Cluster", "StandaloneImageROI"},
      {"VisualSearchAnnotation", "ProductAnnotation", "BookAnnotation", "TextAnnotation", "LogoAnnotation",
       "LandmarkAnnotation", "SimilarImageAnnotation", "BarcodeAnnotation", "UserSubmittedAnnotation",
       "TermsAnnotation"}};
  descriptor.modifies = {"StandaloneImageROI.phash"};
  descriptor.needs_options = true;
  return descriptor;
}

void VisualSearch::declare(OptionTable& table) {
  options_.declare(table);
  table.integer("at_once", at_once_, "", "Number of concurrent requests.", 1, 64);
  table.integer("max_terms", max_terms_, "", "Maximum number of descriptive words per object.", 1, 1000);
}

void VisualSearch::start(Context& /*context*/) {
  if (options_.server.empty())
    throw Error("VisualSearch has no server", {},
                "give `server: http://…`; `loci-perceive serve --index FILE` is one");
  client_ = std::make_shared<SearchClient>(options_);
}

void VisualSearch::process(cas::Cas& cas, Context& context) {
  std::vector<Question> all = questions(cas);
  parallel_each(all.size(), at_once_, [&](size_t i) {
    try {
      all[i].outcome = client_->search(all[i].image);
    } catch (const ServerAway&) {
      throw;
    } catch (const Error& error) {
      all[i].refused = error.what();
    }
  });
  for (const Question& question : all) {
    if (!question.outcome) {
      context.warnings.add("VisualSearch: " + question.refused);
      continue;
    }
    const Writer writer(cas, question);
    const SearchAnswer& answer = question.outcome->answer;
    for (const SearchResult& result : answer.results) writer.write(result);
    writer.write_terms(terms_of(answer, static_cast<size_t>(max_terms_)));
    for (const std::string& unknown : answer.unknown)
      context.warnings.add("VisualSearch: the protocol does not name " + unknown);
  }
}

}  // namespace loci::perception

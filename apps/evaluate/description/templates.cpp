#include "apps/evaluate/description/templates.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>
#include <set>

#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "perception/annotators/io/labelled_recording.h"
#include "perception/recognition/template_detector.h"

namespace loci::apps::description_evaluation {
namespace {

constexpr double kSameObject = 0.4;

void judge(const perception::TemplateMatch& match, const std::vector<perception::LabelledPart>& parts,
           const std::string& frame, TemplatesResult& result) {
  const perception::LabelledPart* best = nullptr;
  double most = kSameObject;
  for (const perception::LabelledPart& part : parts) {
    const cv::Rect box = cv::boundingRect(part.mask);
    const double both = (box & match.region).area();
    const double overlap = both / (box.area() + match.region.area() - both);
    if (overlap < most) continue;
    most = overlap;
    best = &part;
  }
  const bool right = best && best->label == match.name;
  ++(right ? result.right : result.wrong);
  if (!right)
    result.mistakes.push_back(fmt::format("{}: {} ({:.2f}) where there is {}", frame, match.name,
                                          match.similarity, best ? best->label : "no such object"));
}

}  // namespace

TemplatesResult evaluate_templates(const std::filesystem::path& folder, Progress& progress) {
  const perception::LabelledRecording labelled = perception::open_labelled_recording(folder);
  TemplatesResult result;
  const size_t frames = labelled.recording->size();
  for (const size_t half : {0u, 1u}) {
    perception::TemplateDetector detector;
    std::set<std::string> known;
    for (size_t i = half; i < frames; i += 2) {
      const mapping::RgbdFrame frame = labelled.recording->frame(i);
      for (const perception::LabelledPart& part : labelled_parts(labelled, frame.name))
        if (detector.add(part.label, frame.color, frame.depth, part.mask) > 0) known.insert(part.label);
    }
    result.templates += detector.templates();
    for (size_t i = 1 - half; i < frames; i += 2) {
      progress.check((static_cast<double>(half) + static_cast<double>(i) / static_cast<double>(frames)) / 2,
                     "templates");
      const mapping::RgbdFrame frame = labelled.recording->frame(i);
      const std::vector<perception::LabelledPart> parts = labelled_parts(labelled, frame.name);
      for (const perception::LabelledPart& part : parts) result.samples += known.contains(part.label);
      const Stopwatch watch;
      const std::vector<perception::TemplateMatch> matches = detector.detect(frame.color, frame.depth, {});
      result.seconds += watch.seconds();
      ++result.images;
      for (const perception::TemplateMatch& match : matches) judge(match, parts, frame.name, result);
    }
  }
  result.seconds /= static_cast<double>(std::max<size_t>(1, result.images));
  return result;
}

std::string TemplatesResult::text() const {
  std::string text = fmt::format(
      "templates: {} of {} objects found in {} images, {} wrong matches; {} templates in both halves, "
      "{:.2f} s a "
      "image\n",
      right, samples, images, wrong, templates, seconds);
  for (const std::string& mistake : mistakes) text += "  " + mistake + "\n";
  return text;
}

Json TemplatesResult::to_json() const {
  return {{"images", images}, {"templates", templates}, {"objects", samples},  {"right", right},
          {"wrong", wrong},   {"seconds", seconds},     {"mistakes", mistakes}};
}

}  // namespace loci::apps::description_evaluation

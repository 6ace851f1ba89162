#include "apps/evaluate/system/object_figure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mapping/base/base64.h"
#include "mapping/base/html.h"
#include "mapping/image/image_io.h"
#include "perception/conversions/opencv.h"

namespace loci::apps::system_evaluation {
namespace {

constexpr size_t kMaxNumbers = 8;  ///< of an array that are shown

std::string numbers_of(const perception::cas::FeatureStructure& array) {
  std::vector<std::string> shown;
  const auto add = [&](const auto& values, const char* format) {
    for (size_t i = 0; i < std::min(kMaxNumbers, values.size()); ++i)
      shown.push_back(fmt::format(fmt::runtime(format), values[i]));
  };
  switch (array.type().component_kind()) {
    case perception::cas::Kind::kString:
      add(array.elements<std::string>(), "{}");
      break;
    case perception::cas::Kind::kFloat:
      add(array.elements<float>(), "{:.3g}");
      break;
    case perception::cas::Kind::kDouble:
      add(array.elements<double>(), "{:.3g}");
      break;
    default:
      return fmt::format("{} elements", array.array_size());
  }
  return fmt::format("{}{}", fmt::join(shown, ", "), array.array_size() > kMaxNumbers ? ", …" : "");
}

/// A line per value; structures below are gone into, `deep` levels.
void add_lines(const perception::cas::FeatureStructure& structure, const std::string& indent, int deep,
               std::vector<std::string>& lines) {
  for (const perception::cas::Feature& feature : structure.type().features()) {
    if (!structure.is_set(feature)) continue;
    const perception::cas::Value& value = structure.value(feature);
    const std::string name = indent + feature.name() + ": ";
    if (const auto* text = std::get_if<std::string>(&value)) {
      lines.push_back(name + *text);
    } else if (const auto* number = std::get_if<double>(&value)) {
      lines.push_back(fmt::format("{}{:.4g}", name, *number));
    } else if (const auto* integer = std::get_if<int64_t>(&value)) {
      lines.push_back(fmt::format("{}{}", name, *integer));
    } else if (const auto* flag = std::get_if<bool>(&value)) {
      lines.push_back(fmt::format("{}{}", name, *flag));
    } else if (const auto below = structure.get<perception::cas::FeatureStructure>(feature); below) {
      if (below.type().kind() == perception::cas::Kind::kArray &&
          below.type().component_kind() != perception::cas::Kind::kStructure) {
        lines.push_back(name + numbers_of(below));
      } else if (deep > 0 && below.type().kind() == perception::cas::Kind::kStructure) {
        lines.push_back(name + below.type().short_name());
        add_lines(below, indent + "  ", deep - 1, lines);
      }
    }
  }
}

}  // namespace

size_t richness(const perception::types::Cluster& cluster) {
  size_t sum = 0;
  for (const perception::types::Annotation& annotation : cluster.annotations) {
    const perception::cas::FeatureStructure& structure = annotation;
    const bool telling = perception::types::is<perception::types::TextAnnotation>(structure) ||
                         perception::types::is<perception::types::BarcodeAnnotation>(structure) ||
                         perception::types::is<perception::types::ProductAnnotation>(structure);
    sum += telling ? 2 : 1;
  }
  return sum;
}

std::string object_svg(const perception::types::Cluster& cluster) {
  constexpr int kLine = 15, kImage = 220, kLeft = 250;
  std::string text;
  int y = 20;
  for (const perception::types::Annotation& annotation : cluster.annotations) {
    const perception::cas::FeatureStructure& structure = annotation;
    text += fmt::format("<text x='{}' y='{}' font-weight='bold'>{}</text>\n", kLeft, y,
                        html_escape(structure.type().short_name()));
    y += kLine;
    std::vector<std::string> lines;
    add_lines(structure, "", 2, lines);
    for (const std::string& line : lines) {
      text += fmt::format("<text x='{}' y='{}' xml:space='preserve'>{}</text>\n", kLeft + 14, y,
                          html_escape(line));
      y += kLine;
    }
    y += kLine / 2;
  }
  std::string image;
  if (const auto roi = cluster.hypotheses.first<perception::types::StandaloneImageROI>()) {
    const std::vector<unsigned char> png =
        mapping::encode_image(perception::types::from<cv::Mat>(roi.image.get()), ".png");
    image = fmt::format(
        "<image x='15' y='15' width='{0}' height='{0}' preserveAspectRatio='xMidYMin' "
        "href='data:image/png;base64,{1}'/>\n",
        kImage, base64_from_bytes(std::string_view(reinterpret_cast<const char*>(png.data()), png.size())));
  }
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
             "font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n",
             820, std::max(y, kImage + 30)) +
         image + text + "</svg>\n";
}

}  // namespace loci::apps::system_evaluation

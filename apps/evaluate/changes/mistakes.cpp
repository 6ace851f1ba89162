#include "apps/evaluate/changes/mistakes.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "mapping/base/text/html.h"
#include "mapping/image/image_io.h"

namespace loci::apps::changes {
namespace {

using memory::Id;
using memory::belief::AxisBox;

constexpr int kViewPixels = 320;     ///< width and height of a view
constexpr double kMinCrop = 120;     ///< pixels of the colour image
constexpr double kCropMargin = 1.5;  ///< of a crop, relative to the boxes in it
const cv::Scalar kTrueColor(60, 200, 60), kRememberedColor(220, 60, 220);  ///< BGR

/// The most probable first.
void sort(std::vector<Mistake>& mistakes) {
  std::ranges::stable_sort(mistakes, std::greater(), &Mistake::stated);
  if (mistakes.size() > kShownMistakes) mistakes.resize(kShownMistakes);
}

/// What the story has about an observation, by object.
std::vector<Competitor> competitors_of(const Told& told, Id observation) {
  std::map<std::string, double> probability;
  for (const memory::AssociationRow& row : told.alternatives) {
    if (row.observation != observation) continue;
    std::string name = row.object ? memory::object_name(*row.object) : "false cluster";
    if (row.explanation == memory::Explanation::appear) name += " (new)";
    probability[name] += row.probability;
  }
  std::vector<Competitor> competitors;
  for (const auto& [name, each] : probability) competitors.push_back({name, each});
  std::ranges::stable_sort(competitors, std::greater(), &Competitor::probability);
  return competitors;
}

/// Corners of a box in the colour image; empty where one is behind the camera.
std::vector<cv::Point2d> corners_in_image(const AxisBox& box, const Isometry3d& color_from_map,
                                          const mapping::PinholeCamera& camera) {
  std::vector<cv::Point2d> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3d sign((i & 1) ? 0.5 : -0.5, (i & 2) ? 0.5 : -0.5, (i & 4) ? 0.5 : -0.5);
    const Vector3d point = color_from_map * (box.centre + sign.cwiseProduct(box.size));
    if (point.z() < 0.1) return {};
    const Vector2d pixel = camera.project(point);
    corners.emplace_back(pixel.x(), pixel.y());
  }
  return corners;
}

struct DrawnBox {
  std::vector<cv::Point2d> corners;
  cv::Scalar color;
  int width = 1;
};

/// The part of an image with boxes around its objects; empty where none of them is in it.
cv::Mat crop(const cv::Mat& image, const std::vector<DrawnBox>& boxes) {
  std::vector<cv::Point2f> points;
  for (const DrawnBox& box : boxes) points.insert(points.end(), box.corners.begin(), box.corners.end());
  if (points.empty()) return {};
  const cv::Rect2f all = cv::boundingRect(points);
  const double side = std::min(std::max(kCropMargin * std::max<double>(all.width, all.height), kMinCrop),
                               double(std::min(image.cols, image.rows)));
  const cv::Point2d corner(all.x + all.width / 2 - side / 2, all.y + all.height / 2 - side / 2);
  const cv::Rect part =
      cv::Rect(cv::Point(corner), cv::Size(int(side), int(side))) & cv::Rect(0, 0, image.cols, image.rows);
  if (part.empty()) return {};
  const double scale = kViewPixels / side;
  cv::Mat view;
  cv::resize(image(part), view, {}, scale, scale, cv::INTER_LINEAR);
  for (const DrawnBox& box : boxes) {
    const auto pixel = [&](int i) {
      const cv::Point2d p = box.corners[static_cast<size_t>(i)];
      return cv::Point(int(scale * (p.x - part.x)), int(scale * (p.y - part.y)));
    };
    for (int i = 0; i < (box.corners.empty() ? 0 : 8); ++i)
      for (const int axis : {1, 2, 4})
        if (!(i & axis)) cv::line(view, pixel(i), pixel(i | axis), box.color, box.width, cv::LINE_AA);
  }
  return view;
}

class MistakeReader {
 public:
  MistakeReader(const Truth& truth, const Moments& moments, const Story& story,
                const mapping::Recording& recording)
      : truth_(truth), moments_(moments), story_(story), recording_(recording) {
    for (size_t i = 0; i < recording.size(); ++i) number_of_[recording.index_of(i)] = i;
  }

  /// Without views.
  Mistake read(const JudgedTransition& transition) const {
    Mistake mistake{std::filesystem::path(recording_.info().path).filename().string(), transition};
    const auto told = story_.find(transition.truth.to_frame);
    if (told == story_.end()) return mistake;
    const Id remembered = stated_object(transition);
    // Where it was not found before, what was stated afterwards is not the mistake.
    if (transition.said == "not found" && remembered != 0) return mistake;
    Id observation = transition.to_observation;
    for (const auto& [other, object] : told->second.object_of)
      if (transition.truth.kind == "removed" && object == remembered) observation = other;
    mistake.competitors = competitors_of(told->second, observation);
    const bool same = transition.from_object == transition.to_object;
    for (const memory::AssociationRow& row : told->second.alternatives)
      if (observation != 0 && row.observation == observation && row.object.value_or(0) == remembered &&
          (row.chosen || !same))
        mistake.stated += row.probability;
      else if (observation == 0 && !row.observation && row.object == remembered &&
               row.explanation != memory::Explanation::disappear)
        mistake.stated += row.probability;
    return mistake;
  }

  void add_views(Mistake& mistake) const {
    const TrueTransition& truth = mistake.transition.truth;
    const Id from = mistake.transition.from_object, to = stated_object(mistake.transition);
    const auto before = last_sight(from != 0 ? from : to, truth.to_frame - 1);
    // Of what is new, the frame that shows what it was taken for.
    const int64_t frame = truth.kind == "added" && before ? before->first : truth.from_frame;
    const bool came_with_it = truth.kind == "added" && frame >= truth.to_frame;
    if (!came_with_it) mistake.before = view(frame, truth.object, from != 0 ? from : to);
    mistake.after = view(truth.to_frame, truth.object, to);
  }

 private:
  /// What it was taken for at the end of the transition.
  static Id stated_object(const JudgedTransition& transition) {
    return transition.truth.kind == "removed" ? transition.from_object : transition.to_object;
  }

  /// Where an object was seen last, up to a frame.
  std::optional<std::pair<int64_t, AxisBox>> last_sight(Id object, int64_t until) const {
    for (auto told = story_.upper_bound(until); object != 0 && told != story_.begin();) {
      --told;
      const auto moment = moments_.find(told->first);
      if (moment == moments_.end()) continue;
      for (const Sight& sight : moment->second.sights) {
        const auto found = told->second.object_of.find(sight.observation);
        if (found != told->second.object_of.end() && found->second == object)
          return std::pair(told->first, sight.evidence.box);
      }
    }
    return std::nullopt;
  }

  MistakeView view(int64_t frame, const std::string& true_object, Id object) const {
    MistakeView view{frame, {}};
    const auto number = number_of_.find(frame);
    const auto moment = moments_.find(frame);
    if (number == number_of_.end() || moment == moments_.end()) return view;
    const mapping::RgbdFrame image = recording_.frame(number->second);
    if (image.color.empty()) return view;
    const Isometry3d color_from_map =
        (moment->second.map_from_camera * image.camera.depth_from_color).inverse();
    std::vector<DrawnBox> boxes;
    const auto visible = truth_.visible.find(frame);
    if (visible != truth_.visible.end())
      for (const TrueObject& each : visible->second)
        if (each.name == true_object)
          boxes.push_back({corners_in_image({each.centre, each.size}, color_from_map, image.camera.color),
                           kTrueColor, 3});
    if (const auto sight = last_sight(object, frame))
      boxes.push_back(
          {corners_in_image(sight->second, color_from_map, image.camera.color), kRememberedColor});
    view.image = crop(image.color, boxes);
    return view;
  }

  const Truth& truth_;
  const Moments& moments_;
  const Story& story_;
  const mapping::Recording& recording_;
  std::map<int64_t, size_t> number_of_;
};

std::string figure(const MistakeView& view, const std::string& title) {
  const std::string caption = fmt::format("{}, frame {}", title, view.frame);
  if (view.image.empty()) return "";
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                     html_image(mapping::encode_image(view.image, ".jpg"), "image/jpeg", caption),
                     html_escape(caption));
}

std::string section(size_t number, const Mistake& mistake) {
  const JudgedTransition& transition = mistake.transition;
  const auto name = [](Id id) { return id == 0 ? std::string("-") : memory::object_name(id); };
  const std::string stated =
      mistake.stated > 0 ? fmt::format("{:.3f}", mistake.stated) : std::string("nothing was found");
  std::vector<std::vector<std::string>> competitors;
  for (const Competitor& competitor : mistake.competitors)
    competitors.push_back({competitor.name, fmt::format("{:.3f}", competitor.probability)});
  const std::string body = html_table({"true", "stated", "probability", "object before", "object after"},
                                      {{transition.truth.kind, transition.said, stated,
                                        name(transition.from_object), name(transition.to_object)}}) +
                           "<div style=\"display:flex;flex-wrap:wrap;gap:.75rem\">\n" +
                           figure(mistake.before, "before") + figure(mistake.after, "after") + "</div>\n" +
                           (competitors.empty() ? "" : html_table({"may be", "probability"}, competitors));
  return html_section(fmt::format("mistake_{}", number),
                      fmt::format("{}. {} in {}, frames {} to {}", number, transition.truth.object,
                                  mistake.recording, transition.truth.from_frame, transition.truth.to_frame),
                      body);
}

}  // namespace

std::vector<Mistake> worst_mistakes(const Comparison& comparison, const Truth& truth, const Moments& moments,
                                    const Story& story, const mapping::Recording& recording) {
  const MistakeReader reader(truth, moments, story, recording);
  std::vector<Mistake> mistakes;
  for (const JudgedTransition& transition : comparison.transitions)
    if (transition.counts() && !transition.right()) mistakes.push_back(reader.read(transition));
  sort(mistakes);
  for (Mistake& mistake : mistakes) reader.add_views(mistake);
  return mistakes;
}

std::vector<Mistake> worst_mistakes(const Comparison& comparison, const std::filesystem::path& folder,
                                    const mapping::Recording& recording, const memory::Store& store) {
  const Moments moments = read_moments(store);
  return worst_mistakes(comparison, read_truth(folder, recording), moments, memory_story(store, moments),
                        recording);
}

std::string mistakes_page(std::vector<Mistake> mistakes) {
  sort(mistakes);
  std::string sections =
      "<p>Wrong transitions that were stated with the highest probability. The true box is green, the box of "
      "the remembered object magenta.</p>\n";
  for (size_t i = 0; i < mistakes.size(); ++i) sections += section(i + 1, mistakes[i]);
  return html_page("The worst mistakes", sections);
}

}  // namespace loci::apps::changes

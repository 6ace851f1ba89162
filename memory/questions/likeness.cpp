#include "memory/questions/likeness.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/image/image_io.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

constexpr size_t kMaxImages = 12;  // the latest of an object

/// Hue by saturation where there is colour, and grey levels where there is none; sums to 1. The middle counts
/// most: the corners of a crop show what is behind.
cv::Mat histogram_of(const cv::Mat& image) {
  constexpr int kHues = 12, kSaturations = 3, kGreys = 6;
  cv::Mat small, hsv;
  cv::resize(image, small, {32, 32}, 0, 0, cv::INTER_AREA);
  cv::cvtColor(small, hsv, cv::COLOR_BGR2HSV);
  cv::Mat histogram = cv::Mat::zeros(1, kHues * kSaturations + kGreys, CV_32F);
  for (int v = 0; v < hsv.rows; ++v)
    for (int u = 0; u < hsv.cols; ++u) {
      const auto& pixel = hsv.at<cv::Vec3b>(v, u);
      const float off = static_cast<float>(std::hypot(u - 15.5, v - 15.5)) / 16;
      const float weight = std::exp(-2 * off * off);
      if (pixel[1] < 50 || pixel[2] < 30) {
        histogram.at<float>(kHues * kSaturations + pixel[2] * kGreys / 256) += weight;
        continue;
      }
      // Between two hues it counts for both: red is at the end of the circle and at its beginning.
      const float hue = static_cast<float>(pixel[0]) / 180 * kHues;
      const float part = hue - std::floor(hue);
      const int saturation = (pixel[1] - 50) * kSaturations / 206;
      const int lower = static_cast<int>(hue) % kHues;
      histogram.at<float>(lower * kSaturations + saturation) += weight * (1 - part);
      histogram.at<float>((lower + 1) % kHues * kSaturations + saturation) += weight * part;
    }
  return histogram / cv::sum(histogram)[0];
}

float shared(const cv::Mat& a, const cv::Mat& b) {
  return static_cast<float>(cv::sum(cv::min(a, b))[0]);
}

struct Image {
  cv::Mat histogram = {};
  Id scene = 0;
};

std::vector<Image> images_of(const Snapshot& snapshot, Id object) {
  std::vector<Image> images;
  const std::vector<ObjectObservation> sightings = snapshot.store().observations_of(object, snapshot.as_of());
  for (auto sighting = sightings.rbegin(); sighting != sightings.rend(); ++sighting) {
    if (!sighting->observation.crop) continue;
    const std::string bytes = snapshot.store().blob(*sighting->observation.crop).bytes;
    images.push_back({histogram_of(mapping::decode_image({bytes.begin(), bytes.end()}, object_name(object))),
                      sighting->association.scene});
    if (images.size() == kMaxImages) break;
  }
  return images;
}

}  // namespace

LikeAnswer ask(const Store& store, const LikeQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  LikeAnswer answer{.asked = question.subject};
  std::vector<Image> wanted;
  std::optional<Id> self;
  if (question.image.empty()) {
    self = snapshot.find_objects(question.subject).at(0);
    answer.asked = object_name(*self);
    wanted = images_of(snapshot, *self);
    if (wanted.empty())
      throw Error(fmt::format("no image of {} was kept", answer.asked), {}, "give an image with --image");
  } else {
    answer.asked = question.image.filename().string();
    wanted.push_back({histogram_of(mapping::read_color(question.image)), 0});
  }
  for (const BeliefRow& belief : snapshot.beliefs()) {
    if (belief.object == self) continue;
    LikeObject like{.object = snapshot.state(belief)};
    for (const Image& image : images_of(snapshot, belief.object))
      for (const Image& one : wanted)
        if (const double likeness = static_cast<double>(shared(image.histogram, one.histogram));
            !like.scene || likeness > like.likeness) {
          like.likeness = likeness;
          like.scene = snapshot.scene_ref(image.scene);
        }
    if (like.scene) answer.objects.push_back(std::move(like));
  }
  std::stable_sort(answer.objects.begin(), answer.objects.end(),
                   [](const LikeObject& a, const LikeObject& b) { return a.likeness > b.likeness; });
  return answer;
}

}  // namespace loci::memory

#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/sensor/frame.h"

namespace loci::perception {

/// A frame in which people are looked for.
struct PeopleFrame {
  cv::Mat color;      ///< CV_8UC3, BGR
  cv::Mat points;     ///< CV_32FC3, depth camera's frame, metres, NaN = no measurement; empty = colour only
  cv::Mat explained;  ///< CV_8U, not 0 = on a surface of the map; empty = not known
  mapping::RgbdCamera camera;                 ///< with points only
  std::optional<Isometry3d> map_from_camera;  ///< z up; unset = the camera is taken to be held upright
};

/// A person in the colour image.
struct Person {
  cv::Rect body;  ///< inside the image, pixels; that of the head where nothing else was found
  cv::Rect head;  ///< likewise: what anonymise() blurs; empty of an arm
  bool has_face = false;
  double score = 0;         ///< uncalibrated, 0 to 1
  std::vector<int> pixels;  ///< of the depth image, row · width + column, ascending
};

/// Finds faces (cascade of Lienhart and Maydt) and standing bodies (HOG, Dalal and Triggs) with the models of
/// OpenCV. With depth, only what stands out as a head of the size of people on something below it is looked
/// at: that is quick, and walls, posters and furniture are no people. Without depth the whole image is
/// searched at all sizes.
class PeopleDetector {
 public:
  PeopleDetector();
  ~PeopleDetector();
  PeopleDetector(PeopleDetector&&) noexcept;
  PeopleDetector& operator=(PeopleDetector&&) noexcept;

  std::vector<Person> detect(const PeopleFrame& frame);

 private:
  struct Models;
  std::unique_ptr<Models> models_;
};

/// Blurs the heads of all people in a frame, for whoever stores or exports its image.
void anonymise(mapping::RgbdFrame& frame, PeopleDetector& detector);

/// Blurs the heads beyond recognition. `offset`: top left corner of the image in that of the rectangles.
void anonymise(cv::Mat& image, const std::vector<cv::Rect>& heads, const cv::Point& offset = {});

}  // namespace loci::perception

#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/sensor/camera.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

namespace loci::perception::types {

/// Images share memory both ways. `to` keeps the image's memory when its rows are continuous and
/// reference-counted (otherwise it copies): nobody may write to the image afterwards. `from` gives an image
/// on the memory of the CAS, which it keeps alive: read it, or clone() it to write.
template <>
struct Conversion<cv::Mat> {
  using Proxy = Mat;
  static Mat to(cas::Cas& cas, const cv::Mat& image);
  static cv::Mat from(const Mat& proxy);
};

/// The same with an element type, which is checked.
template <typename T>
struct Conversion<cv::Mat_<T>> {
  using Proxy = Mat;
  static Mat to(cas::Cas& cas, const cv::Mat_<T>& image) { return Conversion<cv::Mat>::to(cas, image); }
  static cv::Mat_<T> from(const Mat& proxy) {
    cv::Mat image = Conversion<cv::Mat>::from(proxy);
    if (image.type() != cv::traits::Type<T>::value)
      throw Error("an image of type " + cv::typeToString(image.type()) + " is not of type " +
                  cv::typeToString(cv::traits::Type<T>::value));
    return image;
  }
};

template <>
struct Conversion<cv::Rect> {
  using Proxy = Rect;
  static Rect to(cas::Cas& cas, const cv::Rect& rect);
  static cv::Rect from(const Rect& proxy);
};

/// The image of a view (SceneCas::kColor, ...) as cv::Mat, without copying. Throws Error when there is none.
inline cv::Mat view_image(const SceneCas& cas, std::string_view view) {
  return from<cv::Mat>(cas.image(view));
}

/// Makes an image the subject of a view.
inline void set_view_image(const SceneCas& cas, std::string_view view, const cv::Mat& image) {
  cas.set_image(view, to(cas.cas(), image));
}

template <>
struct Conversion<mapping::PinholeCamera> {
  using Proxy = CameraInfo;
  static CameraInfo to(cas::Cas& cas, const mapping::PinholeCamera& camera);
  static mapping::PinholeCamera from(const CameraInfo& proxy);
};

/// The heads of the people in a scene, in its colour image.
std::vector<cv::Rect> heads_of_people(const Scene& scene);

/// Both cameras of a sensor become the scene's cameras "depth" and "color".
void set_cameras(const SceneCas& cas, const mapping::RgbdCamera& camera);

/// Throws Error when the scene has no such cameras.
mapping::RgbdCamera cameras(const SceneCas& cas);

/// The points without those that surely lie inside their convex hull, which is found much faster among the
/// rest: within the octagon of the outermost points in eight directions.
std::vector<cv::Point2f> near_hull(const std::vector<cv::Point2f>& points);

}  // namespace loci::perception::types

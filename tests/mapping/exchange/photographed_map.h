#pragma once

#include "mapping/interpretation/interpretation.h"
#include "tests/mapping/exchange/furnished_map.h"

namespace loci::mapping::test {

/// The furnished map with a photo of its face: the door is red on the left and blue on the right, with a
/// green upper edge, the drawer is yellow; nothing was seen of the front at the right.
inline InterpretedMap photographed_map() {
  const FurnishedMap furnished;
  InterpretedMap map;
  map.world = furnished.world;
  map.semantics = furnished.semantics;
  FacePhoto photo;
  photo.face.normal = Vector2d(0, -1);
  photo.face.offset = -1.4;
  photo.face.u_min = photo.u0 = -1.2;
  photo.face.u_max = 1.2;
  photo.face.v_max = 0.9;
  photo.pixel_m = 0.004;
  photo.color = cv::Mat(225, 600, CV_8UC3, cv::Scalar(90, 90, 90));
  const auto paint = [&](double u0, double u1, double v0, double v1, const cv::Scalar& bgr) {
    const cv::Point low(static_cast<int>(photo.column(u0) + 1), static_cast<int>(photo.row(v1) + 1));
    const cv::Point high(static_cast<int>(photo.column(u1) + 1), static_cast<int>(photo.row(v0) + 1));
    photo.color(cv::Rect(low, high)).setTo(bgr);
  };
  paint(-1.1, -0.5, 0.64, 0.84, {0, 200, 200});
  paint(-0.3, 0, 0.1, 0.8, {0, 0, 200});
  paint(0, 0.3, 0.1, 0.8, {200, 0, 0});
  paint(-0.3, 0.3, 0.7, 0.8, {0, 200, 0});
  paint(0.4, 1.19, 0.02, 0.88, {0, 0, 0});
  map.faces = {photo.face};
  map.photos = {photo};
  return map;
}

}  // namespace loci::mapping::test

#pragma once

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "perception/detection/people_detector.h"

namespace loci {

/// A face that OpenCV's cascade takes for one: the pattern of light and shade of a face seen from the front.
inline void draw_face(cv::Mat& image, const cv::Point& centre, double width) {
  const auto at = [&](double x, double y) {
    return centre +
           cv::Point(static_cast<int>(std::lround(x * width)), static_cast<int>(std::lround(y * width)));
  };
  const auto size = [&](double x, double y) {
    return cv::Size(static_cast<int>(std::lround(x * width)), static_cast<int>(std::lround(y * width)));
  };
  const cv::Scalar skin(150, 180, 220), dark(40, 50, 60), shade(110, 140, 180), lips(90, 90, 160);
  cv::ellipse(image, at(0, -0.12), size(0.56, 0.72), 0, 0, 360, dark, -1, cv::LINE_AA);  // hair
  cv::ellipse(image, at(0, 0), size(0.46, 0.62), 0, 0, 360, skin, -1, cv::LINE_AA);
  for (const double side : {-0.2, 0.2}) {
    cv::ellipse(image, at(side, -0.12), size(0.15, 0.1), 0, 0, 360, shade, -1, cv::LINE_AA);
    cv::ellipse(image, at(side, -0.2), size(0.15, 0.035), 0, 0, 360, dark, -1, cv::LINE_AA);
    cv::ellipse(image, at(side, -0.1), size(0.1, 0.045), 0, 0, 360, dark, -1, cv::LINE_AA);
  }
  cv::ellipse(image, at(0, 0.14), size(0.1, 0.05), 0, 0, 360, shade, -1, cv::LINE_AA);
  cv::ellipse(image, at(0, 0.34), size(0.18, 0.05), 0, 0, 360, lips, -1, cv::LINE_AA);
  cv::GaussianBlur(image, image, {}, width / 40);
}

/// A room with a person `z` metres away who looks at the camera: a wall 1.5 m behind, head, shoulders, trunk.
/// `size`: 1 = of a person, 0.2 = of a doll.
inline perception::PeopleFrame frame_with_person(double z = 1.6, double size = 1, bool with_face = true) {
  perception::PeopleFrame frame;
  frame.camera.color = frame.camera.depth;
  const mapping::PinholeCamera& camera = frame.camera.depth;
  const double pixels = camera.fx / z * size;  // per metre of the person
  const cv::Point head(300, 150);
  cv::Mat person = cv::Mat::zeros(camera.height, camera.width, CV_8U);
  const auto length = [&](double metres) { return static_cast<int>(std::lround(metres * pixels)); };
  cv::ellipse(person, head, {length(0.09), length(0.13)}, 0, 0, 360, 255, -1);
  cv::rectangle(person, head, head + cv::Point(length(0.06), length(0.3)), 255, -1);
  cv::ellipse(person, head + cv::Point(0, length(0.45)), {length(0.24), length(0.22)}, 0, 180, 360, 255, -1);
  cv::rectangle(person, head + cv::Point(-length(0.24), length(0.44)),
                head + cv::Point(length(0.24), length(1.1)), 255, -1);
  frame.color = cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar(170, 175, 165));
  frame.color.setTo(cv::Scalar(90, 60, 40), person);
  if (with_face) draw_face(frame.color, head, 0.16 * pixels);
  frame.points.create(camera.height, camera.width, CV_32FC3);
  for (int v = 0; v < camera.height; ++v)
    for (int u = 0; u < camera.width; ++u) {
      const Vector3d point = camera.unproject(u, v, person.at<uint8_t>(v, u) != 0 ? z : z + 1.5);
      frame.points.at<cv::Vec3f>(v, u) = cv::Vec3d(point.data());
    }
  return frame;
}

}  // namespace loci

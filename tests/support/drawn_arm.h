#pragma once

#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "mapping/base/math/random.h"
#include "mapping/render/ray_scene.h"
#include "mapping/sensor/frame.h"
#include "mapping/simulation/shapes.h"

namespace loci {

/// An arm along x with its shoulder at the origin: upper arm and forearm, a hand with fingers, in a sleeve as
/// long as drawn.
inline mapping::TriangleMesh drawn_arm(Random& draw) {
  static const std::array<mapping::Rgba, 6> complexions = {
      mapping::Rgba(0.96F, 0.80F, 0.69F, 1), mapping::Rgba(0.91F, 0.71F, 0.56F, 1),
      mapping::Rgba(0.82F, 0.62F, 0.46F, 1), mapping::Rgba(0.68F, 0.47F, 0.33F, 1),
      mapping::Rgba(0.50F, 0.33F, 0.23F, 1), mapping::Rgba(0.33F, 0.21F, 0.15F, 1)};
  const mapping::Rgba skin = complexions[draw.index(complexions.size())];
  const auto shade = [&] { return static_cast<float>(draw.uniform(0.05, 0.9)); };
  const mapping::Rgba cloth(shade(), shade(), shade(), 1);
  const double scale = draw.uniform(0.85, 1.12);
  const double wrist = 0.55 * scale, sleeve = draw.uniform(0.0, 0.53) * scale;
  const Vector3d z = Vector3d::UnitZ();
  mapping::ShapeBuilder shapes;
  shapes.tube({{0, 0, 0}, {0.28 * scale, 0, 0}, {wrist, 0, 0}}, {0.052 * scale, 0.043 * scale, 0.028 * scale},
              z, skin);
  shapes.tube({{0, 0, 0}, {sleeve, 0, 0}}, {0.066 * scale, (0.066 - 0.028 * sleeve / wrist) * scale}, z,
              cloth);
  const double spread = draw.uniform(0.0, 0.25), bend = draw.uniform(0.0, 0.05);
  for (int finger = 0; finger < 4; ++finger) {
    const double side = (finger - 1.5) * 0.021 * scale;
    const double reach = (finger == 0 || finger == 3 ? 0.165 : 0.185) * scale;
    const double out = side * (1 + spread * 3);
    shapes.tube({{wrist - 0.02, side * 0.8, 0},
                 {wrist + 0.09 * scale, side, 0.004},
                 {wrist + 0.9 * reach, out, -bend / 2},
                 {wrist + reach, out, -bend}},
                {0.015 * scale, 0.013 * scale, 0.009 * scale, 0.006 * scale}, z, skin, 10);
  }
  shapes.tube({{wrist, -0.03 * scale, 0},
               {wrist + 0.06 * scale, -0.055 * scale, -0.01},
               {wrist + 0.1 * scale, -0.06 * scale, -0.02}},
              {0.014 * scale, 0.012 * scale, 0.008 * scale}, z, skin, 10);
  return shapes.take();
}

/// Sets a drawn arm into a frame: it reaches in from beyond the image to something that the frame shows. The
/// depth pixels that it covers (CV_8U, 255), or nothing where it did not fit in.
inline std::optional<cv::Mat> set_arm_into(mapping::RgbdFrame& frame, Random& draw) {
  const mapping::PinholeCamera& camera = frame.camera.depth;
  const Vector3d up = frame.map_from_camera
                          ? Vector3d(frame.map_from_camera->linear().transpose() * Vector3d::UnitZ())
                          : Vector3d(-Vector3d::UnitY());
  const cv::Point target(static_cast<int>(draw.uniform(0.3, 0.7) * camera.width),
                         static_cast<int>(draw.uniform(0.35, 0.75) * camera.height));
  const double z = frame.depth.at<float>(target);
  if (!(z > 0.5 && z < 1.8)) return std::nullopt;
  const Vector3d hand = camera.unproject(target.x, target.y, z) + up * draw.uniform(0.01, 0.15);
  const Vector3d aside = up.unitOrthogonal(), ahead = up.cross(aside);
  const double heading = draw.uniform(0, 2 * M_PI), rise = draw.uniform(0.05, 0.9);
  const Vector3d towards =
      -(std::cos(rise) * (std::cos(heading) * aside + std::sin(heading) * ahead) + std::sin(rise) * up);
  const double reach = 0.7;
  const Vector3d shoulder = hand - reach * towards;
  if (!(shoulder.z() > 0.25)) return std::nullopt;
  const Vector2d elbow_at = camera.project(Vector3d(hand - 0.4 * towards)),
                 shoulder_at = camera.project(shoulder);
  const cv::Rect2d image(0, 0, camera.width, camera.height);
  if (image.contains({shoulder_at.x(), shoulder_at.y()}) ||
      !image.contains({(elbow_at.x() + 2 * target.x) / 3, (elbow_at.y() + 2 * target.y) / 3}))
    return std::nullopt;
  Isometry3d at = Isometry3d::Identity();
  at.linear().col(0) = towards;
  at.linear().col(1) = up.cross(towards).normalized();
  at.linear().col(2) = at.linear().col(0).cross(at.linear().col(1));
  at.translation() = shoulder;
  mapping::RayScene scene;
  scene.add("arm", drawn_arm(draw), at);
  const Isometry3d color_from_depth = frame.camera.depth_from_color.inverse();
  const Vector3d light = (up + aside * draw.uniform(-1, 1) - Vector3d::UnitZ()).normalized();
  const double white = draw.uniform(0.7, 1.1);
  cv::Mat mask = cv::Mat::zeros(frame.depth.size(), CV_8U);
  cv::Mat depth = frame.depth.clone(), color = frame.color.clone();
  size_t all = 0, behind = 0;
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const Eigen::Vector3f ray = camera.unproject(u, v, 1).normalized().cast<float>();
      const mapping::RayHit hit = scene.cast(Eigen::Vector3f::Zero(), ray, 5);
      if (hit.link < 0) continue;
      const double here = static_cast<double>(hit.distance * ray.z());
      ++all;
      if (depth.at<float>(v, u) < here - 0.01) {
        ++behind;
        continue;
      }
      mask.at<uint8_t>(v, u) = 255;
      depth.at<float>(v, u) = static_cast<float>(here + draw.normal(0.0014 * here * here));
      const double shade = white * (0.45 + 0.55 * std::max(0.0, hit.normal.cast<double>().dot(light)));
      const Vector2d pixel =
          frame.camera.color.project(color_from_depth * Vector3d((ray * hit.distance).cast<double>()));
      for (int dv = 0; dv <= 1; ++dv)
        for (int du = 0; du <= 1; ++du) {
          const cv::Point p(static_cast<int>(pixel.x()) + du, static_cast<int>(pixel.y()) + dv);
          if (!cv::Rect({}, color.size()).contains(p)) continue;
          for (int i = 0; i < 3; ++i)
            color.at<cv::Vec3b>(p)[i] =
                cv::saturate_cast<uint8_t>(hit.color[static_cast<size_t>(2 - i)] * shade + draw.normal(4));
        }
    }
  if (all < 800 || behind * 20 > all) return std::nullopt;
  frame.depth = depth;
  frame.color = color;
  return mask;
}

}  // namespace loci

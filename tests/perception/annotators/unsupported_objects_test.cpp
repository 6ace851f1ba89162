// Objects in bins: a rendered one, and a real one with spots that a person picked (../shared/data/shelf_bin).

#include "perception/annotators/segmentation/unsupported_objects.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "mapping/base/text/csv.h"
#include "mapping/recording/recording.h"
#include "mapping/sensor/kinect.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/superpixels.h"
#include "perception/annotators/structure/normals.h"

namespace loci::perception {
namespace {

const Vector3d kUp = -Vector3d::UnitY();

struct CameraBox {
  Vector3d low, high;  ///< corners, camera frame
};

/// Depth of boxes before the camera, seen from outside.
cv::Mat depth_of(const std::vector<CameraBox>& boxes, const mapping::PinholeCamera& camera) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  cv::Mat depth(camera.height, camera.width, CV_32F, cv::Scalar(double(kNone)));
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const Vector3d ray = camera.unproject(u, v, 1);
      double nearest = std::numeric_limits<double>::infinity();
      for (const CameraBox& box : boxes) {
        const Eigen::Array3d first = box.low.array() / ray.array(), second = box.high.array() / ray.array();
        const double in = first.min(second).maxCoeff(), out = first.max(second).minCoeff();
        if (in > 0 && in < out) nearest = std::min(nearest, in);
      }
      if (std::isfinite(nearest)) depth.at<float>(v, u) = static_cast<float>(nearest);
    }
  return depth;
}

struct Seen {
  cv::Mat points, normals;
};

Seen see(const cv::Mat& depth, const mapping::PinholeCamera& camera) {
  const NormalOptions options = NormalOptions::for_objects();
  const cv::Mat smooth = smooth_depth(depth, camera, options);
  return {points_from_depth(smooth, camera), normals_from_depth(smooth, camera, options)};
}

TEST(UnsupportedObjects, ThingsInABinComeApartAndItsWallsAreNone) {
  const mapping::PinholeCamera camera = mapping::kinect_camera().depth;
  // x to the right, y down: back wall, two side walls, a carton, a book that leans on nothing. No floor.
  const std::vector<CameraBox> bin = {{{-0.25, -0.25, 0.80}, {0.25, 0.15, 0.82}},
                                      {{-0.27, -0.25, 0.50}, {-0.25, 0.15, 0.82}},
                                      {{0.25, -0.25, 0.50}, {0.27, 0.15, 0.82}}};
  std::vector<CameraBox> all = bin;
  all.push_back({{-0.15, 0.00, 0.60}, {-0.03, 0.15, 0.70}});
  all.push_back({{0.05, -0.10, 0.65}, {0.17, 0.15, 0.68}});
  const auto found = [&](const std::vector<CameraBox>& boxes) {
    const Seen seen = see(depth_of(boxes, camera), camera);
    return find_unsupported_objects(seen.points, seen.normals, {}, camera, kUp, {});
  };
  EXPECT_TRUE(found(bin).empty()) << "an empty bin";
  const std::vector<std::vector<int>> objects = found(all);
  ASSERT_EQ(objects.size(), 2U);
  std::vector<double> sides;
  const Seen seen = see(depth_of(all, camera), camera);
  for (const std::vector<int>& object : objects) {
    double x = 0;
    for (const int pixel : object)
      x += double(seen.points.ptr<cv::Vec3f>()[pixel][0]) / double(object.size());
    sides.push_back(x);
  }
  std::ranges::sort(sides);
  EXPECT_NEAR(sides[0], -0.09, 0.02);
  EXPECT_NEAR(sides[1], 0.11, 0.02);
}

TEST(UnsupportedObjects, AllFourOfARealBinAreFoundApart) {
  const std::filesystem::path folder = LOCI_SHARED_DIR "/data/shelf_bin";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
  std::map<std::string, std::vector<Vector3d>> spots;
  const CsvTable table = CsvTable::read(folder / "objects.csv");
  for (size_t row = 0; row < table.rows(); ++row)
    spots[table.cell(row, 0)].emplace_back(table.number(row, 6), table.number(row, 7), table.number(row, 8));
  ASSERT_EQ(spots.size(), 4U);
  const auto recording = mapping::open_recording(folder);
  std::map<std::string, int> frames_apart;
  size_t candidates = 0;
  for (size_t i = 0; i < recording->size(); ++i) {
    const mapping::RgbdFrame frame = recording->frame(i);
    const Seen seen = see(frame.depth, frame.camera.depth);
    const Isometry3d& pose = *frame.map_from_camera;
    const auto objects = find_unsupported_objects(
        seen.points, seen.normals, lab_of_points(seen.points, frame.color, frame.camera), frame.camera.depth,
        pose.linear().transpose() * Vector3d::UnitZ(), {});
    candidates += objects.size();
    for (const std::vector<int>& object : objects) {
      const auto shows = [&](const std::vector<Vector3d>& of_object) {
        constexpr double kNear = 0.015;
        return std::ranges::any_of(object, [&](int pixel) {
          const Vector3d p = pose * to_vector(seen.points.ptr<cv::Vec3f>()[pixel]);
          return std::ranges::any_of(of_object,
                                     [&](const Vector3d& spot) { return (p - spot).norm() < kNear; });
        });
      };
      std::vector<std::string> shown;
      for (const auto& [name, of_object] : spots)
        if (shows(of_object)) shown.push_back(name);
      if (shown.size() == 1) ++frames_apart[shown.front()];
    }
  }
  for (const auto& [name, of_object] : spots) {
    std::cout << name << ": apart in " << frames_apart[name] << " of " << recording->size() << " frames\n";
    EXPECT_GE(frames_apart[name], 5) << name;
  }
  std::cout << candidates << " candidates\n";
  EXPECT_LE(candidates, 4 * recording->size());
}

}  // namespace
}  // namespace loci::perception

#include "apps/evaluate/description/primitive_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/render/render.h"
#include "mapping/sensor/kinect.h"
#include "mapping/simulation/household_scenes.h"
#include "mapping/simulation/scenario.h"
#include "mapping/simulation/shapes.h"

namespace loci::apps::description_evaluation {
namespace {

const mapping::Rgba kGrey(0.6f, 0.6f, 0.6f, 1);
const std::array<const char*, 4> kClasses = {"box", "cylinder", "flat", "sphere"};

mapping::Rgba grey(double /*u*/, double /*v*/) {
  return kGrey;
}

/// A shape on z = 0 about the origin.
struct Primitive {
  mapping::TriangleMesh mesh;
  double reach = 0;  ///< no point is further from the z axis
  double top = 0;    ///< height of its flat top
  double room =
      0;  ///< so far from the z axis the top reaches in every direction; 0 = nothing can stand on it
  perception::PrimitiveShape shape{};
  bool exact = true;  ///< whether the shape is all that there is
};

perception::PrimitiveShape box_shape(double x, double y, double z) {
  perception::PrimitiveShape shape;
  shape.frame_from_shape.translation().z() = z / 2;
  shape.size = {x, y, z};
  return shape;
}

perception::PrimitiveShape round_shape(double radius_low, double radius_high, double height) {
  perception::PrimitiveShape shape;
  shape.kind = radius_low == radius_high ? perception::PrimitiveShape::Kind::cylinder
                                         : perception::PrimitiveShape::Kind::cone;
  shape.frame_from_shape.translation().z() = height / 2;
  shape.radius_low = radius_low;
  shape.radius_high = radius_high;
  const double width = 2 * std::max(radius_low, radius_high);
  shape.size = {width, width, height};
  return shape;
}

Primitive block(double x, double y, double z) {
  mapping::ShapeBuilder builder;
  builder.box({-x / 2, -y / 2, 0}, {x / 2, y / 2, z}, kGrey);
  return {builder.take(), std::hypot(x, y) / 2, z, std::min(x, y) / 2, box_shape(x, y, z)};
}

Primitive box(Random& draw) {
  // Nothing flat: the middle side is at most four times the smallest.
  for (;;) {
    std::array<double, 3> sides;
    for (double& side : sides)
      side = draw.uniform(0.045, 0.13) + (draw.uniform() < 0.4 ? draw.uniform(0, 0.14) : 0);
    std::array<double, 3> sorted = sides;
    std::sort(sorted.begin(), sorted.end());
    if (sorted[1] <= 4 * sorted[0]) return block(sides[0], sides[1], sides[2]);
  }
}

void turn_over(mapping::TriangleMesh& mesh, double height) {
  for (auto& vertex : mesh.vertices) {
    vertex.y() = -vertex.y();
    vertex.z() = static_cast<float>(height) - vertex.z();
  }
}

/// A full cylinder on its side.
Primitive lying(double radius, double length) {
  mapping::ShapeBuilder builder;
  builder.lathe({{0, 0}, {radius, 0}, {radius, length}, {0, length}}, grey);
  Primitive primitive{builder.take(), std::hypot(radius, length / 2), 0, 0,
                      round_shape(radius, radius, length)};
  primitive.shape.frame_from_shape =
      Eigen::Translation3d(0, 0, radius) * Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY());
  for (auto& vertex : primitive.mesh.vertices)
    vertex = {vertex.z() - static_cast<float>(length / 2), vertex.y(),
              static_cast<float>(radius) - vertex.x()};
  return primitive;
}

/// A tin, cup, pot or bowl. Nothing flat: it is at most four times as wide as high.
Primitive standing(Random& draw) {
  const double top = draw.uniform() < 0.65 ? draw.uniform(0.03, 0.095) : draw.uniform(0.07, 0.13);
  const double height = draw.uniform() < 0.5 ? draw.uniform(0.05, 0.12) : draw.uniform(0.6, 3) * 2 * top;
  const double bounded = std::clamp(height, std::max(0.05, top / 2), 0.24);
  const double taper = draw.uniform() < 0.5 ? 1 : draw.uniform(0.45, 1);
  const double bottom = taper * top;
  const double wall = draw.uniform(0.003, 0.006);
  const bool hollow = draw.uniform() < 0.5;
  mapping::ShapeBuilder builder;
  if (hollow)
    builder.lathe({{0, 0},
                   {bottom, 0},
                   {bottom + 0.6 * (top - bottom), 0.4 * bounded},
                   {top, bounded},
                   {top - wall, bounded},
                   {bottom + 0.6 * (top - bottom) - wall, 0.4 * bounded},
                   {bottom - wall, 2 * wall},
                   {0, 2 * wall}},
                  grey);
  else
    builder.lathe({{0, 0}, {bottom, 0}, {top, bounded}, {0, bounded}}, grey);
  double reach = top;
  if (hollow && draw.uniform() < 0.5) {
    const double out = draw.uniform(0.02, 0.035);
    const double high = 0.85 * bounded, low = 0.35 * bounded;
    const double at_low = bottom + (top - bottom) * 0.35 - wall / 2,
                 at_high = bottom + (top - bottom) * 0.85 - wall / 2;
    builder.tube({{at_low, 0, low},
                  {at_high + out, 0, low + 0.2 * (high - low)},
                  {at_high + out, 0, high - 0.2 * (high - low)},
                  {at_high, 0, high}},
                 {0.005, 0.005, 0.005, 0.005}, Vector3d::UnitY(), kGrey);
    reach += out + 0.005;
  }
  Primitive primitive{
      builder.take(),       reach, bounded, hollow ? 0 : top, round_shape(bottom, top, bounded),
      !hollow || taper == 1};
  if (hollow && draw.uniform() < 0.4) {
    turn_over(primitive.mesh, bounded);
    std::swap(primitive.shape.radius_low, primitive.shape.radius_high);
  }
  return primitive;
}

Primitive cylinder(Random& draw) {
  const double kind = draw.uniform();
  if (kind < 0.15) {
    const double radius = draw.uniform(0.03, 0.06);
    return lying(radius, draw.uniform(2.4, 5) * radius);
  }
  if (kind < 0.3) {  // A low tin on its edge.
    const double radius = draw.uniform(0.05, 0.12);
    return lying(radius, draw.uniform(0.5, 1.6) * radius);
  }
  return standing(draw);
}

Primitive flat(Random& draw) {
  const double height = draw.uniform(0.022, 0.03);
  const double width = height * draw.uniform(6, 9);
  if (draw.uniform() < 0.6) return block(width, width * draw.uniform(1, 1.4), height);
  mapping::ShapeBuilder builder;
  builder.lathe({{0, 0}, {width / 2, 0}, {width / 2, height}, {0, height}}, grey);
  return {builder.take(), width / 2, height, width / 2, round_shape(width / 2, width / 2, height)};
}

Primitive sphere(Random& draw) {
  const double radius = draw.uniform(0.03, 0.1);
  std::vector<Vector2d> profile;
  constexpr int kRings = 20;
  for (int i = 0; i <= kRings; ++i) {
    const double angle = kPi * i / kRings;
    profile.emplace_back(radius * std::sin(angle), radius * (1 - std::cos(angle)));
  }
  mapping::ShapeBuilder builder;
  builder.lathe(profile, grey);
  Primitive primitive{builder.take(), radius, 0, 0, round_shape(radius, radius, 2 * radius)};
  primitive.shape.kind = perception::PrimitiveShape::Kind::sphere;
  return primitive;
}

Primitive primitive_of(size_t kind, Random& draw) {
  switch (kind) {
    case 0:
      return box(draw);
    case 1:
      return cylinder(draw);
    case 2:
      return flat(draw);
    default:
      return sphere(draw);
  }
}

/// A table before a camera.
struct Layout {
  mapping::RenderScene scene;
  Isometry3d map_from_camera;
  std::vector<PrimitiveTruth> samples;  ///< the objects 20, 30, ...
};

void add_objects(Layout& layout, Random& draw) {
  constexpr size_t kObjects = 5;
  constexpr double kGap = 0.03;
  std::vector<std::pair<Vector2d, double>> taken;
  for (int attempt = 0; attempt < 60 && taken.size() < kObjects; ++attempt) {
    const size_t kind = draw.index(kClasses.size());
    const Primitive primitive = primitive_of(kind, draw);
    const Vector2d at(draw.uniform(-0.3, 0.3), draw.uniform(-0.25, 0.25));
    const bool free = std::all_of(taken.begin(), taken.end(), [&](const auto& other) {
      return (other.first - at).norm() > other.second + primitive.reach + kGap;
    });
    const double turn = draw.uniform(0, 2 * kPi);
    if (!free) continue;
    taken.emplace_back(at, primitive.reach);
    const auto put = [&](const Primitive& sample, size_t its_kind, double height, double yaw) {
      Isometry3d pose(Eigen::Translation3d(at.x(), at.y(), height));
      pose.rotate(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
      layout.samples.push_back({kClasses[its_kind], sample.shape, sample.exact});
      layout.samples.back().shape.frame_from_shape = pose * sample.shape.frame_from_shape;
      layout.scene.add(fmt::format("thing_{}", layout.samples.size()), sample.mesh, pose);
    };
    put(primitive, kind, 0, turn);
    const size_t other_kind = draw.index(kClasses.size() - 1);  // Spheres would roll.
    const Primitive other = primitive_of(other_kind, draw);
    if (other.reach < 1.3 * primitive.room) put(other, other_kind, primitive.top, draw.uniform(0, 2 * kPi));
  }
}

Layout layout_of(Random& draw) {
  Layout layout;
  layout.scene.add("table", block(1.6, 1.2, 0.04).mesh, Isometry3d(Eigen::Translation3d(0, 0, -0.04)));
  add_objects(layout, draw);
  const double elevation = draw.uniform(25, 65) * kPi / 180, side = draw.uniform(-0.4, 0.4);
  const Vector3d from(side, -std::cos(elevation), std::sin(elevation));
  layout.map_from_camera = mapping::looking_at(from.normalized() * draw.uniform(0.75, 1.4), Vector3d::Zero());
  return layout;
}

struct Image {
  mapping::RgbdFrame frame;
  cv::Mat labels;
  std::vector<PrimitiveTruth> samples;  ///< the objects 20, 30, ...
};

class PrimitiveScenes : public mapping::Recording {
 public:
  PrimitiveScenes(size_t scenes, const Random& random) : random_(random) {
    info_.format = "simulated";
    info_.path = "primitive shapes";
    info_.map_frame = "table";
    info_.camera = mapping::kinect_camera();
    info_.frames = info_.frames_with_pose = scenes;
    if (scenes > 0) info_.last_time = time_of(scenes - 1);
  }

  const mapping::RecordingInfo& info() const override { return info_; }
  size_t size() const override { return info_.frames; }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }
  mapping::RgbdFrame frame(size_t i) const override {
    last_ = image(i);
    return last_.frame;
  }
  /// What the frame that was read last shows.
  const Image& last() const { return last_; }

 private:
  Image image(size_t number) const {
    Random draw = random_.fork(number);
    const Layout layout = layout_of(draw);
    Image image;
    image.samples = layout.samples;
    mapping::RgbdFrame& frame = image.frame;
    frame.camera = info_.camera;
    frame.index = static_cast<int64_t>(number);
    frame.name = fmt::format("scene{}", number);
    frame.time_ns = time_of(number);
    frame.map_from_camera = layout.map_from_camera;
    mapping::RenderOptions options;
    options.normals = true;
    const mapping::RenderedView view =
        layout.scene.render(frame.camera.depth, *frame.map_from_camera, options);
    // Half of the images have the simulation's own noise, which differs from pixel to pixel.
    mapping::KinectModel sensor;
    cv::Mat depth = view.depth;
    if (draw.uniform() < 0.5) {
      depth = mapping::seen_through_window(depth, frame.camera.depth.fx * sensor.baseline_m, draw.fork(1));
      sensor.disparity_sigma_px = 0;
    }
    frame.depth = measured_by_kinect(depth, view.normal, frame.camera.depth, sensor, draw.fork(0));
    image.labels = cv::Mat::zeros(frame.depth.size(), CV_16U);
    for (int v = 0; v < frame.depth.rows; ++v)
      for (int u = 0; u < frame.depth.cols; ++u)
        if (const int link = view.link.at<int>(v, u); link >= 0 && !std::isnan(frame.depth.at<float>(v, u)))
          image.labels.at<uint16_t>(v, u) = static_cast<uint16_t>(link == 0 ? 1 : 10 + 10 * link);
    return image;
  }

  Random random_;
  mapping::RecordingInfo info_;
  mutable Image last_;
};

}  // namespace

perception::LabelledRecording primitive_scenes(size_t scenes, const Random& random) {
  const auto recording = std::make_shared<PrimitiveScenes>(scenes, random);
  perception::LabelledRecording labelled;
  labelled.recording = recording;
  const PrimitiveScenes* images = recording.get();
  labelled.labels = [images](const std::string&) { return images->last().labels; };
  labelled.class_of = [images](const std::string&, int object) {
    const std::vector<PrimitiveTruth>& samples = images->last().samples;
    const auto number = static_cast<size_t>(object / 10 - 2);
    return number < samples.size() ? samples[number].label : std::string();
  };
  return labelled;
}

std::vector<PrimitiveTruth> primitive_truths(size_t scene, const Random& random) {
  Random draw = random.fork(scene);
  Layout layout = layout_of(draw);
  for (PrimitiveTruth& sample : layout.samples)
    sample.shape.frame_from_shape = layout.map_from_camera.inverse() * sample.shape.frame_from_shape;
  return layout.samples;
}

}  // namespace loci::apps::description_evaluation

#include "mapping/recording/convert.h"

#include <fmt/format.h>

#include "mapping/base/files.h"
#include "mapping/base/output_file.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/file_recording.h"
#include "mapping/recording/ros/mcap_writer.h"
#include "mapping/recording/ros/message_writers.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDepthFrame = "camera_depth_optical_frame";
constexpr const char* kColorFrame = "camera_color_optical_frame";

/// Frame by frame into one of the formats.
class RecordingSink {
 public:
  virtual ~RecordingSink() = default;
  virtual void add(const RgbdFrame& frame) = 0;
  virtual void finish() = 0;
};

class LociSink : public RecordingSink {
 public:
  LociSink(const RecordingInfo& info, const fs::path& out, const ConvertOptions& options)
      : writer_(out, info.camera, info.map_frame,
                {.time_assumed = info.time_assumed,
                 .time_zone = info.time_zone,
                 .depth_unit_m = info.depth_unit_m,
                 .inputs = options.inputs,
                 .force = options.force}) {}
  void add(const RgbdFrame& frame) override { writer_.add(frame); }
  void finish() override { writer_.finish(); }

 private:
  RecordingWriter writer_;
};

class McapSink : public RecordingSink {
 public:
  McapSink(const RecordingInfo& info, const fs::path& out, const ConvertOptions& options)
      : info_(info),
        world_(info.map_frame.empty() ? "map" : info.map_frame),
        writer_(out, {.replace = options.force ? Replace::anything : Replace::own, .inputs = options.inputs}),
        layers_(options.layers) {
    for (const MarkerLayer& layer : layers_)
      layer_channels_.push_back(add_channel(layer.topic, marker_array_type()));
  }

  void add(const RgbdFrame& frame) override {
    const TimeNs time = frame.time_ns;
    if (!began_)
      writer_.add(fixed_, time,
                  transform_message(info_.camera.depth_from_color, time, kDepthFrame, kColorFrame));
    began_ = true;
    if (frame.map_from_camera)
      writer_.add(transforms_, time, transform_message(*frame.map_from_camera, time, world_, kDepthFrame));
    if (!frame.joints.empty()) writer_.add(joints_, time, joint_state_message(frame.joints, time));
    for (size_t i = 0; i < layers_.size(); ++i)
      if (const auto markers = layers_[i].at(frame))
        writer_.add(layer_channels_[i], time, marker_array_message(*markers, time, world_));
    writer_.add(depth_info_, time, camera_info_message(info_.camera.depth, time, kDepthFrame));
    // Units other than the millimetre have no name in ROS: metres do.
    if (info_.depth_unit_m == 0.001)
      writer_.add(depth_, time,
                  image_message(raw_from_depth(frame.depth, 0.001), "16UC1", time, kDepthFrame));
    else
      writer_.add(depth_, time, image_message(frame.depth, "32FC1", time, kDepthFrame));
    if (frame.color.empty()) return;
    writer_.add(color_info_, time, camera_info_message(info_.camera.color, time, kColorFrame));
    writer_.add(color_, time, compressed_image_message(frame.color, time, kColorFrame));
  }
  void finish() override { writer_.finish(); }

 private:
  uint16_t add_channel(const std::string& topic, const MessageType& type) {
    return writer_.add_channel(topic, type.name, type.definition);
  }

  RecordingInfo info_;
  std::string world_;
  McapWriter writer_;
  std::vector<MarkerLayer> layers_;
  std::vector<uint16_t> layer_channels_;
  bool began_ = false;
  uint16_t depth_ = add_channel("/camera/depth/image_rect", image_type());
  uint16_t depth_info_ = add_channel("/camera/depth/camera_info", camera_info_type());
  uint16_t color_ = add_channel("/camera/color/image_rect/compressed", compressed_image_type());
  uint16_t color_info_ = add_channel("/camera/color/camera_info", camera_info_type());
  uint16_t transforms_ = add_channel("/tf", transforms_type());
  uint16_t fixed_ = add_channel("/tf_static", transforms_type());
  uint16_t joints_ = add_channel("/joint_states", joint_state_type());
};

/// The layout of the benchmark, inside a recording folder's care: new or empty, and renamed when it is whole.
class TumSink : public RecordingSink {
 public:
  TumSink(const RecordingInfo& info, const fs::path& out, const ConvertOptions& options)
      : info_(info), out_(out) {
    refuse_inputs(out, options.inputs);
    require_new_or_empty(out);
    partial_ = make_partial_folder(out);
    for (const char* name : {"depth", "rgb"}) make_folder(partial_ / name);
  }
  ~TumSink() override {
    std::error_code ignored;
    fs::remove_all(partial_, ignored);
  }

  void add(const RgbdFrame& frame) override {
    const std::string stamp = fmt::format("{}.{:09}", frame.time_ns / kSecond, frame.time_ns % kSecond);
    write_image(partial_ / "depth" / (stamp + ".png"), raw_from_depth(frame.depth, 1.0 / 5000));
    depths_ += fmt::format("{0} depth/{0}.png\n", stamp);
    if (!frame.color.empty()) {
      write_image(partial_ / "rgb" / (stamp + ".png"), frame.color);
      colors_ += fmt::format("{0} rgb/{0}.png\n", stamp);
    }
    if (!frame.map_from_camera) return;
    poses_ += stamp;
    for (const double value : values_from_pose(*frame.map_from_camera))
      poses_ += fmt::format(" {:.9f}", value);
    poses_ += '\n';
  }

  void finish() override {
    write_file_atomically(partial_ / "depth.txt", "# depth maps\n" + depths_);
    write_file_atomically(partial_ / "rgb.txt", "# colour images\n" + colors_);
    write_file_atomically(partial_ / "groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n" + poses_);
    write_file_atomically(partial_ / "cameras.yaml", cameras_yaml());
    require_new_or_empty(out_);  // Again: writing took its time.
    commit_partial_folder(partial_, out_);
  }

 private:
  static void require_new_or_empty(const fs::path& out) {
    if (fs::exists(out) && !(fs::is_directory(out) && fs::is_empty(out)))
      throw Error("exists already", {out.string(), 0, {}}, "choose a new or an empty folder");
  }

  std::string cameras_yaml() const {
    const auto camera = [](const PinholeCamera& c) {
      return fmt::format("width: {}, height: {}, fx: {}, fy: {}, cx: {}, cy: {}", c.width, c.height, c.fx,
                         c.fy, c.cx, c.cy);
    };
    const Isometry3d t = info_.camera.depth_from_color.inverse();
    std::string r;
    for (int i = 0; i < 9; ++i) r += fmt::format("{}{}", i == 0 ? "" : ", ", t.linear()(i / 3, i % 3));
    return fmt::format(
        "depth: {{{}, unit_m: 0.0002, invalid: [0]}}\ncolor: {{{}}}\ncolor_from_depth: {{R: [{}], t: [{}, "
        "{}, {}]}}\n",
        camera(info_.camera.depth), camera(info_.camera.color), r, t.translation().x(), t.translation().y(),
        t.translation().z());
  }

  RecordingInfo info_;
  fs::path out_, partial_;
  std::string depths_, colors_, poses_;
};

std::unique_ptr<RecordingSink> make_sink(const RecordingInfo& info, const fs::path& out,
                                         const ConvertOptions& options) {
  switch (options.format) {
    case RecordingFormat::mcap:
      return std::make_unique<McapSink>(info, out, options);
    case RecordingFormat::tum:
      return std::make_unique<TumSink>(info, out, options);
    case RecordingFormat::loci:
      break;
  }
  return std::make_unique<LociSink>(info, out, options);
}

}  // namespace

Tally convert_recording(const Recording& recording, const fs::path& out, const ConvertOptions& options,
                        Progress& progress) {
  const std::unique_ptr<RecordingSink> sink = make_sink(recording.info(), out, options);
  Tally frames;
  for (size_t i = 0; i < recording.size(); i += static_cast<size_t>(options.every)) {
    progress.check(double(i) / double(recording.size()), fmt::format("frame {} of {}", i, recording.size()));
    const RgbdFrame frame = recording.frame(i);
    if (!frame.damage.empty() && !has_depth(frame)) {
      frames.add(Reason::damaged, frame.damage);
      continue;
    }
    sink->add(frame);
    frames.add_used();
  }
  sink->finish();
  return frames;
}

}  // namespace loci::mapping

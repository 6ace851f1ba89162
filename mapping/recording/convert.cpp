#include "mapping/recording/convert.h"

#include <fmt/format.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "mapping/base/output_file.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/file_recording.h"
#include "mapping/recording/ros/mcap_writer.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDepthFrame = "camera_depth_optical_frame";
constexpr const char* kColorFrame = "camera_color_optical_frame";
constexpr const char* kHeader =
    "std_msgs/Header "
    "header\n@H\n================================================================================\n"
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

/// The text of a message type that begins with a header.
std::string definition(const std::string& fields, const std::string& more = {}) {
  std::string text = kHeader;
  return text.replace(text.find("@H\n"), 3, fields) + more;
}

std::string section(const std::string& name, const std::string& fields) {
  return std::string(80, '=') + "\nMSG: " + name + "\n" + fields;
}

std::string transform_definition() {
  const std::string stamped = "std_msgs/Header header\nstring child_frame_id\nTransform transform\n";
  return "geometry_msgs/TransformStamped[] transforms\n" +
         section("geometry_msgs/TransformStamped", stamped) +
         section("geometry_msgs/Transform", "Vector3 translation\nQuaternion rotation\n") +
         section("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n") +
         section("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n") +
         section("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n") +
         section("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
}

std::string camera_definition() {
  return definition(
      "uint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\nfloat64[9] r\n"
      "float64[12] p\nuint32 binning_x\nuint32 binning_y\nRegionOfInterest roi\n",
      section("sensor_msgs/RegionOfInterest",
              "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"));
}

std::string camera_message(const PinholeCamera& camera, TimeNs time, const char* frame) {
  CdrWriter cdr;
  cdr.header(time, frame).add(static_cast<uint32_t>(camera.height)).add(static_cast<uint32_t>(camera.width));
  cdr.text("plumb_bob").add(uint32_t{5});
  for (int i = 0; i < 5; ++i) cdr.add(0.0);
  for (const double k : {camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0}) cdr.add(k);
  for (const double r : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) cdr.add(r);
  for (const double p : {camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0})
    cdr.add(p);
  for (int i = 0; i < 6; ++i) cdr.add(uint32_t{0});  // binning and region of interest
  return cdr.add(uint8_t{0}).bytes();
}

std::string image_message(const cv::Mat& image, const char* encoding, TimeNs time, const char* frame) {
  CdrWriter cdr;
  cdr.header(time, frame).add(static_cast<uint32_t>(image.rows)).add(static_cast<uint32_t>(image.cols));
  const size_t row = static_cast<size_t>(image.cols) * image.elemSize();
  cdr.text(encoding).add(uint8_t{0}).add(static_cast<uint32_t>(row));
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  return cdr.data({reinterpret_cast<const char*>(whole.data), row * static_cast<size_t>(whole.rows)}).bytes();
}

std::string color_message(const cv::Mat& image, TimeNs time) {
  const std::vector<unsigned char> png = encode_image(image, ".png");
  CdrWriter cdr;
  cdr.header(time, kColorFrame).text("bgr8; png compressed bgr8");
  return cdr.data({reinterpret_cast<const char*>(png.data()), png.size()}).bytes();
}

std::string transform_message(const Isometry3d& pose, TimeNs time, const std::string& parent,
                              const char* child) {
  CdrWriter cdr;
  cdr.add(uint32_t{1}).header(time, parent).text(child);
  for (const double value : values_from_pose(pose)) cdr.add(value);
  return cdr.bytes();
}

std::string joints_message(const JointState& joints, TimeNs time) {
  CdrWriter cdr;
  cdr.header(time, "").add(static_cast<uint32_t>(joints.size()));
  for (const auto& [name, position] : joints) cdr.text(name);
  cdr.add(static_cast<uint32_t>(joints.size()));
  for (const auto& [name, position] : joints) cdr.add(position);
  return cdr.add(uint32_t{0}).add(uint32_t{0}).bytes();  // velocity and effort
}

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
                 .inputs = options.inputs}) {}
  void add(const RgbdFrame& frame) override { writer_.add(frame); }
  void finish() override { writer_.finish(); }

 private:
  RecordingWriter writer_;
};

class McapSink : public RecordingSink {
 public:
  McapSink(const RecordingInfo& info, const fs::path& out, const ConvertOptions& options)
      : info_(info),
        writer_(out,
                {.replace = options.force ? Replace::anything : Replace::own, .inputs = options.inputs}) {
    const std::string image = definition(
        "uint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\nuint8[] data\n");
    depth_ = writer_.add_channel("/camera/depth/image_rect", "sensor_msgs/msg/Image", image);
    depth_info_ =
        writer_.add_channel("/camera/depth/camera_info", "sensor_msgs/msg/CameraInfo", camera_definition());
    color_ = writer_.add_channel("/camera/color/image_rect/compressed", "sensor_msgs/msg/CompressedImage",
                                 definition("string format\nuint8[] data\n"));
    color_info_ =
        writer_.add_channel("/camera/color/camera_info", "sensor_msgs/msg/CameraInfo", camera_definition());
    transforms_ = writer_.add_channel("/tf", "tf2_msgs/msg/TFMessage", transform_definition());
    fixed_ = writer_.add_channel("/tf_static", "tf2_msgs/msg/TFMessage", transform_definition());
    joints_ = writer_.add_channel(
        "/joint_states", "sensor_msgs/msg/JointState",
        definition("string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"));
  }

  void add(const RgbdFrame& frame) override {
    const TimeNs time = frame.time_ns;
    if (!began_)
      writer_.add(fixed_, time,
                  transform_message(info_.camera.depth_from_color, time, kDepthFrame, kColorFrame));
    began_ = true;
    const std::string parent = info_.map_frame.empty() ? "map" : info_.map_frame;
    if (frame.map_from_camera)
      writer_.add(transforms_, time, transform_message(*frame.map_from_camera, time, parent, kDepthFrame));
    if (!frame.joints.empty()) writer_.add(joints_, time, joints_message(frame.joints, time));
    writer_.add(depth_info_, time, camera_message(info_.camera.depth, time, kDepthFrame));
    // Units other than the millimetre have no name in ROS: metres do.
    if (info_.depth_unit_m == 0.001)
      writer_.add(depth_, time,
                  image_message(raw_from_depth(frame.depth, 0.001), "16UC1", time, kDepthFrame));
    else
      writer_.add(depth_, time, image_message(frame.depth, "32FC1", time, kDepthFrame));
    if (frame.color.empty()) return;
    writer_.add(color_info_, time, camera_message(info_.camera.color, time, kColorFrame));
    writer_.add(color_, time, color_message(frame.color, time));
  }
  void finish() override { writer_.finish(); }

 private:
  RecordingInfo info_;
  McapWriter writer_;
  bool began_ = false;
  uint16_t depth_ = 0, depth_info_ = 0, color_ = 0, color_info_ = 0, transforms_ = 0, fixed_ = 0, joints_ = 0;
};

/// The layout of the benchmark, inside a recording folder's care: new or empty, and renamed when it is whole.
class TumSink : public RecordingSink {
 public:
  TumSink(const RecordingInfo& info, const fs::path& out, const ConvertOptions& options)
      : info_(info), out_(out) {
    refuse_inputs(out, options.inputs);
    if (fs::exists(out) && !(fs::is_directory(out) && fs::is_empty(out)))
      throw Error("exists already", {out.string(), 0, {}}, "choose a new or an empty folder");
    partial_ = out.lexically_normal();
    if (!partial_.has_filename()) partial_ = partial_.parent_path();
    partial_ += fmt::format(".tmp{}", ::getpid());
    if (!fs::create_directories(partial_)) throw Error("is in the way", {partial_.string(), 0, {}});
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
    std::error_code code;
    if (fs::exists(out_)) fs::remove(out_, code);  // An empty folder; anything else stays.
    fs::rename(partial_, out_, code);
    if (code)
      throw Error("the recording cannot be put in its place: " + code.message(), {out_.string(), 0, {}});
  }

 private:
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

size_t convert_recording(const Recording& recording, const fs::path& out, const ConvertOptions& options,
                         Progress& progress) {
  const std::unique_ptr<RecordingSink> sink = make_sink(recording.info(), out, options);
  size_t frames = 0;
  for (size_t i = 0; i < recording.size(); i += static_cast<size_t>(options.every), ++frames) {
    progress.check(double(i) / double(recording.size()), fmt::format("frame {} of {}", i, recording.size()));
    sink->add(recording.frame(i));
  }
  sink->finish();
  return frames;
}

}  // namespace loci::mapping

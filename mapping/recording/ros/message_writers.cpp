#include "mapping/recording/ros/message_writers.h"

#include <fmt/format.h>

#include <map>

#include "mapping/image/image_io.h"

namespace loci::mapping {
namespace {

/// Fields of the types that messages are made of, by name.
const std::map<std::string, std::string>& part_fields() {
  static const std::map<std::string, std::string> fields = {
      {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
      {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"},
      {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
      {"std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n"},
      {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
      {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
      {"geometry_msgs/Pose",
       "geometry_msgs/Point position\n"
       "geometry_msgs/Quaternion orientation\n"},
      {"geometry_msgs/Transform",
       "geometry_msgs/Vector3 translation\n"
       "geometry_msgs/Quaternion rotation\n"},
      {"geometry_msgs/TransformStamped",
       "std_msgs/Header header\n"
       "string child_frame_id\n"
       "geometry_msgs/Transform transform\n"},
      {"sensor_msgs/RegionOfInterest",
       "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"},
      {"sensor_msgs/CompressedImage",
       "std_msgs/Header header\n"
       "string format\nuint8[] data\n"},
      {"visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"},
      {"visualization_msgs/MeshFile", "string filename\nuint8[] data\n"},
      {"visualization_msgs/Marker",
       "std_msgs/Header header\n"
       "string ns\nint32 id\nint32 type\nint32 action\n"
       "geometry_msgs/Pose pose\n"
       "geometry_msgs/Vector3 scale\n"
       "std_msgs/ColorRGBA color\n"
       "builtin_interfaces/Duration lifetime\n"
       "bool frame_locked\n"
       "geometry_msgs/Point[] points\n"
       "std_msgs/ColorRGBA[] colors\n"
       "string texture_resource\n"
       "sensor_msgs/CompressedImage texture\n"
       "visualization_msgs/UVCoordinate[] uv_coordinates\n"
       "string text\nstring mesh_resource\n"
       "visualization_msgs/MeshFile mesh_file\n"
       "bool mesh_use_embedded_materials\n"}};
  return fields;
}

/// Appends the definitions of all types that `fields` name, each once.
void add_parts(const std::string& fields, std::string& definition) {
  for (const auto& [name, part] : part_fields()) {
    const bool used = fields.starts_with(name + " ") || fields.starts_with(name + "[] ") ||
                      fields.find("\n" + name + " ") != std::string::npos ||
                      fields.find("\n" + name + "[] ") != std::string::npos;
    if (!used || definition.find("MSG: " + name + "\n") != std::string::npos) continue;
    definition += fmt::format("{:=<80}\nMSG: {}\n{}", "", name, part);
    add_parts(part, definition);
  }
}

MessageType message_type(std::string name, const std::string& fields) {
  std::string definition = fields;
  add_parts(fields, definition);
  return {std::move(name), std::move(definition)};
}

void add_color(CdrWriter& cdr, const Marker::Color& color) {
  for (const float channel : color) cdr.add(channel);
}

enum class MarkerAction : int32_t { add = 0, delete_all = 3 };

void add_marker(CdrWriter& cdr, const Marker& marker, MarkerAction action, TimeNs time,
                const std::string& frame) {
  cdr.header(time, frame).text(marker.group).add(int32_t{marker.id});
  cdr.add(static_cast<int32_t>(marker.shape)).add(static_cast<int32_t>(action));
  for (const double value : values_from_pose(marker.map_from_marker)) cdr.add(value);
  for (const double extent : marker.size) cdr.add(extent);
  add_color(cdr, marker.color);
  cdr.add(int32_t{0}).add(uint32_t{0}).add(uint8_t{0});  // It stays, in a frame that does not move.
  cdr.add(static_cast<uint32_t>(marker.points.size()));
  for (const Vector3d& point : marker.points)
    for (const double value : point) cdr.add(value);
  cdr.add(static_cast<uint32_t>(marker.point_colors.size()));
  for (const Marker::Color& color : marker.point_colors) add_color(cdr, color);
  cdr.text("").header(0, "").text("").data("").add(uint32_t{0});     // no texture
  cdr.text(marker.text).text("").text("").data("").add(uint8_t{0});  // no file of a mesh
}

}  // namespace

CdrWriter& CdrWriter::header(TimeNs stamp, std::string_view frame) {
  return add(static_cast<int32_t>(stamp / kSecond)).add(static_cast<uint32_t>(stamp % kSecond)).text(frame);
}

MessageType image_type() {
  return message_type("sensor_msgs/msg/Image",
                      "std_msgs/Header header\n"
                      "uint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
                      "uint8[] data\n");
}

MessageType compressed_image_type() {
  return message_type("sensor_msgs/msg/CompressedImage", part_fields().at("sensor_msgs/CompressedImage"));
}

MessageType camera_info_type() {
  return message_type("sensor_msgs/msg/CameraInfo",
                      "std_msgs/Header header\n"
                      "uint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\nfloat64[9] k\n"
                      "float64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
                      "sensor_msgs/RegionOfInterest roi\n");
}

MessageType transforms_type() {
  return message_type("tf2_msgs/msg/TFMessage", "geometry_msgs/TransformStamped[] transforms\n");
}

MessageType joint_state_type() {
  return message_type("sensor_msgs/msg/JointState",
                      "std_msgs/Header header\n"
                      "string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n");
}

MessageType marker_array_type() {
  return message_type("visualization_msgs/msg/MarkerArray", "visualization_msgs/Marker[] markers\n");
}

std::string image_message(const cv::Mat& image, const char* encoding, TimeNs time, const std::string& frame) {
  CdrWriter cdr;
  cdr.header(time, frame).add(static_cast<uint32_t>(image.rows)).add(static_cast<uint32_t>(image.cols));
  const size_t row = static_cast<size_t>(image.cols) * image.elemSize();
  cdr.text(encoding).add(uint8_t{0}).add(static_cast<uint32_t>(row));
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  return cdr.data({reinterpret_cast<const char*>(whole.data), row * static_cast<size_t>(whole.rows)}).bytes();
}

std::string compressed_image_message(const cv::Mat& image, TimeNs time, const std::string& frame) {
  const std::vector<unsigned char> png = encode_image(image, ".png");
  CdrWriter cdr;
  cdr.header(time, frame).text("bgr8; png compressed bgr8");
  return cdr.data({reinterpret_cast<const char*>(png.data()), png.size()}).bytes();
}

std::string camera_info_message(const PinholeCamera& camera, TimeNs time, const std::string& frame) {
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

std::string transform_message(const Isometry3d& pose, TimeNs time, const std::string& parent,
                              const std::string& child) {
  CdrWriter cdr;
  cdr.add(uint32_t{1}).header(time, parent).text(child);
  for (const double value : values_from_pose(pose)) cdr.add(value);
  return cdr.bytes();
}

std::string joint_state_message(const JointState& joints, TimeNs time) {
  CdrWriter cdr;
  cdr.header(time, "").add(static_cast<uint32_t>(joints.size()));
  for (const auto& [name, position] : joints) cdr.text(name);
  cdr.add(static_cast<uint32_t>(joints.size()));
  for (const auto& [name, position] : joints) cdr.add(position);
  return cdr.add(uint32_t{0}).add(uint32_t{0}).bytes();  // velocity and effort
}

std::string marker_array_message(const std::vector<Marker>& markers, TimeNs time, const std::string& frame) {
  CdrWriter cdr;
  cdr.add(static_cast<uint32_t>(markers.size() + 1));
  add_marker(cdr, {}, MarkerAction::delete_all, time, frame);
  for (const Marker& marker : markers) add_marker(cdr, marker, MarkerAction::add, time, frame);
  return cdr.bytes();
}

}  // namespace loci::mapping

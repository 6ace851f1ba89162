// Maps and recordings.

#include <cmath>

#include "mapping/base/output_file.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "python/bindings.h"

namespace loci::python {
namespace {

using mapping::Joint;
using mapping::JointType;
using mapping::Link;
using mapping::Visual;

// ---- Maps

/// What a URDF says; of the sidecar the JSON text, which Python keeps as a dictionary.
struct Map {
  mapping::World world;
  std::string sidecar;
};

Map read_map(const std::filesystem::path& path) {
  return unlocked([&] {
    Map map{mapping::read_urdf(path), {}};
    if (const auto sidecar = mapping::sidecar_path(path); std::filesystem::exists(sidecar))
      map.sidecar = to_json(mapping::read_semantic_map(sidecar)).dump();
    return map;
  });
}

/// Nothing is written unless both files can be.
void write_map(const Map& map, const std::filesystem::path& path, const std::string& sidecar, bool force) {
  unlocked([&] {
    const OutputOptions options{.replace = force ? Replace::anything : Replace::own};
    const auto beside = mapping::sidecar_path(path);
    const std::string text = mapping::urdf_text(map.world);
    mapping::parse_urdf(text, path.string());
    check_output(path, options);
    if (!sidecar.empty()) {
      const mapping::SemanticMap semantics =
          mapping::semantic_map_from_json(parse_json(sidecar, beside.string()), beside.string());
      for (const auto& [link, known] : semantics.links) map.world.link_index(link);
      write_output(beside, to_json(semantics).dump(2) + "\n", options);
    }
    write_output(path, text, options);
  });
}

template <class T>
void put(std::vector<T>& items, const T& item) {
  for (T& present : items)
    if (present.name == item.name) {
      present = item;
      return;
    }
  items.push_back(item);
}

template <class T>
T named(const std::string& name) {
  T item;
  item.name = name;
  return item;
}

Joint make_joint(const std::string& name, const std::string& type, const std::string& parent,
                 const std::string& child, const std::optional<py::array_t<double>>& parent_from_joint,
                 const std::array<double, 3>& axis, double lower, double upper) {
  Joint joint;
  joint.name = name, joint.parent = parent, joint.child = child;
  std::vector<std::string> names;
  for (const JointType each : {JointType::fixed, JointType::revolute, JointType::continuous,
                               JointType::prismatic, JointType::floating, JointType::planar}) {
    names.emplace_back(joint_type_name(each));
    if (names.back() == type) joint.type = each;
  }
  if (joint_type_name(joint.type) != type)
    throw Error("'" + type + "' is no type of joint", {}, did_you_mean(type, names));
  if (parent_from_joint) joint.parent_from_joint = pose_of(*parent_from_joint);
  joint.axis = Vector3d(axis.data());
  if (joint.type == JointType::revolute || joint.type == JointType::prismatic)
    joint.limits = mapping::JointLimits{.lower = lower, .upper = upper, .effort = 100, .velocity = 1};
  return joint;
}

std::string shape_of(const Visual& visual) {
  static constexpr const char* kNames[] = {"box", "cylinder", "sphere", "mesh"};
  return kNames[visual.geometry.index()];
}

py::array size_of(const Visual& visual) {
  if (const auto* box = std::get_if<mapping::Box>(&visual.geometry)) return array_of(box->size);
  if (const auto* cylinder = std::get_if<mapping::Cylinder>(&visual.geometry))
    return array_of(Vector3d(2 * cylinder->radius, 2 * cylinder->radius, cylinder->length));
  if (const auto* sphere = std::get_if<mapping::Sphere>(&visual.geometry))
    return array_of(Vector3d(Vector3d::Constant(2 * sphere->radius)));
  return array_of(std::get<mapping::Mesh>(visual.geometry).scale);
}

void add_box(Link& link, const std::array<double, 3>& size,
             const std::optional<py::array_t<double>>& link_from_box,
             const std::optional<std::array<float, 3>>& color) {
  const Isometry3d pose = link_from_box ? pose_of(*link_from_box) : Isometry3d::Identity();
  const mapping::Box box{Vector3d(size.data())};
  Visual visual{.name = {}, .link_from_visual = pose, .geometry = box, .material = {}};
  if (color)
    visual.material =
        mapping::Material{link.name + "_color", mapping::Rgba((*color)[0], (*color)[1], (*color)[2], 1), {}};
  link.visuals.push_back(visual);
  link.collisions.push_back({.name = {}, .link_from_collision = pose, .geometry = box});
}

std::map<std::string, py::array> poses_of(const Map& map, const JointState& joints) {
  const std::vector<Isometry3d> poses = mapping::root_from_links(map.world, joints);
  std::map<std::string, py::array> named;
  for (size_t i = 0; i < poses.size(); ++i) named.emplace(map.world.links[i].name, array_of(poses[i]));
  return named;
}

template <class T>
T found(const T* item, const std::string& kind, const std::string& name) {
  if (item == nullptr) throw Error("the map has no " + kind + " '" + name + "'");
  return *item;
}

void add_links_and_joints(py::module_& module) {
  py::class_<Visual>(module, "Visual", "A shape of a link.")
      .def_property_readonly("shape", shape_of, "'box', 'cylinder' (along z), 'sphere' or 'mesh'.")
      .def_property_readonly("size", size_of, "Full extents, m; of a mesh its scale.")
      .def_property_readonly(
          "uri",
          [](const Visual& visual) {
            const auto* mesh = std::get_if<mapping::Mesh>(&visual.geometry);
            return mesh == nullptr ? std::nullopt : std::optional(mesh->uri);
          },
          "File of a mesh, or None.")
      .def_property_readonly(
          "link_from_visual", [](const Visual& visual) { return array_of(visual.link_from_visual); },
          "Pose, 4 x 4.")
      .def("__repr__", [](const Visual& visual) { return "<loci.Visual " + shape_of(visual) + ">"; });

  py::class_<Link>(module, "Link", "A rigid part of a map.")
      .def(py::init(&named<Link>), py::arg("name"))
      .def_readonly("name", &Link::name, "Unique in the map.")
      .def_readonly("visuals", &Link::visuals, "Its shapes.")
      .def("add_box", add_box, py::arg("size"), py::arg("link_from_box") = py::none(),
           py::arg("color") = py::none(),
           "Adds a box to what is seen and to what is touched: full extents in m, pose 4 x 4, colour (r, g, "
           "b) "
           "from 0 to 1.")
      .def("__repr__", [](const Link& link) { return "<loci.Link '" + link.name + "'>"; });

  py::class_<Joint>(module, "Joint", "How a link hangs on another.")
      .def(py::init(&make_joint), py::arg("name"), py::arg("type"), py::arg("parent"), py::arg("child"),
           py::kw_only(), py::arg("parent_from_joint") = py::none(),
           py::arg("axis") = std::array<double, 3>{1, 0, 0}, py::arg("lower") = 0.0, py::arg("upper") = 0.0,
           "type: fixed, revolute, continuous, prismatic, floating or planar; limits in m or rad.")
      .def_readonly("name", &Joint::name, "Unique in the map.")
      .def_property_readonly(
          "type", [](const Joint& joint) { return std::string(joint_type_name(joint.type)); },
          "fixed, revolute, continuous, prismatic, floating or planar.")
      .def_readonly("parent", &Joint::parent, "Link.")
      .def_readonly("child", &Joint::child, "Link.")
      .def_property_readonly(
          "parent_from_joint", [](const Joint& joint) { return array_of(joint.parent_from_joint); },
          "Pose at position 0, 4 x 4.")
      .def_property_readonly(
          "axis", [](const Joint& joint) { return array_of(joint.axis); }, "In the frame of the joint.")
      .def_property(
          "lower",
          [](const Joint& joint) { return joint.limits ? std::optional(joint.limits->lower) : std::nullopt; },
          [](Joint& joint, double value) {
            joint.limits.emplace(joint.limits.value_or(mapping::JointLimits{})).lower = value;
          },
          "Least position, m or rad, or None.")
      .def_property(
          "upper",
          [](const Joint& joint) { return joint.limits ? std::optional(joint.limits->upper) : std::nullopt; },
          [](Joint& joint, double value) {
            joint.limits.emplace(joint.limits.value_or(mapping::JointLimits{})).upper = value;
          },
          "Greatest position, m or rad, or None.")
      .def("__repr__", [](const Joint& joint) {
        return "<loci.Joint '" + joint.name + "' " + joint_type_name(joint.type) + ">";
      });
}

// ---- Recordings

using RecordingPtr = std::shared_ptr<mapping::Recording>;

RecordingPtr open_recording(const std::filesystem::path& path, const py::kwargs& keywords) {
  mapping::RecordingOptions options;
  read_keywords(options, keywords, "loci.open_recording");
  return unlocked([&] { return RecordingPtr(mapping::open_recording(path, options)); });
}

mapping::RgbdFrame frame_at(const mapping::Recording& recording, py::ssize_t number) {
  const auto size = static_cast<py::ssize_t>(recording.size());
  const py::ssize_t index = number < 0 ? number + size : number;
  if (index < 0 || index >= size)
    throw py::index_error("the recording has " + std::to_string(size) + " frames");
  mapping::RgbdFrame frame = unlocked([&] { return recording.frame(static_cast<size_t>(index)); });
  if (!frame.damage.empty()) throw Error(frame.damage);
  return frame;
}

/// Writes frames given as arrays.
class Writer {
 public:
  Writer(const std::filesystem::path& folder, const mapping::PinholeCamera& depth,
         const std::optional<mapping::PinholeCamera>& color,
         const std::optional<py::array_t<double>>& depth_from_color, const std::string& map_frame,
         bool time_assumed)
      : camera_{depth, color.value_or(depth),
                depth_from_color ? pose_of(*depth_from_color) : Isometry3d::Identity()},
        writer_(std::make_unique<mapping::RecordingWriter>(
            folder, camera_, map_frame, mapping::RecordingWriterOptions{.time_assumed = time_assumed})) {}

  void add(const TimeArgument& time, const py::array& depth, const std::optional<py::array>& color,
           const std::optional<py::array_t<double>>& map_from_camera, const JointState& joints) {
    if (!writer_) throw Error("the recording is finished");
    mapping::RgbdFrame frame{
        .index = count_++,
        .name = {},
        .time_ns = time_of(time),
        .camera = camera_,
        .depth = depth_of(depth),
        .color = color ? bgr_of(*color) : cv::Mat(),
        .map_from_camera = map_from_camera ? std::optional(pose_of(*map_from_camera)) : std::nullopt,
        .joints = joints,
        .damage = {}};
    check_size(frame.depth, camera_.depth, "depth");
    if (!frame.color.empty()) check_size(frame.color, camera_.color, "colour");
    unlocked([&] { writer_->add(frame); });
  }
  void finish() {
    if (!writer_) return;
    if (count_ == 0) throw Error("no frame was added: nothing is written", {}, "add(time, depth, ...) first");
    unlocked([&] { writer_->finish(); });
    writer_.reset();
  }
  void discard() { writer_.reset(); }

 private:
  /// Metres of floating-point numbers, or of whole millimetres.
  static cv::Mat depth_of(const py::array& array) {
    const char kind = array.dtype().kind();
    if (kind != 'f' && kind != 'u' && kind != 'i')
      throw Error("a depth image holds metres (float) or millimetres (integers)");
    using Metres = py::array_t<float, py::array::c_style | py::array::forcecast>;
    cv::Mat depth = image_of(Metres::ensure(array), CV_32F, "a depth image");
    if (kind != 'f') depth *= 0.001;
    const double max_m = 65534 * mapping::RecordingWriterOptions{}.depth_unit_m;
    size_t measured = 0, stored = 0;
    for (const float z : cv::Mat_<float>(depth)) {
      measured += std::isfinite(z) && z != 0 ? 1 : 0;
      stored += z > 0 && static_cast<double>(z) <= max_m ? 1 : 0;
    }
    if (measured > 0 && stored == 0)
      throw Error("none of the depths lies between 0 and " + std::to_string(static_cast<int>(max_m)) + " m",
                  {}, "depth is metres as floating-point numbers, or millimetres as integers");
    return depth;
  }
  static void check_size(const cv::Mat& image, const mapping::PinholeCamera& camera, const char* what) {
    if (image.cols != camera.width || image.rows != camera.height)
      throw Error(std::string("the ") + what + " image has " + std::to_string(image.rows) + " rows and " +
                      std::to_string(image.cols) + " columns",
                  {},
                  "its camera has " + std::to_string(camera.height) + " and " + std::to_string(camera.width));
  }

  mapping::RgbdCamera camera_;
  std::unique_ptr<mapping::RecordingWriter> writer_;
  int64_t count_ = 0;
};

void add_recordings(py::module_& module) {
  using Frame = mapping::RgbdFrame;
  py::class_<Frame>(module, "Frame", "One colour and depth image pair of a recording.")
      .def_readonly("index", &Frame::index, "As in the recording.")
      .def_readonly("name", &Frame::name, "Of its depth image.")
      .def_property_readonly(
          "time", [](const Frame& frame) { return datetime_of(frame.time_ns); }, "datetime, UTC.")
      .def_readonly("time_ns", &Frame::time_ns, "Nanoseconds since 1970, UTC.")
      .def_property_readonly(
          "color", [](const Frame& frame) { return rgb_array_of(frame.color); },
          "Rows x columns x 3, RGB, 8 bit, or None.")
      .def_property_readonly(
          "depth", [](const Frame& frame) { return array_of(frame.depth); },
          "Rows x columns, float32, z in m, NaN = no measurement.")
      .def_property_readonly(
          "color_in_depth", [](const Frame& frame) { return rgb_array_of(mapping::color_in_depth(frame)); },
          "The colour image as the depth camera would see it.")
      .def_property_readonly(
          "camera", [](const Frame& frame) { return frame.camera.depth; }, "The depth camera.")
      .def_property_readonly(
          "color_camera", [](const Frame& frame) { return frame.camera.color; }, "The colour camera.")
      .def_property_readonly(
          "depth_from_color", [](const Frame& frame) { return array_of(frame.camera.depth_from_color); },
          "Pose of the colour camera in the frame of the depth camera, 4 x 4.")
      .def_property_readonly(
          "map_from_camera", [](const Frame& frame) { return array_or_none(frame.map_from_camera); },
          "Pose of the depth camera, 4 x 4, or None.")
      .def_readonly("joints", &Frame::joints, "Positions of joints by name, m or rad.")
      .def("__repr__", [](const Frame& frame) {
        return "<loci.Frame " + std::to_string(frame.index) + " " + format_time(frame.time_ns) + ">";
      });

  py::class_<mapping::Recording, RecordingPtr>(
      module, "Recording",
      "Posed colour and depth images in order of time. An image is read "
      "when its frame is asked for.")
      .def("__len__", &mapping::Recording::size)
      .def("__getitem__", frame_at, py::arg("number"))
      .def("__iter__",
           [](const py::object& self) {
             return FrameIterator(py::reinterpret_steal<py::object>(PySeqIter_New(self.ptr())));
           })
      .def("_info", [](const mapping::Recording& recording) { return to_json(recording.info()).dump(); });
  module.def("_open_recording", open_recording);

  py::class_<Writer>(
      module, "RecordingWriter",
      "Writes a recording. Nothing is at its place before finish(); an older recording of loci is "
      "replaced, anything else is not. In a `with` statement finish() comes at its end, unless "
      "something went wrong.")
      .def(py::init<const std::filesystem::path&, const mapping::PinholeCamera&,
                    const std::optional<mapping::PinholeCamera>&, const std::optional<py::array_t<double>>&,
                    const std::string&, bool>(),
           py::arg("folder"), py::arg("camera"), py::kw_only(), py::arg("color_camera") = py::none(),
           py::arg("depth_from_color") = py::none(), py::arg("map_frame") = "map",
           py::arg("time_assumed") = false,
           "camera: of the depth images, and of colour where no other is given; time_assumed: the times are "
           "made up")
      .def(
          "add", &Writer::add, py::arg("time"), py::arg("depth"), py::arg("color") = py::none(),
          py::arg("map_from_camera") = py::none(), py::arg("joints") = JointState(),
          "Adds a frame: z in m (integers: mm) with NaN or 0 = no measurement, RGB, pose of the depth camera "
          "4 x 4. Depth beyond 65 m is stored as no measurement; a frame of which all is, is refused. "
          "Frames "
          "come in order of time.")
      .def("finish", &Writer::finish, "Puts the recording at its place.")
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Writer& writer, const py::args& raised) {
        if (raised.empty() || raised[0].is_none())
          writer.finish();
        else
          writer.discard();
      });
}

}  // namespace

void add_mapping(py::module_& module) {
  add_links_and_joints(module);
  py::class_<Map>(module, "Map", py::dynamic_attr(),
                  "A map: links and joints of a URDF, and what its sidecar says of the links.")
      .def(py::init([](const std::string& name) {
             return Map{named<mapping::World>(name), {}};
           }),
           py::arg("name"))
      .def_static("_read", read_map)
      .def("_write", write_map)
      .def_readonly("_sidecar", &Map::sidecar)
      .def_property_readonly(
          "name", [](const Map& map) { return map.world.name; }, "Of the robot element.")
      .def_property_readonly(
          "links", [](const Map& map) { return map.world.links; }, "Copies, in order of the file.")
      .def_property_readonly(
          "joints", [](const Map& map) { return map.world.joints; }, "Copies, in order of the file.")
      .def(
          "link",
          [](const Map& map, const std::string& name) {
            return found(map.world.find_link(name), "link", name);
          },
          py::arg("name"), "A copy of the link of this name.")
      .def(
          "joint",
          [](const Map& map, const std::string& name) {
            return found(map.world.find_joint(name), "joint", name);
          },
          py::arg("name"), "A copy of the joint of this name.")
      .def(
          "put_link", [](Map& map, const Link& link) { put(map.world.links, link); }, py::arg("link"),
          "Adds a link, or replaces the one of its name.")
      .def(
          "put_joint", [](Map& map, const Joint& joint) { put(map.world.joints, joint); }, py::arg("joint"),
          "Adds a joint, or replaces the one of its name.")
      .def("poses", poses_of, py::arg("joints") = JointState(),
           "The pose of each link in the frame of the root, 4 x 4, with joints at these positions (0 where "
           "they are "
           "not named).")
      .def("__repr__", [](const Map& map) {
        return "<loci.Map '" + map.world.name + "', " + std::to_string(map.world.links.size()) + " links>";
      });
  add_recordings(module);
}

}  // namespace loci::python

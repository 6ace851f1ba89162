// Pipelines, and annotators that are written in Python.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>
#include <variant>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/base/user_time_zone.h"
#include "mapping/recording/pose_check.h"
#include "mapping/recording/recording.h"
#include "mapping/tracking/known_poses.h"
#include "mapping/update/placement.h"
#include "memory/annotators/memory_annotators.h"
#include "memory/annotators/memory_session.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/io/labelled_recording.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/known_map.h"
#include "perception/cas/json.h"
#include "perception/conversions/opencv.h"
#include "perception/pipeline/pipeline.h"
#include "perception/types/scene_json.h"
#include "python/bindings.h"

namespace loci::python {
namespace {

using perception::types::Cluster;
using perception::types::SceneCas;

/// The CAS that an annotator works on, as long as it does.
struct Access {
  perception::cas::Cas* cas = nullptr;
  std::string annotator;

  SceneCas scene() const {
    if (cas == nullptr) throw Error("this scene is over", {}, "copy what is needed later");
    return SceneCas(*cas);
  }
};
using AccessPtr = std::shared_ptr<Access>;

/// An array that nobody writes to: annotators share the memory.
std::optional<py::array> shared_array_of(const cv::Mat& image) {
  std::optional<py::array> array = array_of(image);
  if (array) array->attr("setflags")(py::arg("write") = false);
  return array;
}

/// The type of an annotation by its full or short name.
perception::cas::Type annotation_type(const perception::cas::TypeSystem& types, const std::string& name) {
  std::vector<std::string> names;
  for (const perception::cas::Type& type :
       types.subtypes(types.type(perception::types::Annotation::kTypeName))) {
    if (type.name() == name || type.short_name() == name) return type;
    names.push_back(type.short_name());
  }
  throw Error("'" + name + "' is no type of annotation", {}, did_you_mean(name, names));
}

perception::types::Annotation make_annotation(const Access& access, const std::string& name,
                                              const std::string& features) {
  const SceneCas scene = access.scene();
  Json values = parse_json(features, name);
  if (!values.contains("source")) values["source"] = access.annotator;
  const Json structure = {
      {"id", 1}, {"type", annotation_type(scene.cas().type_system(), name).name()}, {"features", values}};
  const Json graph = {{"root", "#1"}, {"structures", Json::array({structure})}};
  return perception::types::Annotation(perception::cas::from_json(scene.cas(), graph));
}

struct ClusterAccess {
  AccessPtr access;
  Cluster cluster;
  int number = 0;

  /// Error when the scene is over.
  const Cluster& get() const {
    access->scene();
    return cluster;
  }
  cv::Mat mask() const {
    const SceneCas scene = access->scene();
    cv::Mat mask = cv::Mat::zeros(perception::types::view_image(scene, SceneCas::kDepth).size(), CV_8U);
    for (const int32_t index : perception::cluster_indices(get())) mask.ptr<uint8_t>()[index] = 255;
    return mask;
  }
  std::vector<Eigen::Vector3f> points() const {
    const cv::Mat cloud = perception::cloud_points(access->scene());
    std::vector<Eigen::Vector3f> points;
    for (const int32_t index : perception::cluster_indices(get()))
      points.push_back(perception::to_vector3f(cloud.ptr<cv::Vec3f>()[index]));
    return points;
  }
};

std::string annotations_text(const auto& annotations) {
  Json json = Json::array();
  for (const perception::types::Annotation& annotation : annotations)
    json.push_back(to_json(annotation, perception::types::Arrays::written));
  return json.dump();
}

std::vector<ClusterAccess> clusters_of(const AccessPtr& access) {
  std::vector<ClusterAccess> clusters;
  for (const Cluster& cluster : access->scene().clusters())
    clusters.push_back({access, cluster, static_cast<int>(clusters.size()) + 1});
  return clusters;
}

cv::Mat image_of_cluster(const ClusterAccess& cluster) {
  const auto region = cluster.get().hypotheses.first<perception::types::StandaloneImageROI>();
  return region ? perception::types::from<cv::Mat>(region.image.get()) : cv::Mat();
}

void set_view(const Access& access, const std::string& name, const py::array& array) {
  for (const int depth : {CV_8U, CV_16U, CV_32F})
    if (dtype_of(depth).equal(array.dtype()))
      return perception::types::set_view_image(
          access.scene(), name,
          image_of(array, CV_MAKETYPE(depth, array.ndim() == 3 ? static_cast<int>(array.shape(2)) : 1),
                   "a view"));
  throw Error("a view holds uint8, uint16 or float32");
}

// ---- Annotators

/// An object of Python that is let go under Python's lock, whoever lets it go.
using Held = std::shared_ptr<py::object>;
Held hold(py::object object) {
  return {new py::object(std::move(object)), [](py::object* held) {
            const py::gil_scoped_acquire acquired;
            delete held;
          }};
}

/// What Python raised, in one line: the message, and the line of the annotator's file that led to it, not
/// that of a library which it calls.
Error error_of(const py::error_already_set& raised) {
  std::istringstream lines(raised.what());
  std::string text, line;
  std::getline(lines, text);
  constexpr std::string_view kNoMessage = ": <EMPTY MESSAGE>";
  if (text.ends_with(kNoMessage)) text.erase(text.size() - kNoMessage.size());
  std::vector<std::string> calls;  // "FILE(LINE): FUNCTION", innermost first
  while (std::getline(lines, line))
    if (line.starts_with("  ")) calls.push_back(trimmed(line));
  if (calls.empty()) return Error(text);
  const py::object trace = raised.trace();  // begins with what C++ called
  const std::string file =
      trace ? trace.attr("tb_frame").attr("f_code").attr("co_filename").cast<std::string>() + "(" : "";
  const auto own =
      std::ranges::find_if(calls, [&](const std::string& call) { return call.starts_with(file); });
  return Error(text + " at " + (own == calls.end() ? calls.front() : *own));
}

/// Runs under Python's lock. An exception becomes an Error, but for those that are to end the program.
template <class Function>
auto locked(Function&& function) {
  const py::gil_scoped_acquire acquired;
  try {
    return function();
  } catch (const py::error_already_set& raised) {
    if (!raised.matches(PyExc_Exception)) throw;
    throw error_of(raised);
  }
}

/// What Python raised that stops a run whatever the policies of its steps: KeyboardInterrupt and the like,
/// and anything of `done`. A resource of the run.
struct Stop {
  std::optional<py::error_already_set> raised;
};

/// What a class declares; Error when it is something else.
template <class T>
T declared(const py::object& annotator, const char* name, const char* expected) {
  const py::object value = annotator.attr(name);
  try {
    return value.cast<T>();
  } catch (const py::cast_error&) {
    throw Error(fmt::format("{}.{} is {}", py::type::of(annotator).attr("__name__").cast<std::string>(), name,
                            py::repr(value).cast<std::string>()),
                {}, fmt::format("give {}", expected));
  }
}

class PythonAnnotator : public perception::Annotator {
 public:
  explicit PythonAnnotator(const Held& type) {
    locked([&] {
      const py::object made = (*type)();
      const auto names = [&](const char* attribute) {
        return declared<std::vector<std::string>>(made, attribute, "a list of texts, such as [\"Cluster\"]");
      };
      descriptor_ = {.name = declared<std::string>(made, "name", "a text"),
                     .description = declared<std::string>(made, "description", "a text"),
                     .inputs = names("inputs"),
                     .outputs = names("outputs"),
                     .optional_inputs = names("optional_inputs"),
                     .modifies = {},
                     .shares = {"python"}};  // classes may keep what others read
      for (const auto& [name, value] : declared<std::map<std::string, py::object>>(
               made, "options", "a dictionary of names with defaults"))
        options_.emplace_back(name, option_of(descriptor_.name + ".options." + name, value));
      annotator_ = hold(made);
    });
  }
  perception::AnnotatorDescriptor descriptor() const override { return descriptor_; }

  void declare(OptionTable& table) override {
    const double infinity = std::numeric_limits<double>::infinity();
    for (auto& [name, value] : options_) {
      if (auto* flag = std::get_if<bool>(&value)) table.flag(name, *flag, "");
      if (auto* integer = std::get_if<int>(&value))
        table.integer(name, *integer, "", "", std::numeric_limits<int>::min(),
                      std::numeric_limits<int>::max());
      if (auto* number = std::get_if<double>(&value))
        table.number(name, *number, "", "", -infinity, infinity);
      if (auto* text = std::get_if<std::string>(&value)) table.text(name, *text, "");
    }
  }
  void start(perception::Context&) override {
    locked([&] {
      for (const auto& [name, value] : options_) annotator_->attr(name.c_str()) = value;
      annotator_->attr("start")();
    });
  }
  void process(perception::cas::Cas& cas, perception::Context& context) override {
    const AccessPtr access = std::make_shared<Access>(Access{&cas, descriptor_.name});
    const std::shared_ptr<void> over(nullptr, [&](void*) { access->cas = nullptr; });
    try {
      locked([&] { annotator_->attr("process")(access); });
    } catch (const py::error_already_set& raised) {
      const py::gil_scoped_acquire acquired;
      context.resources.get<Stop>("run of Python").raised = raised;
      throw Interrupted();
    }
  }
  void finish(perception::Context&) override {
    locked([&] { annotator_->attr("finish")(); });
  }

 private:
  using Value = std::variant<bool, int, double, std::string>;
  /// Of a default, also of numpy.
  static Value option_of(const std::string& name, const py::object& given) {
    const bool is_scalar = py::hasattr(given, "item") && given.attr("size").cast<py::ssize_t>() == 1;
    const py::object value = is_scalar ? py::object(given.attr("item")()) : given;
    try {
      if (py::isinstance<py::bool_>(value)) return value.cast<bool>();
      if (py::isinstance<py::int_>(value)) return value.cast<int>();
      if (py::isinstance<py::float_>(value)) return value.cast<double>();
      return value.cast<std::string>();
    } catch (const py::cast_error&) {
      throw Error(fmt::format("{} is {}", name, py::repr(value).cast<std::string>()), {},
                  "give a bool, an int of 32 bits, a float or a text");
    }
  }

  Held annotator_;
  perception::AnnotatorDescriptor descriptor_;
  std::vector<std::pair<std::string, Value>> options_;
};

struct RunOptions {
  mapping::RecordingOptions reading;
  std::filesystem::path map, memory;
  std::string pipeline;                 ///< its text
  std::filesystem::path pipeline_file;  ///< or its file
  std::vector<Held> annotators;
  std::vector<std::filesystem::path> types;
  bool resume = false, fixed_camera = false;
  int threads = 0, every = 0;  ///< all cores; as the pipeline says
  std::optional<TimeNs> now;
  std::shared_ptr<Stop> stop = std::make_shared<Stop>();
};

/// What loci has, and own annotators, whose descriptors are added to `descriptors`. Making an own one asks
/// its class once: the first that is made is the one that was asked for its declaration.
perception::AnnotatorRegistry registry_with(const std::vector<Held>& annotators,
                                            std::vector<perception::AnnotatorDescriptor>& descriptors) {
  perception::AnnotatorRegistry registry;
  perception::add_annotators(registry);
  memory::add_memory_annotators(registry);
  perception::AnnotatorRegistry own;
  for (const Held& type : annotators) {
    const auto asked =
        std::make_shared<std::unique_ptr<PythonAnnotator>>(std::make_unique<PythonAnnotator>(type));
    descriptors.push_back((*asked)->descriptor());
    own.add(descriptors.back().name,
            [type, asked] { return *asked ? std::move(*asked) : std::make_unique<PythonAnnotator>(type); });
  }
  registry.merge(own, {"annotators", 0, {}});
  return registry;
}

/// What an annotator of Python adds to a scene are views, and annotations of known types.
void check_outputs(const perception::AnnotatorDescriptor& descriptor,
                   const perception::cas::TypeSystem& types) {
  for (const std::string& output : descriptor.outputs)
    if (output != "Cluster" && !output.starts_with("view:")) try {
        annotation_type(types, output);
      } catch (const Error& error) {
        throw Error(descriptor.name + ".outputs: " + error.message(), {}, error.hint());
      }
}

memory::MemoryRunResult run_pipeline(std::unique_ptr<mapping::Recording> recording, const RunOptions& options,
                                     const std::function<void(perception::cas::Cas&)>& done,
                                     Progress& progress, Warnings& warnings) {
  std::vector<perception::AnnotatorDescriptor> own;
  const perception::AnnotatorRegistry registry = registry_with(options.annotators, own);
  const Config config = !options.pipeline_file.empty() ? Config::read(options.pipeline_file)
                        : !options.pipeline.empty()
                            ? Config::parse(options.pipeline, "pipeline")
                            : Config::parse(perception::default_pipeline(), "the default pipeline");
  perception::Pipeline pipeline = perception::Pipeline::parse(
      options.every > 0 ? perception::with_every(config, options.every) : config, registry);
  for (const perception::AnnotatorDescriptor& one : own) pipeline.add(one.name, registry);
  for (const std::string& problem : problems_of(*recording, options.reading)) warnings.add(problem);
  if (!options.map.empty())
    recording = perceived_in_map(std::move(recording), options.map, options.fixed_camera, options.threads,
                                 progress, warnings);
  else if (!options.fixed_camera)
    recording = with_known_poses(std::move(recording), mapping::PosesFor::perception, options.threads,
                                 progress, warnings);
  perception::Resources resources;
  resources.put(std::shared_ptr<mapping::Recording>(std::move(recording)));
  resources.put(options.stop);
  if (!options.map.empty()) {
    const auto map = perception::KnownMap::load(options.map, {}, warnings);
    resources.put(map);
    resources.put(std::make_shared<mapping::World>(map->world));
  }
  const auto types = options.types.empty() ? perception::types::type_system()
                                           : perception::types::type_system_with(options.types);
  for (const perception::AnnotatorDescriptor& one : own) check_outputs(one, *types);
  perception::Context context{resources, warnings, options.threads, {}};
  if (options.memory.empty()) return {pipeline.run(context, types, progress, done), 0};
  memory::MemorySessionOptions session;
  session.memory = options.memory;
  session.program = "loci.run";
  session.resume = options.resume;
  session.map = options.map;
  session.write.now = options.now;
  session.default_time_zone = user_time_zone(std::getenv("TZ")).name();
  memory::add_memory_session(session, pipeline, registry, resources);
  return memory::run_with_memory(pipeline, context, types, progress, done);
}

std::string run(const std::filesystem::path& path, const std::string& pipeline,
                const std::filesystem::path& pipeline_file, const py::list& annotators,
                const std::vector<std::filesystem::path>& types, const std::filesystem::path& map,
                const std::filesystem::path& memory, bool resume, bool fixed_camera, int threads, int every,
                const py::object& done, const ProgressCallable& progress, const TimeArgument& now,
                const py::kwargs& keywords) {
  RunOptions options;
  options.map = map;
  options.memory = memory;
  options.pipeline = pipeline;
  options.pipeline_file = pipeline_file;
  options.types = types;
  options.resume = resume;
  options.fixed_camera = fixed_camera;
  options.threads = threads;
  options.every = every;
  options.now = time_or_none(now);
  for (const py::handle& type : annotators)
    options.annotators.push_back(hold(py::reinterpret_borrow<py::object>(type)));
  read_keywords(options.reading, keywords, "loci.run");
  const auto call_done = [&](perception::cas::Cas& cas) {
    const py::gil_scoped_acquire acquired;
    const AccessPtr access = std::make_shared<Access>(Access{&cas, {}});
    try {
      done(access);
    } catch (py::error_already_set& error) {
      options.stop->raised = error;
    }
    access->cas = nullptr;
    if (options.stop->raised) throw Interrupted();
  };
  Warnings warnings;
  try {
    const memory::MemoryRunResult result = run_stage(progress, [&](Progress& p) {
      return run_pipeline(mapping::open_recording(path, options.reading), options,
                          done.is_none() ? std::function<void(perception::cas::Cas&)>() : call_done, p,
                          warnings);
    });
    raise_warnings(warnings);
    const Json json = {{"frames", result.pipeline.frames},
                       {"skipped", result.skipped},
                       {"left_out", result.pipeline.left_out},
                       {"seconds", Json(result.pipeline.seconds)}};
    return json.dump();
  } catch (...) {
    if (options.stop->raised) throw *options.stop->raised;
    throw;
  }
}

std::string describe_annotators() {
  std::vector<perception::AnnotatorDescriptor> none;
  const perception::AnnotatorRegistry registry = registry_with({}, none);
  Json json = Json::array();
  for (const std::string& name : registry.annotators()) {
    const auto annotator = registry.make(name);
    json.push_back(perception::describe(annotator->descriptor(), table_of(*annotator)));
  }
  return json.dump();
}

}  // namespace

void add_perception(py::module_& module) {
  py::class_<ClusterAccess>(module, "Cluster", "An object that was segmented in a scene of a pipeline.")
      .def_readonly("number", &ClusterAccess::number, "Within the scene, from 1.")
      .def_property_readonly(
          "place",
          [](const ClusterAccess& cluster) {
            return cluster.get().place.is_set() ? std::optional(cluster.get().place.get()) : std::nullopt;
          },
          "Name of the place it is at, or None.")
      .def_property_readonly(
          "mask", [](const ClusterAccess& cluster) { return array_of(cluster.mask()); },
          "Its pixels in the depth image: uint8, 255 = its own.")
      .def_property_readonly(
          "points", [](const ClusterAccess& cluster) { return array_of(cluster.points()); },
          "N x 3, float32, camera frame, m.")
      .def_property_readonly(
          "image", [](const ClusterAccess& cluster) { return rgb_array_of(image_of_cluster(cluster)); },
          "Its region of the colour image, RGB, or None.")
      .def("_annotations",
           [](const ClusterAccess& cluster) { return annotations_text(cluster.get().annotations); })
      .def("_annotate",
           [](const ClusterAccess& cluster, const std::string& type, const std::string& features) {
             cluster.get().annotations.push_back(make_annotation(*cluster.access, type, features));
           });

  py::class_<Access, AccessPtr>(
      module, "PerceivedScene",
      "A scene while it is processed. Arrays share their memory: they are to be read.")
      .def_property_readonly(
          "frame", [](const Access& access) { return access.scene().scene().frame_index.get(); },
          "Index of the frame in the recording.")
      .def_property_readonly(
          "time", [](const Access& access) { return datetime_of(access.scene().scene().timestamp.get()); },
          "datetime, UTC.")
      .def_property_readonly(
          "map_from_camera",
          [](const Access& access) { return array_of(perception::map_from_camera(access.scene().scene())); },
          "Pose of the depth camera, 4 x 4.")
      .def_property_readonly(
          "color",
          [](const Access& access) {
            const SceneCas scene = access.scene();
            return scene.has(SceneCas::kColor)
                       ? rgb_array_of(perception::types::view_image(scene, SceneCas::kColor))
                       : std::nullopt;
          },
          "The colour image, RGB, 8 bit, or None.")
      .def_property_readonly(
          "depth",
          [](const Access& access) {
            return shared_array_of(perception::types::view_image(access.scene(), SceneCas::kDepth));
          },
          "Rows x columns, float32, z in m, NaN = no measurement.")
      .def_property_readonly(
          "cloud",
          [](const Access& access) { return shared_array_of(perception::cloud_points(access.scene())); },
          "Rows x columns x 3, float32, camera frame, m, NaN = no measurement.")
      .def_property_readonly(
          "normals",
          [](const Access& access) { return shared_array_of(perception::cloud_normals(access.scene())); },
          "Rows x columns x 3, float32, camera frame.")
      .def(
          "view",
          [](const Access& access, const std::string& name) -> std::optional<py::array> {
            const SceneCas scene = access.scene();
            if (!scene.has(name)) return std::nullopt;
            if (name == SceneCas::kCloud) return shared_array_of(perception::cloud_points(scene));
            if (name == SceneCas::kNormals) return shared_array_of(perception::cloud_normals(scene));
            return shared_array_of(perception::types::view_image(scene, name));
          },
          py::arg("name"), "The image of a view as it is kept, or None; colour is BGR there.")
      .def("set_view", set_view, py::arg("name"), py::arg("image"),
           "Makes a copy of an image (uint8, uint16 or float32) the view of this name.")
      .def_property_readonly("clusters", clusters_of, "The objects that were segmented, in order.")
      .def(
          "log",
          [](const Access& access, const std::string& text) {
            access.scene().log(access.annotator, "info", text);
          },
          py::arg("text"), "Adds a line to the log of the scene.")
      .def("_data", [](const Access& access) { return to_json(access.scene()).dump(); })
      .def("_annotate", [](const Access& access, const std::string& type, const std::string& features) {
        access.scene().scene().annotations.push_back(make_annotation(access, type, features));
      });

  module.def("_run", run, py::arg("recording"), py::arg("pipeline"), py::arg("pipeline_file"),
             py::arg("annotators"), py::arg("types"), py::arg("map"), py::arg("memory"), py::arg("resume"),
             py::arg("fixed_camera"), py::arg("threads"), py::arg("every"), py::arg("done"),
             py::arg("progress"), py::arg("now"));
  module.def("_annotators", describe_annotators);
  module.def("_default_pipeline", [] { return perception::default_pipeline(); });
}

}  // namespace loci::python

// Memories: questions, scenes, observations, tables.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <mutex>
#include <tuple>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/base/user_time_zone.h"
#include "mapping/image/image_io.h"
#include "memory/catalogue/catalogue.h"
#include "memory/edits/edit_actions.h"
#include "memory/exchange/observation_image.h"
#include "memory/fleet/fleet_replica.h"
#include "memory/ingest/ingest.h"
#include "memory/questions/facts.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/reply.h"
#include "memory/sentences/natural_language.h"
#include "memory/store/public_views.h"
#include "memory/store/scene_images.h"
#include "memory/store/store.h"
#include "python/bindings.h"

namespace loci::python {
namespace {

using memory::Id;

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// A memory that is open. A Store is used by one thread at a time: those of Python take turns.
class OpenMemory {
 public:
  OpenMemory(const std::filesystem::path& path, bool write, const memory::WriteOptions& options)
      : path_(path),
        store_(write ? memory::Store::open_write(path, options) : memory::Store::open_read(path)) {}

  /// Calls function(store) unlocked. Error when it was closed.
  template <class Function>
  auto with_store(Function&& function) {
    return unlocked([&] {
      const std::lock_guard lock(mutex_);
      if (!store_) throw Error("the memory is closed", {path_.string(), 0, {}});
      return function(*store_);
    });
  }
  void close() {
    unlocked([&] {
      const std::lock_guard lock(mutex_);
      store_.reset();
    });
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::mutex mutex_;
  std::optional<memory::Store> store_;
};
using MemoryPtr = std::shared_ptr<OpenMemory>;

/// An answer in words, and as JSON.
using TextAndData = std::pair<std::string, std::string>;

TextAndData answer_query(OpenMemory& memory, const std::string& question,
                         const std::map<std::string, std::string>& arguments) {
  return memory.with_store([&](const memory::Store& store) -> TextAndData {
    const memory::Question& declared = *memory::find_question(question);
    const memory::Query query{question, arguments};
    const memory::Answer answer = declared.ask(store, query);
    const memory::Reply reply = declared.reply(store, query, answer);
    return {full_text(reply, answer, memory::TimeWriter(store)), dumped(full_json(reply, answer))};
  });
}

std::vector<TextAndData> answer_sentences(OpenMemory& memory, const std::vector<std::string>& sentences,
                                          const std::string& at, const std::string& known_at) {
  return memory.with_store([&](const memory::Store& store) {
    std::vector<TextAndData> answers;
    const memory::AsOf as_of = memory::read_as_of(store, at, known_at);
    for (const memory::NaturalLanguageAnswer& answer :
         ask(store, memory::NaturalLanguageQuestion{sentences, as_of}))
      answers.emplace_back(to_text(answer, memory::TimeWriter(store)), dumped(to_json(answer)));
    return answers;
  });
}

py::object cell_of(const Json& value) {
  if (value.is_number_integer()) return py::int_(value.get<int64_t>());
  if (value.is_number()) return py::float_(value.get<double>());
  if (value.is_string()) return py::str(value.get_ref<const std::string&>());
  return py::none();
}

py::dict table(OpenMemory& memory, const std::string& name) {
  if (std::ranges::count(memory::kPublicViews, name) == 0)
    throw Error("there is no table '" + name + "'", {memory.path().string(), 0, {}},
                "there are: " + joined({memory::kPublicViews.begin(), memory::kPublicViews.end()}, ", "));
  std::vector<Json> rows;
  const std::vector<std::string> names = memory.with_store([&](const memory::Store& store) {
    store.read_view("v_" + name, [&](const Json& row) { rows.push_back(row); });
    return store.view_columns("v_" + name);
  });
  py::dict columns;
  for (const std::string& column : names) columns[py::str(column)] = py::list();
  for (const Json& row : rows)
    for (const auto& [column, value] : row.items())
      columns[py::str(column)].cast<py::list>().append(cell_of(value));
  return columns;
}

// ---- Scenes and observations

struct Scene {
  MemoryPtr memory;
  memory::SceneRow row;

  cv::Mat image() const {
    if (!row.image) return {};
    return memory->with_store([&](const memory::Store& store) {
      return mapping::decode_color(store.blob(*row.image).bytes, memory->path().string());
    });
  }
  /// Metres, NaN = nothing was measured.
  cv::Mat depth() const {
    return memory->with_store([&](const memory::Store& store) -> cv::Mat {
      const std::vector<float> values = depth_thumbnail(store, row);
      if (values.empty()) return {};
      cv::Mat depth =
          cv::Mat(row.depth_height, row.depth_width, CV_32F, const_cast<float*>(values.data())).clone();
      depth.setTo(std::numeric_limits<float>::quiet_NaN(), depth == 0);
      return depth;
    });
  }
  cv::Mat labels() const {
    return memory->with_store([&](const memory::Store& store) { return label_image(store, row); });
  }
};

struct Observation {
  MemoryPtr memory;
  memory::SceneRow scene;
  memory::ObservationRow row;
  std::optional<Id> object;

  cv::Mat crop() const {
    if (!row.crop) return {};
    return memory->with_store([&](const memory::Store& store) {
      return mapping::decode_color(store.blob(*row.crop).bytes, memory->path().string());
    });
  }
  cv::Mat mask() const {
    return memory->with_store([&](const memory::Store& store) { return mask_of(store, scene, row); });
  }
  std::optional<mapping::Scan> cloud() const {
    return memory->with_store([&](const memory::Store& store) { return cloud_of(store, scene, row); });
  }
};

std::vector<Scene> scenes_of(const MemoryPtr& memory, std::optional<TimeNs> from, std::optional<TimeNs> to) {
  const auto rows =
      memory->with_store([&](const memory::Store& store) { return store.scenes({}, from, to); });
  std::vector<Scene> scenes;
  for (const memory::SceneRow& row : rows) scenes.push_back({memory, row});
  return scenes;
}

std::vector<Observation> observations_of(const Scene& scene) {
  return scene.memory->with_store([&](const memory::Store& store) {
    std::map<Id, Id> objects;
    for (const memory::AssociationRow& association : store.associations(scene.row.id))
      if (association.chosen && association.observation && association.object)
        objects[*association.observation] = *association.object;
    std::vector<Observation> observations;
    for (const memory::ObservationRow& row : store.observations(scene.row.id)) {
      const auto object = objects.find(row.id);
      observations.push_back(
          {scene.memory, scene.row, row, object == objects.end() ? std::optional<Id>() : object->second});
    }
    return observations;
  });
}

std::optional<std::string> place_name(OpenMemory& memory, std::optional<Id> place) {
  if (!place) return std::nullopt;
  return memory.with_store([&](const memory::Store& store) -> std::optional<std::string> {
    for (const memory::PlaceRow& row : memory::named_places(store))
      if (row.id == *place) return row.name;
    return std::nullopt;
  });
}

using Annotation = std::tuple<std::string, std::string, std::optional<double>>;

std::vector<Annotation> annotations_of(const Observation& observation) {
  const auto rows = observation.memory->with_store(
      [&](const memory::Store& store) { return store.annotations(observation.scene.id); });
  std::vector<Annotation> list;
  for (const memory::AnnotationRow& row : rows)
    if (row.observation == observation.row.id) list.emplace_back(row.type, row.value, row.confidence);
  return list;
}

std::optional<mapping::PinholeCamera> camera_of(const Scene& scene) {
  if (!scene.row.camera) return std::nullopt;
  return pinhole_of(*scene.row.camera);
}

std::optional<std::pair<py::array, py::array>> cloud_arrays(const Observation& observation) {
  const std::optional<mapping::Scan> scan = observation.cloud();
  if (!scan) return std::nullopt;
  std::vector<Eigen::Vector3f> points;
  py::array_t<uint8_t> colors({static_cast<py::ssize_t>(scan->points.size()), py::ssize_t{3}});
  uint8_t* color = colors.mutable_data();
  for (const mapping::ScanPoint& point : scan->points) {
    points.emplace_back((scan->map_from_scan * point.position.cast<double>()).cast<float>());
    for (const uint8_t channel : {point.r, point.g, point.b}) *color++ = channel;
  }
  return std::pair(array_of(points), py::array(colors));
}

void add_observation(py::module_& module) {
  py::class_<Observation>(module, "Observation", "An object as one scene saw it.")
      .def_property_readonly(
          "id", [](const Observation& o) { return o.row.id; }, "Row in the memory.")
      .def_property_readonly(
          "number", [](const Observation& o) { return o.row.number; }, "Within the scene, from 0.")
      .def_property_readonly(
          "object",
          [](const Observation& o) {
            return o.object ? std::optional(memory::object_name(*o.object)) : std::nullopt;
          },
          "The object that it is believed to be, as 'object_3'; None for clutter.")
      .def_property_readonly(
          "place", [](const Observation& o) { return place_name(*o.memory, o.row.place); },
          "Name of the place it is at, or None.")
      .def_property_readonly(
          "position", [](const Observation& o) { return array_or_none(o.row.position); },
          "Centre in the map frame, m, or None.")
      .def_property_readonly(
          "size", [](const Observation& o) { return array_or_none(o.row.size); },
          "Of its box along the axes of the box, m, or None.")
      .def_property_readonly(
          "map_from_box", [](const Observation& o) { return array_or_none(o.row.map_from_box); },
          "Pose of its box, 4 x 4, or None.")
      .def_property_readonly(
          "color", [](const Observation& o) { return o.row.color; }, "Name of its colour, or None.")
      .def_property_readonly(
          "hsv",
          [](const Observation& o) {
            return o.row.hsv
                       ? std::optional(std::tuple(o.row.hsv->hue, o.row.hsv->saturation, o.row.hsv->value))
                       : std::nullopt;
          },
          "Hue 0 to 360, saturation and value 0 to 1, or None.")
      .def("annotations", annotations_of, "What annotators reported: (type, value, confidence or None).")
      .def(
          "crop", [](const Observation& o) { return rgb_array_of(o.crop()); },
          "Its image, rows x columns x 3, RGB; None when none is stored.")
      .def(
          "mask", [](const Observation& o) { return array_of(o.mask()); },
          "Its pixels in the depth image: uint8 of the depth camera's size, 255 = its own; or None.")
      .def("cloud", cloud_arrays,
           "Its points in the map frame (N x 3, float32, m) and their colours (N x 3, RGB, 8 bit); None when "
           "depth "
           "or mask are not stored.")
      .def("__repr__", [](const Observation& o) {
        return "<loci.Observation " + std::to_string(o.row.number) + " of scene " +
               std::to_string(o.scene.id) + ">";
      });
}

void add_scene(py::module_& module) {
  py::class_<Scene>(module, "Scene", "What the memory stores of one processed frame.")
      .def_property_readonly(
          "id", [](const Scene& scene) { return scene.row.id; }, "Number of the scene.")
      .def_property_readonly(
          "time", [](const Scene& scene) { return datetime_of(scene.row.time); }, "datetime, UTC.")
      .def_property_readonly(
          "time_ns", [](const Scene& scene) { return scene.row.time; }, "Nanoseconds since 1970, UTC.")
      .def_property_readonly(
          "frame", [](const Scene& scene) { return scene.row.frame_index; },
          "Index of the frame in its recording, or None.")
      .def_property_readonly("camera", camera_of, "The depth camera, or None.")
      .def_property_readonly(
          "map_from_camera", [](const Scene& scene) { return array_or_none(scene.row.map_from_camera); },
          "Pose of the depth camera, 4 x 4, or None.")
      .def_property_readonly(
          "joints", [](const Scene& scene) { return scene.row.joints; },
          "Positions of joints by name, m or rad.")
      .def(
          "image", [](const Scene& scene) { return rgb_array_of(scene.image()); },
          "The colour image, rows x columns x 3, RGB, 8 bit; None when none is stored.")
      .def(
          "depth", [](const Scene& scene) { return array_of(scene.depth()); },
          "The depth thumbnail, rows x columns, float32, m, NaN = no measurement; None when none is stored.")
      .def(
          "labels", [](const Scene& scene) { return array_of(scene.labels()); },
          "Whose pixels they are, uint16 of the depth camera's size: the number of the object, 0 = none. "
          "None "
          "when nothing has a mask.")
      .def("observations", observations_of, "The observations of the scene, in order.")
      .def("__repr__", [](const Scene& scene) {
        return "<loci.Scene " + std::to_string(scene.row.id) + " " + format_time(scene.row.time) + ">";
      });
}

/// Adds detections of a file to a memory that is not open; messages call the file `called`, unless empty.
std::string ingest_file(const std::filesystem::path& file, const std::string& called,
                        const std::filesystem::path& path, const std::filesystem::path& map,
                        const std::filesystem::path& recording, const ProgressCallable& progress,
                        const TimeArgument& now, const py::kwargs& keywords) {
  memory::IngestOptions options;
  read_keywords(options, keywords, "loci.ingest");
  options.map = map;
  options.recording = recording;
  options.called = called;
  options.program = "loci.ingest";
  options.default_time_zone = user_time_zone(std::getenv("TZ")).name();
  const memory::WriteOptions write{.now = time_or_none(now)};
  Warnings warnings;
  const memory::IngestResult result =
      run_stage(progress, [&](Progress& p) { return ingest(file, path, options, write, p, warnings); });
  raise_warnings(warnings);
  return dumped(result.report());
}

std::string teach(OpenMemory& memory, const std::string& object, const std::string& class_name) {
  return memory.with_store(
      [&](memory::Store& store) { return dumped(memory::teach(store, object, class_name).report()); });
}

std::string edit(OpenMemory& memory, const std::string& name,
                 const std::map<std::string, std::string>& arguments) {
  return memory.with_store([&](memory::Store& store) {
    if (!store.writable()) throw store.error("the memory is open for reading", "loci.open(file, write=True)");
    return dumped(result_json(make_edit(store, memory::Query{name, arguments})));
  });
}

}  // namespace

void add_memory(py::module_& module) {
  py::class_<mapping::PinholeCamera>(module, "Camera", "A pinhole: pixel centres at integers, z forward.")
      .def(py::init<int, int, double, double, double, double>(), py::arg("width"), py::arg("height"),
           py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"))
      .def_readwrite("width", &mapping::PinholeCamera::width, "Pixels.")
      .def_readwrite("height", &mapping::PinholeCamera::height, "Pixels.")
      .def_readwrite("fx", &mapping::PinholeCamera::fx, "Focal length, pixels.")
      .def_readwrite("fy", &mapping::PinholeCamera::fy, "Focal length, pixels.")
      .def_readwrite("cx", &mapping::PinholeCamera::cx, "Principal point, pixels.")
      .def_readwrite("cy", &mapping::PinholeCamera::cy, "Principal point, pixels.");
  add_observation(module);
  add_scene(module);

  module.def("_questions", [] {
    Json json = memory::questions_json();
    json["sentence"] = memory::sentence_schema().name();
    json["$defs"].update(memory::sentence_schema().definitions());
    return dumped(json);
  });
  module.def("_edits", [] {
    Json json = Json::array();
    for (const memory::EditAction& action : memory::edit_actions())
      json.push_back(memory::declaration_json(action.name, action.description, action.parameters));
    return dumped(json);
  });
  module.def("_ingest", ingest_file, py::arg("detections"), py::arg("called"), py::arg("memory"),
             py::arg("map"), py::arg("recording"), py::arg("progress"), py::arg("now"));
  module.def("_replica", [](const std::string& url, const std::filesystem::path& cache) {
    return unlocked([&] {
      NoProgress silent;
      return memory::FleetReplica(url, cache).update(silent, memory::kFreshReplica_s);
    });
  });
  py::class_<OpenMemory, MemoryPtr>(module, "Memory", "A memory that is open: a file *.loci.")
      .def(
          py::init([](const std::filesystem::path& path, bool write, const TimeArgument& now) {
            const memory::WriteOptions options{.now = time_or_none(now)};
            return unlocked([&] { return std::make_shared<OpenMemory>(path, write, options); });
          }),
          py::arg("path"), py::arg("write") = false, py::kw_only(), py::arg("now") = py::none(),
          "Opens a file. Nobody writes to it unless `write` is set; then it is made where it is missing, and "
          "other writers are kept out until it is closed. `now` is the transaction time of what is written.")
      .def_property_readonly("path", &OpenMemory::path, "The file.")
      .def("close", &OpenMemory::close, "Closes the file; a second time is the same as once.")
      .def("__enter__", [](const MemoryPtr& memory) { return memory; })
      .def("__exit__", [](OpenMemory& memory, const py::args&) { memory.close(); })
      .def("_answer", answer_query)
      .def("_answer_sentences", answer_sentences)
      .def("_teach", teach)
      .def("_edit", edit)
      .def("_edits",
           [](OpenMemory& memory) {
             return memory.with_store(
                 [](const memory::Store& store) { return dumped(to_json(memory::edits(store))); });
           })
      .def("table", table, py::arg("name"),
           "All rows of a public view (objects, observations, events, scenes, place_visibility, log, facts) "
           "as "
           "columns: {name: list}, as pandas.DataFrame() takes it.")
      .def(
          "iter_scenes",
          [](const MemoryPtr& memory, const TimeArgument& from, const TimeArgument& to) {
            return SceneIterator(py::iter(py::cast(scenes_of(memory, time_or_none(from), time_or_none(to)))));
          },
          py::arg("from_") = py::none(), py::arg("to") = py::none(),
          "The scenes between two times (datetime, ISO 8601 or nanoseconds), in order.")
      .def(
          "scene",
          [](const MemoryPtr& memory, Id id) {
            return Scene{memory,
                         memory->with_store([&](const memory::Store& store) { return store.scene(id); })};
          },
          py::arg("id"), "The scene of this number.")
      .def("__repr__",
           [](const OpenMemory& memory) { return "<loci.Memory '" + memory.path().string() + "'>"; });
}

}  // namespace loci::python

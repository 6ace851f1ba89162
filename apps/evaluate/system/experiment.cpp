#include "apps/evaluate/system/experiment.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <sstream>
#include <string>

#include "apps/evaluate/system/household.h"
#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/base/text/base64.h"
#include "mapping/base/text/html.h"
#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "mapping/simulation/record.h"
#include "memory/annotators/memory_annotators.h"
#include "memory/annotators/memory_session.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/scene_data.h"
#include "perception/cas/graph.h"
#include "perception/conversions/opencv.h"
#include "perception/types/scene_cas.h"

namespace loci::apps::system_evaluation {
namespace {

constexpr size_t kMaxNumbers = 8;  ///< of an array that are shown

std::string numbers_of(const perception::cas::FeatureStructure& array) {
  std::vector<std::string> shown;
  const auto add = [&](const auto& values, const char* format) {
    for (size_t i = 0; i < std::min(kMaxNumbers, values.size()); ++i)
      shown.push_back(fmt::format(fmt::runtime(format), values[i]));
  };
  switch (array.type().component_kind()) {
    case perception::cas::Kind::kString:
      add(array.elements<std::string>(), "{}");
      break;
    case perception::cas::Kind::kFloat:
      add(array.elements<float>(), "{:.3g}");
      break;
    case perception::cas::Kind::kDouble:
      add(array.elements<double>(), "{:.3g}");
      break;
    default:
      return fmt::format("{} elements", array.array_size());
  }
  return fmt::format("{}{}", fmt::join(shown, ", "), array.array_size() > kMaxNumbers ? ", …" : "");
}

/// A line per value; structures below are gone into, `deep` levels.
void add_lines(const perception::cas::FeatureStructure& structure, const std::string& indent, int deep,
               std::vector<std::string>& lines) {
  for (const perception::cas::Feature& feature : structure.type().features()) {
    if (!structure.is_set(feature)) continue;
    const perception::cas::Value& value = structure.value(feature);
    const std::string name = indent + feature.name() + ": ";
    if (const auto* text = std::get_if<std::string>(&value)) {
      lines.push_back(name + *text);
    } else if (const auto* number = std::get_if<double>(&value)) {
      lines.push_back(fmt::format("{}{:.4g}", name, *number));
    } else if (const auto* integer = std::get_if<int64_t>(&value)) {
      lines.push_back(fmt::format("{}{}", name, *integer));
    } else if (const auto* flag = std::get_if<bool>(&value)) {
      lines.push_back(fmt::format("{}{}", name, *flag));
    } else if (const auto below = structure.get<perception::cas::FeatureStructure>(feature); below) {
      if (below.type().kind() == perception::cas::Kind::kArray &&
          below.type().component_kind() != perception::cas::Kind::kStructure) {
        lines.push_back(name + numbers_of(below));
      } else if (deep > 0 && below.type().kind() == perception::cas::Kind::kStructure) {
        lines.push_back(name + below.type().short_name());
        add_lines(below, indent + "  ", deep - 1, lines);
      }
    }
  }
}

/// How much there is to tell of an object: its annotations, and each word, code and product once more.
size_t richness(const perception::types::Cluster& cluster) {
  size_t sum = 0;
  for (const perception::types::Annotation& annotation : cluster.annotations) {
    const perception::cas::FeatureStructure& structure = annotation;
    const bool telling = perception::types::is<perception::types::TextAnnotation>(structure) ||
                         perception::types::is<perception::types::BarcodeAnnotation>(structure) ||
                         perception::types::is<perception::types::ProductAnnotation>(structure);
    sum += telling ? 2 : 1;
  }
  return sum;
}

/// Figure 8.1: the object's image, and beside it each annotation with its values, as SVG.
std::string object_svg(const perception::types::Cluster& cluster) {
  constexpr int kLine = 15, kImage = 220, kLeft = 250;
  std::string text;
  int y = 20;
  for (const perception::types::Annotation& annotation : cluster.annotations) {
    const perception::cas::FeatureStructure& structure = annotation;
    text += fmt::format("<text x='{}' y='{}' font-weight='bold'>{}</text>\n", kLeft, y,
                        html_escape(structure.type().short_name()));
    y += kLine;
    std::vector<std::string> lines;
    add_lines(structure, "", 2, lines);
    for (const std::string& line : lines) {
      text += fmt::format("<text x='{}' y='{}' xml:space='preserve'>{}</text>\n", kLeft + 14, y,
                          html_escape(line));
      y += kLine;
    }
    y += kLine / 2;
  }
  std::string image;
  if (const auto roi = cluster.hypotheses.first<perception::types::StandaloneImageROI>()) {
    const std::vector<unsigned char> png =
        mapping::encode_image(perception::types::from<cv::Mat>(roi.image.get()), ".png");
    image = fmt::format(
        "<image x='15' y='15' width='{0}' height='{0}' preserveAspectRatio='xMidYMin' "
        "href='data:image/png;base64,{1}'/>\n",
        kImage, base64_from_bytes(png));
  }
  return fmt::format(
             "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}' viewBox='0 0 {0} {1}' "
             "font-family='sans-serif' font-size='11'>\n<rect width='100%' height='100%' fill='white'/>\n",
             820, std::max(y, kImage + 30)) +
         image + text + "</svg>\n";
}

constexpr double kMargin = 0.01;  ///< metres, for the noise of the sensor
constexpr double kMinOverlap = 0.5;
constexpr int kVisiblePixels = 150;  ///< fewer are not asked for
constexpr double kVisibleShare = 0.3;

/// An object as it stands in a scene.
struct TrueObject {
  const HouseholdObject* true_object = nullptr;
  Isometry3d object_from_map = Isometry3d::Identity();
  Eigen::AlignedBox3d box;  ///< in its own frame
  double pixels = 0;
  bool visible = false;
};

using Truth = std::map<int64_t, std::vector<TrueObject>>;

Truth read_truth(const std::filesystem::path& file, const std::vector<HouseholdObject>& true_objects) {
  std::map<std::string, std::pair<const HouseholdObject*, Eigen::AlignedBox3d>> by_name;
  for (const HouseholdObject& true_object : true_objects) {
    const mapping::ObjectModel model = build_object(true_object.spec);
    by_name[true_object.spec.name] = {&true_object, {model.low, model.high}};
  }
  Truth truth;
  std::istringstream lines(read_file(file));
  for (std::string line; std::getline(lines, line);) {
    const Json frame = Json::parse(line);
    std::vector<TrueObject>& there = truth[frame.at("frame").get<int64_t>()];
    for (const Json& object : frame.at("objects")) {
      const auto& [true_object, box] = by_name.at(object.at("id").get<std::string>());
      const double pixels = object.at("pixels").get<double>();
      const Json& share = object.at("visible");
      there.push_back(
          {true_object, pose_from_values(object.at("pose").get<std::array<double, 7>>()).inverse(), box,
           pixels, pixels >= kVisiblePixels && !share.is_null() && share.get<double>() >= kVisibleShare});
    }
  }
  return truth;
}

perception::Pipeline system_pipeline(const SystemOptions& options,
                                     const perception::AnnotatorRegistry& registry) {
  std::string flow =
      "flow: [NormalEstimator, KnownStructureFilter, PlaneClusterExtractor, FlatObjectExtractor, "
      "PlaceNaming, "
      "ColorHistogram, ColorName, GeometryAnnotator, LocationAnnotator";
  if (options.words) flow += ", BarcodeReader, TextReader";
  perception::Pipeline pipeline =
      options.pipeline.empty()
          ? perception::Pipeline::parse(flow + "]\n", "the pipeline of the evaluation", registry)
          : perception::Pipeline::parse(Config::read(options.pipeline), registry);
  pipeline.add("IdentityResolution", registry);
  pipeline.add_writer("MemoryWriter", registry);
  return pipeline;
}

/// Looks at the scenes as they come out of the pipeline.
class Tally {
 public:
  Tally(const Truth& truth, SystemResult& result) : truth_(truth), result_(result) {}

  void add(perception::cas::Cas& cas) {
    const perception::types::SceneCas scene(cas);
    const std::vector<perception::types::Cluster> clusters = scene.clusters();
    compare(scene, clusters);
    count_sizes(clusters);
    count_types(scene);
    for (const perception::types::Cluster& cluster : clusters) {
      count_results(cluster);
      if (const size_t rich = richness(cluster); rich > richest_) {
        richest_ = rich;
        result_.figure = object_svg(cluster);
      }
    }
  }

  void finish() {
    const auto list = [](const std::map<std::string, size_t>& counts) {
      std::vector<TypeCount> types;
      for (const auto& [type, count] : counts) types.push_back({type, count});
      std::stable_sort(types.begin(), types.end(),
                       [](const TypeCount& a, const TypeCount& b) { return a.count > b.count; });
      return types;
    };
    result_.scene_types = list(on_scenes_);
    result_.cluster_types = list(on_clusters_);
    result_.kept_types = list(all_);
  }

 private:
  void compare(const perception::types::SceneCas& scene,
               const std::vector<perception::types::Cluster>& clusters) {
    const std::vector<TrueObject>& true_objects = truth_.at(scene.scene().frame_index.get());
    std::vector<bool> found(true_objects.size(), false);
    for (const perception::types::Cluster& cluster : clusters) {
      const std::vector<Vector3d> points = perception::cluster_points(scene, cluster);
      std::vector<double> inside(true_objects.size(), 0);
      for (const Vector3d& point : points)
        for (size_t i = 0; i < true_objects.size(); ++i)
          inside[i] += true_objects[i].box.exteriorDistance(
                           Vector3d(true_objects[i].object_from_map * point)) <= kMargin;
      const auto best =
          static_cast<size_t>(std::distance(inside.begin(), std::max_element(inside.begin(), inside.end())));
      if (true_objects.empty() || inside[best] < 0.5 * static_cast<double>(points.size())) {
        ++result_.false_clusters;
        continue;
      }
      const TrueObject& true_object = true_objects[best];
      if (!true_object.visible) continue;  // Whether it is found does not count.
      ++result_.kinds[true_object.true_object->kind].clusters;
      const double common = std::min(inside[best], true_object.pixels);
      const double both = static_cast<double>(points.size()) + true_object.pixels - common;
      if (common >= kMinOverlap * both) found[best] = true;
    }
    for (size_t i = 0; i < true_objects.size(); ++i) {
      KindScore& kind = result_.kinds[true_objects[i].true_object->kind];
      kind.flat = true_objects[i].true_object->flat;
      kind.there += true_objects[i].visible ? 1 : 0;
      kind.found += found[i] ? 1 : 0;
    }
  }

  void count_sizes(const std::vector<perception::types::Cluster>& clusters) {
    int flat = 0;
    for (const perception::types::Cluster& cluster : clusters) {
      result_.points.push_back(perception::cluster_indices(cluster).size());
      const auto points = cluster.hypotheses.first<perception::types::ReferenceClusterPoints>();
      flat += points && points.source.get() == "FlatObjectExtractor" ? 1 : 0;
    }
    result_.clusters += clusters.size();
    const int all = static_cast<int>(clusters.size());
    ++result_.flat_found[flat];
    ++result_.solid_found[all - flat];
    ++result_.total_found[all];
  }

  void count_types(const perception::types::SceneCas& scene) {
    std::vector<perception::cas::FeatureStructure> roots;
    for (const std::string& name : scene.cas().view_names()) {
      if (name != "default") ++on_scenes_["view " + name];
      for (const perception::cas::FeatureStructure& each : scene.cas().find_view(name)->all())
        roots.push_back(each);
    }
    for (const perception::cas::FeatureStructure& each : perception::cas::reachable_from(roots))
      if (each.type().kind() == perception::cas::Kind::kStructure) ++all_[each.type().short_name()];
    ++on_scenes_["Scene"];
    for (const char* name : {"log", "similarities", "distances", "joint_state", "map_from_camera"})
      if (const auto below = scene.scene().structure().get<perception::cas::FeatureStructure>(name))
        ++on_scenes_[below.type().short_name()];
    for (const perception::types::Annotation& each : scene.scene().annotations)
      ++on_scenes_[each.structure().type().short_name()];
    for (const perception::types::Cluster& cluster : scene.clusters()) {
      ++on_clusters_["Cluster"];
      for (const perception::types::ObjectHypothesis& each : cluster.hypotheses)
        ++on_clusters_[each.structure().type().short_name()];
      for (const perception::types::Annotation& each : cluster.annotations)
        ++on_clusters_[each.structure().type().short_name()];
    }
  }

  void count_results(const perception::types::Cluster& cluster) {
    for (const perception::types::Annotation& annotation : cluster.annotations) {
      if (const auto text = perception::types::try_as<perception::types::TextAnnotation>(annotation))
        ++result_.results[{"Text", text->text.get()}];
      else if (const auto code = perception::types::try_as<perception::types::BarcodeAnnotation>(annotation))
        ++result_.results[{"Barcode", code->code.get()}];
      else if (const auto product =
                   perception::types::try_as<perception::types::ProductAnnotation>(annotation))
        ++result_.results[{"Product", product->name.get()}];
    }
  }

  const Truth& truth_;
  SystemResult& result_;
  std::map<std::string, size_t> on_scenes_, on_clusters_, all_;
  size_t richest_ = 0;
};

void count_set_up(const std::vector<SceneCount>& counts, SystemResult& result) {
  for (const SceneCount& count : counts) {
    ++result.flat_set[count.flat];
    ++result.solid_set[count.solid];
    ++result.total_set[count.flat + count.solid];
  }
  result.scenes = counts.size();
}

}  // namespace

void SystemOptions::declare(OptionTable& table) {
  table.integer("scenes", scenes, "", "Scenes that are set up.", 1, 100000);
  table.integer("seed", seed, "", "Seed of everything that is drawn.", 0, 1 << 30);
  table.integer("frames", frames, "", "Frames of which the throughput is measured; 0 = one per scene.", 0,
                1000000);
  table.flag("words", words, "Reads barcodes and printed words.");
}

KindScore SystemResult::sum(bool flat, bool solid) const {
  KindScore sum;
  for (const auto& [name, kind] : kinds) {
    if (kind.flat ? !flat : !solid) continue;
    sum.there += kind.there;
    sum.found += kind.found;
    sum.clusters += kind.clusters;
  }
  return sum;
}

SystemResult run_system(const SystemOptions& options, const std::filesystem::path& folder, Progress& progress,
                        Warnings& warnings) {
  SystemResult result;
  const Random random(static_cast<uint64_t>(options.seed));
  const std::vector<HouseholdObject> true_objects = household(options.map.parent_path() / "labels");
  result.true_objects = true_objects.size();
  const auto map = perception::KnownMap::load(options.map, {}, warnings);
  const std::vector<SceneCount> counts = scene_counts(options.scenes, random.fork(0));
  count_set_up(counts, result);
  PartialProgress simulating(progress, 0, 0.4), perceiving(progress, 0.4, 0.8), measuring(progress, 0.8, 1);
  mapping::RecordOptions recording;
  recording.seed = options.seed;
  recording.threads = options.threads;
  record(household_scenario(*map, true_objects, counts, random.fork(1)), folder / "recording", recording,
         simulating, warnings);

  const Truth truth = read_truth(folder / "recording" / "truth.jsonl", true_objects);
  const std::shared_ptr<mapping::Recording> opened = mapping::open_recording(folder / "recording");
  perception::AnnotatorRegistry registry;
  add_annotators(registry);
  memory::add_memory_annotators(registry);
  perception::Pipeline pipeline = system_pipeline(options, registry);
  perception::Resources resources;
  resources.put(opened);
  resources.put(map);
  resources.put(std::make_shared<mapping::World>(map->world));
  memory::MemorySessionOptions memory;
  memory.memory = folder / "memory.loci";
  memory.program = "loci-evaluate system";
  memory.configuration = pipeline.to_json();
  memory.map = options.map;
  std::filesystem::remove(memory.memory);
  resources.put(std::make_shared<memory::MemorySession>(memory, *opened));
  perception::Context context{resources, warnings, options.threads, {}};
  Tally tally(truth, result);
  result.steps =
      step_times(memory::run_with_memory(pipeline, context, perception::types::type_system(), perceiving,
                                         [&](perception::cas::Cas& cas) { tally.add(cas); })
                     .pipeline);
  tally.finish();
  result.objects = resources.get<memory::MemorySession>("memory").store().objects().size();
  result.throughput = measure_throughput(
      opened, map, static_cast<size_t>(options.frames > 0 ? options.frames : options.scenes), options.threads,
      measuring);
  return result;
}

}  // namespace loci::apps::system_evaluation

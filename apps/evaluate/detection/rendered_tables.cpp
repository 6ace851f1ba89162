#include "apps/evaluate/detection/rendered_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "mapping/base/files.h"
#include "mapping/base/parallel.h"
#include "mapping/base/text/text.h"
#include "mapping/image/image_io.h"
#include "mapping/simulation/household.h"
#include "mapping/simulation/household_scenes.h"
#include "perception/classification/household_model.h"

namespace loci::apps::detection_evaluation {
namespace {

constexpr const char* kOther = "other";
constexpr int kMinPixels = 150;  ///< of what is seen of an object

}  // namespace

const std::vector<std::string>& rendered_classes() {
  static const std::vector<std::string> classes = [] {
    std::vector<std::string> names = {kOther};
    for (const std::string& name : mapping::household_classes())
      names.push_back(perception::household_group(name));
    std::ranges::sort(names);
    names.erase(std::unique(names.begin(), names.end()), names.end());
    return names;
  }();
  return classes;
}

RenderedTable RenderedTables::table(int scene) const {
  const mapping::HouseholdScenes scenes(static_cast<size_t>(scenes_), random_);
  RenderedTable table{scenes.frame(static_cast<size_t>(scene)).color, {}};
  struct Seen {
    int pixels = 0;
    cv::Rect box;
  };
  std::map<int, Seen> seen;
  const cv::Mat& labels = scenes.labels();
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u)
      if (const int label = labels.at<uint16_t>(v, u); label > 1) {
        Seen& object = seen[label];
        object.box = object.pixels++ == 0 ? cv::Rect(u, v, 1, 1) : object.box | cv::Rect(u, v, 1, 1);
      }
  for (const auto& [label, object] : seen)
    if (object.pixels >= kMinPixels)
      table.objects.push_back({perception::household_group(scenes.class_of(label)), object.box});
  return table;
}

void write_training_images(const RenderedTables& tables, const std::filesystem::path& folder, int threads,
                           Progress& progress) {
  make_folder(folder / "images");
  make_folder(folder / "labels");
  const std::vector<std::string>& classes = rendered_classes();
  write_file_atomically(
      folder / "data.yaml",
      fmt::format("path: .\ntrain: images\nval: images\nnames: [{}]\n", joined(classes, ", ")));
  constexpr int kBlock = 32;
  for (int first = 0; first < tables.size(); first += kBlock) {
    progress.check(static_cast<double>(first) / tables.size(), "tables");
    parallel_for(static_cast<size_t>(std::min(kBlock, tables.size() - first)), threads,
                 [&](size_t begin, size_t end) {
                   for (size_t i = begin; i < end; ++i) {
                     const int scene = first + static_cast<int>(i);
                     const RenderedTable table = tables.table(scene);
                     std::string lines;
                     for (const TrueObject& object : table.objects) {
                       const double width = table.color.cols, height = table.color.rows;
                       lines += fmt::format("{} {:.5f} {:.5f} {:.5f} {:.5f}\n",
                                            std::ranges::lower_bound(classes, object.name) - classes.begin(),
                                            (object.box.x + object.box.width / 2.0) / width,
                                            (object.box.y + object.box.height / 2.0) / height,
                                            object.box.width / width, object.box.height / height);
                     }
                     const std::string name = fmt::format("{:06}", scene);
                     mapping::write_image(folder / "images" / (name + ".jpg"), table.color);
                     write_file_atomically(folder / "labels" / (name + ".txt"), lines);
                   }
                 });
  }
}

}  // namespace loci::apps::detection_evaluation

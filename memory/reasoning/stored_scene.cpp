#include "memory/reasoning/stored_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "mapping/image/image_io.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

/// How many pixels of the camera one of its thumbnail stands for.
int step_of(const SceneRow& row) {
  return std::max(1, row.camera->width / std::max(1, row.depth_width));
}

void read_view(const Store& store, const SceneRow& row, belief::SceneView& view) {
  if (row.map_from_camera) view.map_from_camera = *row.map_from_camera;
  if (!row.camera) return;
  view.camera = pinhole_of(*row.camera);
  if (!row.depth) return;
  const int step = step_of(row);
  const int first = step / 2;  // the pixel that stands for the first block
  view.camera = {row.depth_width,
                 row.depth_height,
                 row.camera->fx / step,
                 row.camera->fy / step,
                 (row.camera->cx - first) / step,
                 (row.camera->cy - first) / step};
  view.sensor_pixels = step * step;
  const std::vector<float> depth = depth_thumbnail(store, row);
  view.depth = cv::Mat(row.depth_height, row.depth_width, CV_32F);
  view.labels = cv::Mat(row.depth_height, row.depth_width, CV_32S, cv::Scalar(-1));
  for (int v = 0; v < row.depth_height; ++v)
    for (int u = 0; u < row.depth_width; ++u) {
      const float z =
          depth[static_cast<size_t>(v) * static_cast<size_t>(row.depth_width) + static_cast<size_t>(u)];
      view.depth.at<float>(v, u) = z > 0 ? z : std::numeric_limits<float>::quiet_NaN();
    }
}

/// Marks the thumbnail's pixels that a mask of the whole image covers.
void draw_label(const Store& store, const ObservationRow& row, int step, int label, cv::Mat& labels) {
  if (!row.roi || !row.mask || labels.empty()) return;
  const std::string bytes = store.blob(*row.mask).bytes;
  const cv::Mat mask = mapping::decode_image({bytes.begin(), bytes.end()}, "mask");
  if (mask.type() != CV_8U) throw Error(fmt::format("the mask of observation {} is no mask", row.id));
  const auto [x, y, width, height] = *row.roi;
  for (int v = 0; v < labels.rows; ++v)
    for (int u = 0; u < labels.cols; ++u) {
      const int mask_u = u * step + step / 2 - x, mask_v = v * step + step / 2 - y;
      if (mask_u < 0 || mask_v < 0 || mask_u >= mask.cols || mask_v >= mask.rows) continue;
      if (mask.at<uint8_t>(mask_v, mask_u) != 0) labels.at<int>(v, u) = label;
    }
}

}  // namespace

SceneRecord stored_scene(const Store& store, const SceneRow& row, const SceneReasoning& reasoning,
                         const std::vector<PlaceRow>& places) {
  SceneRecord record;
  record.row = row;
  record.view = reasoning.evidence.view;
  read_view(store, row, record.view);
  record.seconds_to_next = reasoning.evidence.seconds_to_next;
  record.place_poses = reasoning.evidence.places;
  record.places = places;
  const std::vector<ObservationRow> observations = store.observations(row.id);
  if (reasoning.evidence.observations.size() < observations.size())
    throw store.error(fmt::format("the evidence of scene {} is of other observations", row.id),
                      "loci-memory verify lists what is damaged");
  for (const ObservationRow& observation : observations) {
    const size_t number = record.observations.size();
    ObservationRecord& copy = record.observations.emplace_back();
    copy.evidence = reasoning.evidence.observations[number];
    copy.row = observation;
    if (row.camera && row.depth)
      draw_label(store, observation, step_of(row), static_cast<int>(number), record.view.labels);
  }
  return record;
}

}  // namespace loci::memory

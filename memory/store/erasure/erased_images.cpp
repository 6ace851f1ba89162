#include "memory/store/erasure/erased_images.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "mapping/image/image_io.h"
#include "memory/store/rows/row_columns.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

/// Sides of a region in fractions of the depth image, and the distances of what it shows.
struct Region {
  double left = 0, top = 0, right = 1, bottom = 1;
  double near_m = 0.3, far_m = 8;
  bool observed = false;  ///< the object is visible there

  bool overlaps(const Region& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

/// An observation that is erased: where it was, and the box that the object filled.
struct ErasedObservation {
  ObservationRow row;
  TimeNs time = 0;
  Id object = 0;
  bool at_border = false;      ///< of the depth image, which may show a part of it only
  Vector3d whole = {0, 0, 0};  ///< size of the object where images showed all of it

  bool has_box() const { return row.position || row.map_from_box; }
  /// The box with a margin, in its own frame and from there to the map.
  Isometry3d map_from_box() const {
    return row.map_from_box ? *row.map_from_box : Isometry3d(Eigen::Translation3d(*row.position));
  }
  Vector3d half_size() const {
    constexpr double kUnknown_m = 0.3, kMargin_m = 0.02;
    return (row.size.value_or(Vector3d::Constant(kUnknown_m)) / 2).array() + kMargin_m;
  }
  /// The same for all that may be seen of it: the box has its visible side, its other sides may be as wide,
  /// and beyond the border of an image all of it may lie.
  Vector3d half_extent() const {
    Vector3d half = half_size();
    half.x() = half.y() = std::max(half.x(), half.y());
    return at_border ? half.cwiseMax(whole) : half;
  }
};

/// Of one object at one spot, in order of time, until it was seen elsewhere.
using Track = std::vector<ErasedObservation>;

/// The middle of what is seen of a large object depends on the side from which it is seen.
bool is_same_spot(const ErasedObservation& a, const ErasedObservation& b) {
  constexpr double kSame_m = 0.05;
  if (!a.has_box() || !b.has_box()) return a.has_box() == b.has_box();
  const double half_side = std::max(a.half_size().maxCoeff(), b.half_size().maxCoeff());
  return (a.map_from_box().translation() - b.map_from_box().translation()).norm() <
         std::max(kSame_m, half_side);
}

/// Sizes of objects, by the observations that are all in their images.
void complete_sizes(std::vector<Track>& tracks) {
  std::map<Id, Vector3d> whole;
  for (const Track& track : tracks)
    for (const ErasedObservation& one : track)
      if (one.row.size && !one.at_border) {
        const auto known = whole.try_emplace(one.object, *one.row.size).first;
        known->second = known->second.cwiseMax(*one.row.size);
      }
  for (Track& track : tracks)
    for (ErasedObservation& one : track)
      if (const auto known = whole.find(one.object); known != whole.end()) one.whole = known->second;
}

bool touches_border(const ObservationRow& row, const SqlRow& scene) {
  const auto width = scene.get<std::optional<int64_t>>("camera_width"),
             height = scene.get<std::optional<int64_t>>("camera_height");
  if (!row.roi || !width || !height) return false;
  constexpr int kNear_px = 2;
  const auto& [x, y, columns, rows] = *row.roi;
  return x <= kNear_px || y <= kNear_px || x + columns >= *width - kNear_px || y + rows >= *height - kNear_px;
}

/// An object may be left standing at each spot where it was observed; once it is seen elsewhere it is there.
std::vector<Track> read_tracks(Store::Connection& db) {
  std::vector<Track> tracks;
  db.query(
      "SELECT o.*, s.time AS scene_time, s.camera_width, s.camera_height, coalesce((SELECT a.object FROM "
      "association_known a WHERE "
      "a.observation = o.id AND a.known_to IS NULL AND a.chosen = 1 AND a.probability > 0), 0) AS object "
      "FROM "
      "temp.gone_observation g JOIN observation o ON o.id = g.id JOIN scene s ON s.id = o.scene ORDER BY "
      "s.time, o.id",
      {}, [&](const SqlRow& row) {
        ErasedObservation one{read_row<ObservationRow>(row), row.get<TimeNs>("scene_time"),
                              row.get<Id>("object")};
        one.at_border = touches_border(one.row, row);
        const auto track = std::find_if(tracks.rbegin(), tracks.rend(), [&](const Track& known) {
          return known.front().object == one.object;
        });
        const bool stayed = track != tracks.rend() && is_same_spot(track->back(), one);
        (stayed ? *track : tracks.emplace_back()).push_back(one);
      });
  complete_sizes(tracks);
  return tracks;
}

/// What a scene shows within a box.
enum class Content { out_of_view, hidden, partly_hidden, empty, occupied, not_measured };

/// A scene with its depth, and the pixels that belong to what remains.
class SceneView {
 public:
  SceneView(const Store& store, Store::Connection& db, const SceneRow& scene) : store_(store), scene_(scene) {
    if (scene.depth && scene.depth_width > 0 && scene.depth_height > 0) {
      const std::vector<float> depth = decode_depth_thumbnail(store.blob(*scene.depth).bytes);
      const auto pixels = static_cast<size_t>(scene.depth_width) * static_cast<size_t>(scene.depth_height);
      if (depth.size() == pixels) depth_ = depth;
    }
    others_ = select<ObservationRow>(
        db, Where("scene = ?1 AND id NOT IN (SELECT id FROM temp.gone_observation)", {sql(scene.id)}));
  }

  bool has_camera() const { return scene_.camera && scene_.map_from_camera; }
  const std::vector<ObservationRow>& others() const { return others_; }

  /// The region of the depth image and what lies beside it that a box covers; unset = behind the camera.
  std::optional<Region> region_of(const ErasedObservation& observed) const {
    const SceneCamera& camera = *scene_.camera;
    const Isometry3d camera_from_box = scene_.map_from_camera->inverse() * observed.map_from_box();
    Region region{1e9, 1e9, -1e9, -1e9, 1e9, -1e9};
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
      const Vector3d p = camera_from_box * sign.cwiseProduct(observed.half_extent());
      if (p.z() < 0.05) return std::nullopt;
      const double u = (camera.fx * p.x() / p.z() + camera.cx + 0.5) / camera.width,
                   v = (camera.fy * p.y() / p.z() + camera.cy + 0.5) / camera.height;
      region = {std::min(region.left, u),   std::min(region.top, v),        std::max(region.right, u),
                std::max(region.bottom, v), std::min(region.near_m, p.z()), std::max(region.far_m, p.z())};
    }
    return region;
  }

  /// The same region of the colour image, whose camera may sit beside the depth camera and show more.
  Region in_color(const Region& region) const {
    if (!scene_.camera) return region;
    const mapping::RgbdCamera cameras = cameras_of(store_, scene_);
    const Isometry3d color_from_depth = cameras.depth_from_color.inverse();
    Region seen{1e9, 1e9, -1e9, -1e9};
    for (const double u : {region.left, region.right})
      for (const double v : {region.top, region.bottom})
        for (const double z : {region.near_m, region.far_m}) {
          const Vector2d pixel = cameras.color.project(
              color_from_depth *
              cameras.depth.unproject(u * cameras.depth.width - 0.5, v * cameras.depth.height - 0.5, z));
          const double x = (pixel.x() + 0.5) / cameras.color.width,
                       y = (pixel.y() + 0.5) / cameras.color.height;
          seen = {std::min(seen.left, x), std::min(seen.top, y), std::max(seen.right, x),
                  std::max(seen.bottom, y)};
        }
    return seen;
  }

  Content content_of(const ErasedObservation& observed) const {
    const std::optional<Region> region = region_of(observed);
    if (!region) return Content::out_of_view;
    if (!region->overlaps({}))
      return scene_.image && in_color(*region).overlaps({}) ? Content::not_measured : Content::out_of_view;
    if (depth_.empty()) return Content::not_measured;
    const int width = scene_.depth_width, height = scene_.depth_height;
    const SceneCamera& camera = *scene_.camera;
    const Isometry3d box_from_camera = observed.map_from_box().inverse() * *scene_.map_from_camera;
    const Vector3d half = observed.half_size();
    const double nearest =
        (scene_.map_from_camera->inverse() * observed.map_from_box()).translation().z() - half.norm();
    int occupied = 0, before = 0, behind = 0, unmeasured = 0;
    for (int y = pixel(region->top, height); y <= pixel(region->bottom, height); ++y)
      for (int x = pixel(region->left, width); x <= pixel(region->right, width); ++x) {
        const double z = static_cast<double>(
            depth_[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)]);
        if (!(z > 0)) {
          ++unmeasured;
          continue;
        }
        const double u = (x + 0.5) / width, v = (y + 0.5) / height;
        const Vector3d p =
            box_from_camera * Vector3d((u * camera.width - 0.5 - camera.cx) / camera.fx * z,
                                       (v * camera.height - 0.5 - camera.cy) / camera.fy * z, z);
        if (is_inside(p, half) && !is_of_another(u, v))
          ++occupied;
        else if (z < nearest)
          ++before;
        else
          ++behind;
      }
    if (occupied > 0) return Content::occupied;
    if (behind > 0) return before > 0 ? Content::partly_hidden : Content::empty;
    return before > 0 ? Content::hidden : Content::not_measured;
  }

 private:
  static int pixel(double fraction, int size) {
    return static_cast<int>(std::clamp(std::floor(fraction * size), 0.0, size - 1.0));
  }

  /// Not the surface below: the margin at the bottom counts as outside, and a little more.
  static bool is_inside(const Vector3d& p, const Vector3d& half) {
    constexpr double kBottom_m = 0.035;
    const double bottom = std::min(kBottom_m, half.z());
    return std::abs(p.x()) <= half.x() && std::abs(p.y()) <= half.y() && p.z() <= half.z() &&
           p.z() >= -half.z() + bottom;
  }

  bool is_of_another(double u, double v) const {
    const double x = u * scene_.camera->width, y = v * scene_.camera->height;
    return std::ranges::any_of(others_, [&](const ObservationRow& other) {
      if (!other.roi) return false;
      const auto& [left, top, width, height] = *other.roi;
      return x >= left && y >= top && x < left + width && y < top + height;
    });
  }

  const Store& store_;
  const SceneRow& scene_;
  std::vector<float> depth_;
  std::vector<ObservationRow> others_;
};

/// What is cut out of a scene.
struct Cut {
  std::vector<Region> regions = {};
  std::vector<Region> color = {};  ///< of the colour image only
  bool everything = false;         ///< nobody knows where it is
  bool observed = true;  ///< only regions of observations, whose masks are apart from those of others
};

Region roi_region(const ObservationRow& row, const SceneCamera& camera) {
  const auto& [x, y, width, height] = *row.roi;
  return {double(x) / camera.width, double(y) / camera.height, double(x + width) / camera.width,
          double(y + height) / camera.height};
}

void cut_observed(const ErasedObservation& observed, const SceneRow& scene, const SceneView& view, Cut& cut) {
  const bool has_roi =
      observed.row.roi && scene.camera && scene.camera->width > 0 && scene.camera->height > 0;
  const auto region =
      view.has_camera() && observed.has_box() ? view.region_of(observed) : std::optional<Region>();
  if (has_roi) {
    Region seen = roi_region(observed.row, *scene.camera);
    seen.observed = true;
    if (region) seen.near_m = region->near_m, seen.far_m = region->far_m;
    cut.regions.push_back(seen);
    if (region) cut.color.push_back(*region);
  } else if (region) {
    cut.regions.push_back(*region);
  }
  if (!has_roi && !region) cut.everything = true;
}

/// Cuts out an object that a scene did not observe, if it shows it all the same; one that is `believed` to be
/// there also where it is behind something, of which a part of it may stand out. Returns what is at its spot.
Content cut_unobserved(const ErasedObservation& observed, bool believed, const SceneView& view, Cut& cut) {
  if (!view.has_camera() || !observed.has_box()) {
    cut.everything = true;
    return Content::not_measured;
  }
  const Content content = view.content_of(observed);
  if (content == Content::occupied || content == Content::not_measured) {
    cut.regions.push_back(*view.region_of(observed));
    cut.observed = false;
  } else if (believed && (content == Content::hidden || content == Content::partly_hidden)) {
    cut.regions.push_back(*view.region_of(observed));
  }
  return content;
}

/// The pixels of a region, a few more on each side, and whole blocks of a JPEG: nothing of it remains in
/// blocks that it shares with its surroundings.
cv::Rect pixels_of(const Region& region, const cv::Size& size) {
  constexpr double kMargin = 0.01;
  constexpr int kBlock = 16;
  const auto down = [](double value) { return int(std::floor(value / kBlock)) * kBlock; };
  const auto up = [](double value) { return int(std::ceil(value / kBlock)) * kBlock; };
  const cv::Rect all({0, 0}, size);
  const cv::Point first(down((region.left - kMargin) * size.width),
                        down((region.top - kMargin) * size.height));
  const cv::Point last(up((region.right + kMargin) * size.width),
                       up((region.bottom + kMargin) * size.height));
  return cv::Rect(first, last) & all;
}

class SceneEraser {
 public:
  SceneEraser(const Store& store, Store::Connection& db, const SceneRow& scene, const Cut& cut,
              ErasedImages& result, std::vector<ImageSignature>& uncertain)
      : store_(store),
        db_(db),
        scene_(scene),
        view_(store, db, scene),
        cut_(cut),
        result_(result),
        uncertain_(uncertain) {}

  void run() {
    if (scene_.image || scene_.depth) ++result_.scenes;
    if (cut_.everything) {
      if (scene_.image || scene_.depth) ++result_.images;
      db_.run(
          "UPDATE scene SET image = NULL, depth = NULL, depth_width = NULL, depth_height = NULL, pixel_kinds "
          "= "
          "NULL WHERE id = ?",
          {sql(scene_.id)});
    } else {
      result_.regions += static_cast<int64_t>(cut_.regions.size());
      if (scene_.image) erase_color();
      if (scene_.depth) erase_pixels("depth", *scene_.depth, kDepthThumbnailMedia, 2);
      if (scene_.pixel_kinds) erase_pixels("pixel_kinds", *scene_.pixel_kinds, kPixelKindsMedia, 1);
    }
    for (const ObservationRow& other : view_.others()) erase_from_other(other);
    db_.run("INSERT OR IGNORE INTO temp.gone_image VALUES (?)", {sql(scene_.id)});
  }

 private:
  void erase_color() {
    const BlobRow blob = store_.blob(*scene_.image);
    std::optional<Id> rest;
    try {
      cv::Mat image = mapping::decode_image({blob.bytes.begin(), blob.bytes.end()}, store_.path().string());
      for (const Region& region : cut_.regions) {
        const cv::Rect pixels = pixels_of(view_.in_color(region), image.size());
        if (pixels.empty()) continue;
        if (image.depth() == CV_8U)
          (region.observed ? result_.signatures : uncertain_).push_back(signature_of(image, pixels));
        image(pixels).setTo(cv::Scalar::all(0));
      }
      for (const Region& region : cut_.color)
        image(pixels_of(view_.in_color(region), image.size())).setTo(cv::Scalar::all(0));
      const auto bytes = mapping::encode_image(image, blob.media == "image/png" ? ".png" : ".jpg");
      rest = db_.add_blob({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, blob.media);
    } catch (const Error&) {  // not an image: nobody can say what it shows
      ++result_.images;
    }
    db_.run("UPDATE scene SET image = ?1 WHERE id = ?2", {sql(rest), sql(scene_.id)});
  }

  /// Sets the regions to 0 in an image at the thumbnail's resolution.
  void erase_pixels(const char* column, Id blob, const char* media, size_t pixel_bytes) {
    std::string bytes = store_.blob(blob).bytes;
    const int width = scene_.depth_width, height = scene_.depth_height;
    for (const Region& region : cut_.regions)
      for (int y = std::max(0, int(std::floor(region.top * height - 1)));
           y <= std::min(height - 1, int(std::ceil(region.bottom * height + 0.5))); ++y)
        for (int x = std::max(0, int(std::floor(region.left * width - 1)));
             x <= std::min(width - 1, int(std::ceil(region.right * width + 0.5))); ++x) {
          const size_t at = pixel_bytes * (static_cast<size_t>(y) * static_cast<size_t>(width) + size_t(x));
          if (at + pixel_bytes <= bytes.size()) bytes.replace(at, pixel_bytes, pixel_bytes, '\0');
        }
    db_.run(fmt::format("UPDATE scene SET {} = ?1 WHERE id = ?2", column),
            {sql(db_.add_blob(bytes, media)), sql(scene_.id)});
  }

  /// The crop of a neighbour shows it too; a mask and points only where it was not observed apart.
  void erase_from_other(const ObservationRow& other) {
    if (!other.crop && !other.mask && !other.cloud) return;
    const bool unknown = cut_.everything || !other.roi || !scene_.camera;
    const bool overlaps = unknown || std::ranges::any_of(cut_.regions, [&](const Region& region) {
                            return region.overlaps(roi_region(other, *scene_.camera));
                          });
    if (!overlaps) return;
    db_.run("UPDATE observation SET crop = NULL WHERE id = ?", {sql(other.id)});
    if (!cut_.observed)
      db_.run("UPDATE observation SET mask = NULL, cloud = NULL WHERE id = ?", {sql(other.id)});
  }

  const Store& store_;
  Store::Connection& db_;
  const SceneRow& scene_;
  const SceneView view_;
  const Cut& cut_;
  ErasedImages& result_;
  std::vector<ImageSignature>& uncertain_;  ///< of regions where the object was not observed
};

/// What each scene must lose, found by going through time from each observation.
std::map<Id, Cut> cuts_of(const Store& store, Store::Connection& db, const std::vector<Track>& tracks,
                          const std::vector<SceneRow>& scenes) {
  std::map<Id, Cut> cuts;
  for (const Track& track : tracks) {
    std::map<Id, const ErasedObservation*> observed;
    for (const ErasedObservation& one : track) observed[one.row.scene] = &one;
    const auto first =
        std::ranges::find_if(scenes, [&](const SceneRow& s) { return observed.contains(s.id); });
    auto last = first;
    for (auto scene = first; scene != scenes.end(); ++scene)
      if (observed.contains(scene->id)) last = scene;
    const auto apply = [&](const SceneRow& scene, bool believed,
                           const std::vector<const ErasedObservation*>& boxes) {
      const SceneView view(store, db, scene);
      Cut cut;
      bool stays = false;
      for (const ErasedObservation* box : boxes) {
        const Content content = cut_unobserved(*box, believed, view, cut);
        stays = stays || (content != Content::empty && content != Content::partly_hidden);
      }
      if (cut.everything || !cut.regions.empty()) {
        Cut& all = cuts[scene.id];
        all.regions.insert(all.regions.end(), cut.regions.begin(), cut.regions.end());
        all.everything = all.everything || cut.everything;
        all.observed = all.observed && cut.observed;
      }
      return stays;
    };
    // Before it was first observed, and after it was observed last, until its spot was seen without it.
    for (auto scene = first; scene != scenes.begin();)
      if (!apply(*--scene, false, {&track.front()})) break;
    for (auto scene = last; scene != scenes.end() && ++scene != scenes.end();)
      if (!apply(*scene, false, {&track.back()})) break;
    auto next = track.begin();
    for (auto scene = first; scene != scenes.end() && scene <= last; ++scene) {
      while (next != track.end() && next->time < scene->time) ++next;
      const auto here = observed.find(scene->id);
      if (here != observed.end()) {
        const SceneView view(store, db, *scene);
        cut_observed(*here->second, *scene, view, cuts[scene->id]);
        continue;
      }
      std::vector<const ErasedObservation*> boxes;
      if (next != track.begin()) boxes.push_back(&*std::prev(next));
      if (next != track.end()) boxes.push_back(&*next);
      apply(*scene, true, boxes);
    }
  }
  return cuts;
}

/// Drops the signatures that an image of the memory shows.
void drop_shown(const Store& store, std::vector<ImageSignature>& signatures) {
  if (signatures.empty()) return;
  for (const SceneRow& scene : store.scenes())
    if (const auto image = stored_image(store, scene))
      std::erase_if(signatures, [&](const ImageSignature& signature) { return shows(*image, signature); });
}

}  // namespace

ErasedImages erase_from_images(const Store& store, Store::Connection& db) {
  ErasedImages result;
  const std::vector<Track> tracks = read_tracks(db);
  if (tracks.empty()) return result;
  const std::vector<SceneRow> scenes = store.scenes();
  const std::map<Id, Cut> cuts = cuts_of(store, db, tracks, scenes);
  std::vector<ImageSignature> uncertain;
  for (const SceneRow& scene : scenes)
    if (const auto cut = cuts.find(scene.id); cut != cuts.end())
      SceneEraser(store, db, scene, cut->second, result, uncertain).run();
  drop_shown(store, uncertain);
  result.signatures.insert(result.signatures.end(), uncertain.begin(), uncertain.end());
  db.statements.clear();
  return result;
}

std::optional<cv::Mat> stored_image(const Store& store, const SceneRow& scene) {
  if (!scene.image) return std::nullopt;
  const BlobRow blob = store.blob(*scene.image);
  try {
    cv::Mat image = mapping::decode_image({blob.bytes.begin(), blob.bytes.end()}, store.path().string());
    return image.depth() == CV_8U ? std::optional(image) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;  // verify reports broken images
  }
}

bool shows(const cv::Mat& image, const ImageSignature& signature) {
  constexpr int kMaxDifference = 10, kMinContrast = 24;
  const auto [darkest, brightest] = std::ranges::minmax(signature.means);
  if (brightest - darkest < kMinContrast) return false;
  if (image.cols != signature.width || image.rows != signature.height) return false;
  const auto& [x, y, width, height] = signature.region;
  const ImageSignature here = signature_of(image, {x, y, width, height});
  for (size_t i = 0; i < here.means.size(); ++i)
    if (std::abs(int(here.means[i]) - int(signature.means[i])) > kMaxDifference) return false;
  return true;
}

ImageSignature signature_of(const cv::Mat& image, const cv::Rect& region) {
  ImageSignature signature{image.cols, image.rows, {region.x, region.y, region.width, region.height}, {}};
  cv::Mat color = image(region);
  if (color.channels() == 1) cv::cvtColor(color, color, cv::COLOR_GRAY2BGR);
  if (color.channels() == 4) cv::cvtColor(color, color, cv::COLOR_BGRA2BGR);
  cv::Mat small;
  cv::resize(color, small, {8, 8}, 0, 0, cv::INTER_AREA);
  std::copy_n(small.isContinuous() ? small.data : small.clone().data, signature.means.size(),
              signature.means.begin());
  return signature;
}

}  // namespace loci::memory

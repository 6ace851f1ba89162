#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gui/core/colored_cloud.h"
#include "mapping/base/math/pose.h"
#include "mapping/sensor/camera.h"
#include "mapping/sensor/pixel_kind.h"
#include "memory/store/rows/rows.h"

namespace loci::memory {
class Store;
}  // namespace loci::memory

namespace loci::gui {

/// An object as it was found in an image.
struct ImageBox {
  memory::Id object = 0;     ///< 0 = none
  std::string unnamed = {};  ///< in place of an object's name: "tentative", "false cluster"
  int64_t number = 0;        ///< of the observation within its scene
  cv::Rect2d color = {};     ///< pixels of the colour image
  cv::Rect2d depth = {};     ///< pixels of the depth image
  /// Outlines of the mask in pixels of either image; empty = no mask is stored.
  std::vector<std::vector<cv::Point2f>> color_outline = {}, depth_outline = {};
};

/// What was recorded of one scene, decoded.
struct SceneContent {
  memory::SceneRow scene = {};
  cv::Mat color = {};  ///< CV_8UC3, BGR; empty = not stored
  cv::Mat depth = {};  ///< CV_32F, metres, NaN = no measurement; may be smaller than the camera's image
  mapping::RgbdCamera camera = {};
  std::optional<Isometry3d> map_from_camera = {};
  cv::Mat kinds = {};  ///< CV_8U of depth's size, mapping::PixelKind; empty = unknown
  std::vector<ImageBox> boxes = {};
};

/// Error when an image is broken.
SceneContent read_scene_content(const memory::Store& store, const memory::SceneRow& row);

/// An image of the memory as CV_8UC3, BGR. Error when it is broken.
cv::Mat read_image(const memory::Store& store, memory::Id blob);

/// What the scene's image shows at a point (depth camera's frame): red, green, blue; grey without a
/// image.
std::array<uint8_t, 3> color_at(const SceneContent& content, const Vector3d& in_camera);

/// The measured points of a scene in the map frame with the colours of its image (grey without one), at
/// most `limit` of them, taken in even steps. Empty without depth or pose.
ColoredCloud frame_cloud(const SceneContent& content, size_t limit);

/// What the pixels of the colour image are (CV_8U, mapping::PixelKind, as many pixels as the depth image
/// has), through the depth that was measured there. Empty when unknown.
cv::Mat kinds_in_color(const SceneContent& content);

/// What was measured at a pixel of a scene's images.
struct PixelValues {
  std::optional<double> depth = {};                  ///< metres along the depth camera's axis
  std::optional<std::array<uint8_t, 3>> color = {};  ///< red, green, blue
  std::optional<Vector3d> position = {};             ///< map frame
};

/// `pixel` is one of the camera's colour image, or of its depth image (which may be stored smaller). What
/// belongs to a colour pixel is looked for in the depth image, between which the cameras' offset counts.
PixelValues values_at_color(const SceneContent& content, const Vector2d& pixel);
PixelValues values_at_depth(const SceneContent& content, const Vector2d& pixel);

/// Something that an annotator read or recognised in a part of an image: a text, a barcode, a logo, an
/// answer of a visual search.
struct ImageNote {
  std::string type = {};       ///< without its package: "BarcodeAnnotation"
  std::string text = {};       ///< content; empty = only a region
  std::string annotator = {};  ///< empty = unknown
  int64_t observation = 0;     ///< number of the observation it is about within its scene; -1 = of none
  cv::Rect2d region = {};      ///< pixels of the colour image
};

/// All annotations of a scene that have an image region of their own, as they stand in the memory.
std::vector<ImageNote> image_notes(const memory::Store& store, memory::Id scene);

/// The same from the JSON of one feature structure.
std::vector<ImageNote> notes_in(const std::string& json);

}  // namespace loci::gui

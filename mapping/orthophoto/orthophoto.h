#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "mapping/interpretation/fronts/furniture_face.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// What the frames show in a plane before a face: what stands there is sharp, the face itself is blurred
/// unless it is of one colour.
struct PhotoLayer {
  double depth = 0;   ///< metres before the face
  cv::Mat color;      ///< CV_8UC3, BGR; as large as the orthophoto
  cv::Mat agreement;  ///< CV_32F, share of the frames that show about this colour
};

/// A colour frame projected onto the plane of a face; images are as large as the orthophoto.
struct PhotoView {
  size_t frame = 0;                    ///< number in the recording
  cv::Mat color;                       ///< CV_8UC3
  cv::Mat quality;                     ///< CV_32F, weight; 0 = not seen
  cv::Mat relief;                      ///< CV_32F, metres before the plane; NaN = not measured
  Vector3d camera = Vector3d::Zero();  ///< position of the colour camera in the face's coordinates
  Vector3d ground =
      Vector3d::Zero();  ///< of the frame: the surface is at ground · (1, u, v) before the plane
};

/// Where a frame shows on the face what it shows in a layer: scaled about the foot of the camera.
struct LayerScaling {
  double scale = 1, x = 0, y = 0;  ///< pixels
  cv::Point on_face(double column, double row) const {
    return {static_cast<int>(std::floor(scale * column + x + 0.5)),
            static_cast<int>(std::floor(scale * row + y + 0.5))};
  }
};

/// Images of a furniture face as from an infinite distance before it. The first row is at the top, the first
/// column at the left of a person before the face; all images have one size. A pixel stands for the rays that
/// cross the plane there: what stands before the plane is displaced by `slope` times its relief.
struct Orthophoto {
  FurnitureFace face;
  double pixel_m = 0;     ///< size of a pixel
  double u0 = 0, v0 = 0;  ///< left edge of the first column, lower edge of the last row
  double roll = 0;        ///< radians by which the images were turned about their middle, clockwise
  cv::Mat color;          ///< CV_8UC3, BGR; black where nothing was seen
  cv::Mat weight;         ///< CV_32F, sum of the weights of the frames; 0 = not seen
  cv::Mat ground;         ///< CV_32F, metres before the plane, of the surface that fronts are part of
  cv::Mat relief;         ///< CV_32F, metres before that surface; NaN = not measured
  cv::Mat relief_sd;      ///< CV_32F, metres, of the relief
  cv::Mat slope;          ///< CV_32FC2, mean change of (u, v) of the rays per metre towards the observer
  cv::Mat slope_sd;       ///< CV_32FC2, standard deviation of it over the frames
  std::vector<PhotoLayer> layers;  ///< nearest to the face first
  std::vector<size_t> frames;      ///< numbers of the frames used
  std::vector<PhotoView> views;    ///< these frames, without relief

  /// Frees what only the search for fronts reads, nine tenths of the memory: layers, views, weights and
  /// deviations.
  void drop_evidence();
  int width() const { return color.cols; }
  int height() const { return color.rows; }
  double u(double column) const { return u0 + (column + 0.5) * pixel_m; }
  double v(double row) const { return v0 + (height() - row - 0.5) * pixel_m; }
  double column(double u) const { return (u - u0) / pixel_m - 0.5; }
  double row(double v) const { return height() - 0.5 - (v - v0) / pixel_m; }
  /// The point of the map that the images show at (u, v), when it stands `depth` before the surface.
  Vector3d in_map(const Vector2d& at, double depth = 0) const;
  /// The point of the map that a layer shows at (u, v).
  Vector3d in_layer(const Vector2d& at, double depth) const;
  /// Where the images show a point of the map that is on or before the face: the inverse of in_map().
  Vector2d seen_at(const Vector3d& point) const;
  /// Where the images show the place of the face before which a point of the map stands.
  Vector2d stands_at(const Vector3d& point) const;
  /// Where the images show a place of the face, (u, v).
  Vector2d turned(const Vector2d& at) const;
  LayerScaling scaling(const PhotoView& view, double depth) const;

 private:
  cv::Point pixel_at(const Vector2d& at) const;
  Vector2d slope_at(const Vector2d& at) const;
  Vector2d middle() const { return {u0 + width() * pixel_m / 2, v0 + height() * pixel_m / 2}; }
};

/// Projects the colour frames that see a face onto its plane and fuses them by a weighted median; sharp, near
/// and frontal views weigh more. Depth images give the relief. Drift of each frame is removed first: along
/// the normal and in tilt by its depths, in the plane by its edges. Frames without pose or colour are not
/// used. Last the images are turned by up to two degrees so that most lines are level and upright: a map that
/// leans there would blur them. `map_from_camera`: pose of each frame in the map. Same result on any number
/// of threads.
Orthophoto make_orthophoto(const Recording& recording,
                           const std::vector<std::optional<Isometry3d>>& map_from_camera,
                           const FurnitureFace& face, int threads);

}  // namespace loci::mapping

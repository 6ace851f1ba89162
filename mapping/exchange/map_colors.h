#pragma once

#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <string>

#include "mapping/interpretation/interpretation.h"

namespace loci::mapping {

/// Longest side of a texture, pixels.
inline constexpr int kMaxTextureSide = 1024;

/// From the frame of the scan set that a map was made from to the map: the map's map_from_input, unless the
/// scans are in the map's frame already.
Isometry3d map_from_scan_set(const InterpretedMap& map, const ScanSet& scans);

/// Gives the links of a map that coloured points of its scans lie on the median of their colours. Links that
/// nobody saw, handles and knobs keep the colours of their classes, fronts with a photo its mean. Same result
/// on any number of threads.
void color_links(const ScanSet& scans, int threads, InterpretedMap& map);

/// The part of the map's photos that shows a front with `margin_m` around it (CV_8UC3, BGR; black where
/// nothing was seen); empty when they show less than half of it.
cv::Mat photo_of(const InterpretedMap& map, const Front& front, double margin_m = 0);

/// Mask of the pixels of a photo that were seen (CV_8U, 0 or 255).
cv::Mat seen_pixels(const cv::Mat& photo);

/// Gives the fronts that photos of the map show a second visual, the mesh of a rectangle a millimetre before
/// the panel with the photo as its texture; the panel gets the mean colour. Returns the files to write: bytes
/// by name, relative to the URDF's folder ("textures/door_1.obj", "textures/door_1.jpg",
/// "textures/textures.mtl"); none without photos.
std::map<std::string, std::string> add_textures(InterpretedMap& map);

/// Gives fronts that an update wrote anew the photos of the fronts of the same name and size in the map
/// before it: the same files, fitted to the new panels.
void keep_textures(const World& before, InterpretedMap& map);

/// What the textures of a map's fronts show, for InterpretedMap::photos: a photo for each upright front.
/// Files lie beside the URDF in `folder`; what cannot be read adds a warning.
std::vector<FacePhoto> photos_of_textures(const InterpretedMap& map, const std::filesystem::path& folder,
                                          Warnings& warnings);

}  // namespace loci::mapping

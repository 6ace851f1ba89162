#pragma once

#include <optional>

#include "mapping/sensor/camera.h"
#include "perception/conversions/opencv.h"
#include "perception/types/geometry.h"

namespace loci::perception::types {

// An object hypothesis in the data of one sensor as one in another's: points, image regions and volumes,
// given the calibration (a camera) and the pose between the two frames. New ones are made in the CAS of the
// old one, with its source. All throw Error when a hypothesis refers to points or pixels that are not there.

/// Positions of the points of a cluster in the frame of its cloud, m; points without measurement are left
/// out.
std::vector<Vector3d> positions_of(const ClusterPoints& points);

/// Points to image: each point covers a square of 2 `reach` + 1 pixels, so that a finer image has no holes
/// (reach 1 suits an image of the cloud's resolution). Nothing when no point falls on the image.
std::optional<ReferenceImageROI> image_roi(const ClusterPoints& points, const Mat& image,
                                           const mapping::PinholeCamera& camera,
                                           const Isometry3d& camera_from_cloud, int reach = 1);

/// Image to points: those of the cloud whose projection falls on the mask.
ReferenceClusterPoints points_in_image(const ImageROI& roi, const PointCloud& cloud,
                                       const mapping::PinholeCamera& camera,
                                       const Isometry3d& camera_from_cloud);

/// Volume to points: those of the cloud inside a box or sphere, whose frame is that of `frame_from_cloud`.
ReferenceClusterPoints points_in_volume(const TFLinkROI& volume, const PointCloud& cloud,
                                        const Isometry3d& frame_from_cloud);

/// Points to volume: the smallest box along the axes of the frame, and a sphere around the centre of that
/// box. Error when the cluster has no point.
TFLinkBBoxROI bounding_box(const ClusterPoints& points, const std::string& frame,
                           const Isometry3d& frame_from_cloud);
TFLinkSphereROI bounding_sphere(const ClusterPoints& points, const std::string& frame,
                                const Isometry3d& frame_from_cloud);

/// Volume to image: the pixels onto which it is projected, whatever stands before it. Nothing when it is out
/// of view; what is nearer to the camera than 1 cm is left out.
std::optional<ReferenceImageROI> image_roi(const TFLinkROI& volume, const Mat& image,
                                           const mapping::PinholeCamera& camera,
                                           const Isometry3d& camera_from_frame);

/// Volume to volume: the box along the axes of another frame (or the same) around it, the sphere around it.
TFLinkBBoxROI bounding_box(const TFLinkROI& volume, const std::string& frame,
                           const Isometry3d& frame_from_volume);
TFLinkSphereROI bounding_sphere(const TFLinkROI& volume, const std::string& frame,
                                const Isometry3d& frame_from_volume);

/// A region of the scene's image with an image of its own, and back into an image of the same camera.
StandaloneImageROI standalone(const ReferenceImageROI& reference);
ReferenceImageROI within(const StandaloneImageROI& alone, const Mat& image);

/// Points of the scene as a cloud of their own (x, y, z; without those that were not measured), and back: the
/// points of the scene's cloud that are the nearest to them, at most `reach` metres away.
StandaloneClusterPoints standalone(const ReferenceClusterPoints& reference);
ReferenceClusterPoints within(const StandaloneClusterPoints& alone, const PointCloud& cloud,
                              const Isometry3d& cloud_from_alone, double reach);

}  // namespace loci::perception::types

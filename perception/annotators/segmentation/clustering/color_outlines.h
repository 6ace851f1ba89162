#pragma once

#include <vector>

#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/segmentation/clustering/standing_points.h"

namespace loci::perception {

/// Flat objects by their outline in the colour image (§4.3): what differs in colour from the support all
/// around it, and lies higher than it by more than the noise of the mean over so many pixels. Paper, prints
/// and shadows do not rise, and the noise of the depth has no colour. An outline that one object explains
/// (elongated, or nearly convex) becomes one cluster: low clusters within it are pieces of it, as the bowl of
/// a spoon and its handle, or the rim of a tray. An outline that one cluster fills already is left alone.
/// `clusters`: those on the support `index`; `shows` as of stand_on_supports().
void join_by_color_outline(std::vector<ObjectCluster>& clusters, const ClusterImages& images,
                           const mapping::PinholeCamera& camera, const SupportGround& ground, int index,
                           const cv::Mat& shows, const ClusterOptions& options);

}  // namespace loci::perception

#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace loci::perception {

/// Takes flat objects of different colours apart that touch at their rims, such as plates, which no edge
/// parts: where two rims meet, the surface is convex. Each is seen from above, a straight line parts their
/// colours, and both are narrow where they meet; the halves of a book or a tool and its handle are not.
/// `points`, `normals`: in the support's plane, z = height, metres; `areas`: what each point stands for, m²;
/// `lab`: CIE Lab in 8 bits, empty = unknown; `members`: indices of the object. Gives the parts, or the
/// object itself.
std::vector<std::vector<size_t>> split_colors(const std::vector<Eigen::Vector3f>& points,
                                              const std::vector<Eigen::Vector3f>& normals,
                                              const std::vector<float>& areas,
                                              const std::vector<cv::Vec3b>& lab, std::vector<size_t> members);

}  // namespace loci::perception

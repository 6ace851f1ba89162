#pragma once

#include <string>
#include <vector>

#include "mapping/interpretation/furniture/parameters.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// A solid piece of a link for visual, collision and inertia.
struct LinkPart {
  Geometry shape;  ///< box or cylinder
  Isometry3d link_from_part = Isometry3d::Identity();
  double density = kFurniture.wood_density;  ///< kg/m³
};

/// A box with its centre at a point of the link, in the link's axes.
LinkPart box_part(const Vector3d& centre, const Vector3d& size);

/// A cylinder between two points of the link.
LinkPart rod_part(const Vector3d& from, const Vector3d& to, double radius, double density);

/// Mass, centre of mass and inertia of solid parts; positive definite where a part has a volume.
Inertial inertial_of(const std::vector<LinkPart>& parts);

/// The colour of links of a class.
Rgba color_of(const std::string& class_name);

/// Gives a link visual and collision geometry and inertia in the place of its own.
void set_parts(Link& link, const std::string& class_name, const std::vector<LinkPart>& parts);

/// Appends a link with visual and collision geometry and inertia, fixed to its parent by LINK_joint; the
/// joint may be changed afterwards. A link without parts is a frame.
Joint& add_link(World& world, const std::string& name, const std::string& class_name,
                const std::string& parent, const Isometry3d& parent_from_link,
                const std::vector<LinkPart>& parts);

}  // namespace loci::mapping

#pragma once

#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/link_parts.h"
#include "mapping/world/urdf.h"

namespace loci::mapping::test {

/// A map as interpretation writes it: floor, a counter's top, below it a drawer and a door, and a front that
/// is not known to move.
struct FurnishedMap {
  World world;
  SemanticMap semantics;

  FurnishedMap() {
    world.name = "map";
    world.root = "map";
    world.links.resize(1);
    world.links[0].name = "map";
    add_link(world, "floor", "floor", "map", Isometry3d::Identity(),
             {box_part({0, 0, -0.025}, {4, 4, 0.05})});
    semantics.links["floor"].class_name = "floor";
    add_link(world, "counter_1", "counter", "map", Isometry3d(Eigen::Translation3d(0, 1.7, 0.9)),
             {box_part({0, 0, -0.02}, {2.4, 0.6, 0.04})});
    semantics.links["counter_1"].class_name = "counter";

    Front drawer = front("drawer_1", {-0.8, 1.4, 0.74}, 0.2);
    drawer.joint = JointEstimate{};
    drawer.joint->type = ArticulationType::prismatic;
    drawer.joint->probabilities = {0, 1, 0};
    drawer.joint->axis = drawer.normal;
    drawer.joint->upper = 0.42;
    add_front(drawer, "counter_1", world, semantics);

    Front door = front("door_1", {0, 1.4, 0.45}, 0.7);
    door.joint = JointEstimate{};
    door.joint->type = ArticulationType::revolute;
    door.joint->probabilities = {0, 0, 1};
    door.joint->axis = -Vector3d::UnitZ();
    door.joint->origin = door.centre - Vector3d(0.3, 0, 0);
    door.joint->upper = 1.6;
    add_front(door, "counter_1", world, semantics);

    add_front(front("front_1", {0.8, 1.4, 0.45}, 0.7), "counter_1", world, semantics);
  }

  static Front front(const std::string& name, const Vector3d& centre, double height) {
    Front front;
    front.name = name;
    front.class_name = name.substr(0, name.find('_'));
    front.centre = centre;
    front.normal = Vector3d(0, -1, 0);
    front.width = 0.6;
    front.height = height;
    front.confidence = 0.9;
    Fixture handle;
    handle.centre = centre + Vector3d(0, -0.035, 0);
    handle.axis = Vector3d::UnitX();
    handle.length = 0.16;
    handle.protrusion = 0.035;
    front.fixture = handle;
    return front;
  }
};

}  // namespace loci::mapping::test

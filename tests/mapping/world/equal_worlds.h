#pragma once

#include <gtest/gtest.h>

#include "mapping/world/world.h"

namespace loci::mapping {

/// Everything equal; rotations to `angle_tolerance`, which roll-pitch-yaw text costs.
inline void expect_equal(const Isometry3d& a, const Isometry3d& b, double angle_tolerance) {
  EXPECT_EQ(a.translation(), b.translation());
  EXPECT_LE((a.linear() - b.linear()).cwiseAbs().maxCoeff(), angle_tolerance);
}

inline void expect_equal(const Geometry& a, const Geometry& b) {
  ASSERT_EQ(a.index(), b.index());
  if (const Box* box = std::get_if<Box>(&a)) {
    EXPECT_EQ(box->size, std::get<Box>(b).size);
  }
  if (const Sphere* sphere = std::get_if<Sphere>(&a)) {
    EXPECT_EQ(sphere->radius, std::get<Sphere>(b).radius);
  }
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&a)) {
    EXPECT_EQ(cylinder->radius, std::get<Cylinder>(b).radius);
    EXPECT_EQ(cylinder->length, std::get<Cylinder>(b).length);
  }
  if (const Mesh* mesh = std::get_if<Mesh>(&a)) {
    EXPECT_EQ(mesh->uri, std::get<Mesh>(b).uri);
    EXPECT_EQ(mesh->scale, std::get<Mesh>(b).scale);
  }
}

inline void expect_equal(const Material& a, const Material& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.color, b.color);
  EXPECT_EQ(a.texture, b.texture);
}

inline void expect_equal(const Link& a, const Link& b, double angle_tolerance) {
  SCOPED_TRACE("link " + a.name);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.attributes, b.attributes);
  EXPECT_EQ(a.extensions, b.extensions);
  ASSERT_EQ(a.inertial.has_value(), b.inertial.has_value());
  if (a.inertial) {
    expect_equal(a.inertial->link_from_inertial, b.inertial->link_from_inertial, angle_tolerance);
    EXPECT_EQ(a.inertial->mass, b.inertial->mass);
    EXPECT_EQ(a.inertial->inertia, b.inertial->inertia);
  }
  ASSERT_EQ(a.visuals.size(), b.visuals.size());
  for (size_t i = 0; i < a.visuals.size(); ++i) {
    const Visual &u = a.visuals[i], &v = b.visuals[i];
    EXPECT_EQ(u.name, v.name);
    EXPECT_EQ(u.extensions, v.extensions);
    expect_equal(u.link_from_visual, v.link_from_visual, angle_tolerance);
    expect_equal(u.geometry, v.geometry);
    ASSERT_EQ(u.material.has_value(), v.material.has_value());
    if (u.material) expect_equal(*u.material, *v.material);
  }
  ASSERT_EQ(a.collisions.size(), b.collisions.size());
  for (size_t i = 0; i < a.collisions.size(); ++i) {
    EXPECT_EQ(a.collisions[i].name, b.collisions[i].name);
    EXPECT_EQ(a.collisions[i].extensions, b.collisions[i].extensions);
    expect_equal(a.collisions[i].link_from_collision, b.collisions[i].link_from_collision, angle_tolerance);
    expect_equal(a.collisions[i].geometry, b.collisions[i].geometry);
  }
}

inline void expect_equal(const Joint& a, const Joint& b, double angle_tolerance) {
  SCOPED_TRACE("joint " + a.name);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.parent, b.parent);
  EXPECT_EQ(a.child, b.child);
  EXPECT_EQ(a.axis, b.axis);
  EXPECT_EQ(a.attributes, b.attributes);
  EXPECT_EQ(a.extensions, b.extensions);
  expect_equal(a.parent_from_joint, b.parent_from_joint, angle_tolerance);
  ASSERT_EQ(a.limits.has_value(), b.limits.has_value());
  if (a.limits) {
    EXPECT_EQ(a.limits->lower, b.limits->lower);
    EXPECT_EQ(a.limits->upper, b.limits->upper);
    EXPECT_EQ(a.limits->effort, b.limits->effort);
    EXPECT_EQ(a.limits->velocity, b.limits->velocity);
  }
  ASSERT_EQ(a.mimic.has_value(), b.mimic.has_value());
  if (a.mimic) {
    EXPECT_EQ(a.mimic->joint, b.mimic->joint);
    EXPECT_EQ(a.mimic->multiplier, b.mimic->multiplier);
    EXPECT_EQ(a.mimic->offset, b.mimic->offset);
  }
  ASSERT_EQ(a.safety.has_value(), b.safety.has_value());
  if (a.safety) {
    EXPECT_EQ(a.safety->soft_lower, b.safety->soft_lower);
    EXPECT_EQ(a.safety->soft_upper, b.safety->soft_upper);
    EXPECT_EQ(a.safety->k_position, b.safety->k_position);
    EXPECT_EQ(a.safety->k_velocity, b.safety->k_velocity);
  }
  ASSERT_EQ(a.calibration.has_value(), b.calibration.has_value());
  if (a.calibration) {
    EXPECT_EQ(a.calibration->rising, b.calibration->rising);
    EXPECT_EQ(a.calibration->falling, b.calibration->falling);
  }
  ASSERT_EQ(a.dynamics.has_value(), b.dynamics.has_value());
  if (a.dynamics) {
    EXPECT_EQ(a.dynamics->damping, b.dynamics->damping);
    EXPECT_EQ(a.dynamics->friction, b.dynamics->friction);
  }
}

inline void expect_equal(const World& a, const World& b, double angle_tolerance) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.root, b.root);
  EXPECT_EQ(a.attributes, b.attributes);
  EXPECT_EQ(a.extensions, b.extensions);
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (size_t i = 0; i < a.materials.size(); ++i) expect_equal(a.materials[i], b.materials[i]);
  ASSERT_EQ(a.links.size(), b.links.size());
  for (size_t i = 0; i < a.links.size(); ++i) expect_equal(a.links[i], b.links[i], angle_tolerance);
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (size_t i = 0; i < a.joints.size(); ++i) expect_equal(a.joints[i], b.joints[i], angle_tolerance);
}

}  // namespace loci::mapping

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointLimitConstraint.h>
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "mapping/world/kinematics.h"
#include "tests/mapping/exchange/furnished_map.h"
#include "tests/mapping/exchange/scanned_kitchens.h"

namespace loci::mapping::test {
namespace {

constexpr btScalar kMargin = 0.001F;  // m; Bullet's 4 cm would fill a drawer
constexpr btScalar kStep = 1.0F / 240;

btVector3 vector_of(const Vector3d& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

btTransform transform_of(const Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                  static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                     vector_of(pose.translation()));
}

/// A drawer or door of a map in a physics engine, built from nothing but the URDF: collision shapes, inertia,
/// joint, limits. All else of the map stands still.
class SimulatedJoint {
 public:
  SimulatedJoint(const World& world, const std::string& joint_name)
      : world_(world), root_from_link_(root_from_links(world, {})), joint_(*world.find_joint(joint_name)) {
    dynamics_.setGravity({0, 0, -9.81F});
    std::vector<std::string> moving = {joint_.child};
    for (size_t i = 0; i < moving.size(); ++i)
      for (const Joint& joint : world.joints)
        if (joint.parent == moving[i]) moving.push_back(joint.child);
    for (const Link& link : world.links)
      if (!link.collisions.empty() && std::ranges::find(moving, link.name) == moving.end()) add_static(link);
    add_moving(moving);
  }

  ~SimulatedJoint() {
    for (const auto& constraint : constraints_) dynamics_.removeMultiBodyConstraint(constraint.get());
    dynamics_.removeMultiBody(body_.get());
    for (int i = dynamics_.getNumCollisionObjects() - 1; i >= 0; --i)
      dynamics_.removeCollisionObject(dynamics_.getCollisionObjectArray()[i]);
  }

  void drop_box(const Vector3d& at, const Vector3d& size, double mass) {
    auto* shape = keep(std::make_unique<btBoxShape>(vector_of(size / 2)));
    shape->setMargin(kMargin);
    btVector3 inertia;
    shape->calculateLocalInertia(static_cast<btScalar>(mass), inertia);
    box_ = add_body(static_cast<btScalar>(mass), inertia, shape, Isometry3d(Eigen::Translation3d(at)));
    box_->setActivationState(DISABLE_DEACTIVATION);
  }

  /// Drives the joint towards a position, at most so fast, for some time.
  void drive(double target, double speed, double seconds) {
    for (double time = 0; time < seconds; time += kStep) {
      const double way = target - position();
      const double velocity = std::clamp(way * 10, -speed, speed);
      motor_->setVelocityTarget(static_cast<btScalar>(velocity));
      dynamics_.stepSimulation(kStep, 0);
    }
  }

  /// Between what the joint moves and all else, with the joint where it is.
  int contacts() {
    dynamics_.performDiscreteCollisionDetection();
    int count = 0;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold.getNumContacts(); ++k)
        count += manifold.getContactPoint(k).getDistance() < 0 ? 1 : 0;
    }
    return count;
  }

  double position() const { return body_->getJointPos(0); }
  Vector3d box() const {
    const btVector3& at = box_->getWorldTransform().getOrigin();
    return {at.x(), at.y(), at.z()};
  }
  /// In the frame of a link of the drawer as it stands open now.
  Vector3d box_in(const std::string& link) const {
    const std::vector<Isometry3d> now = root_from_links(world_, {{joint_.name, position()}});
    return now[world_.link_index(link)].inverse() * box();
  }

 private:
  template <class T>
  T* keep(std::unique_ptr<T> shape) {
    T* raw = shape.get();
    shapes_.push_back(std::move(shape));
    return raw;
  }

  btCollisionShape* shape_of(const Geometry& geometry) {
    btCollisionShape* shape = nullptr;
    if (const auto* box = std::get_if<Box>(&geometry)) {
      shape = keep(std::make_unique<btBoxShape>(vector_of(box->size / 2)));
    } else {
      const auto& rod = std::get<Cylinder>(geometry);
      shape = keep(std::make_unique<btCylinderShapeZ>(vector_of({rod.radius, rod.radius, rod.length / 2})));
    }
    shape->setMargin(kMargin);
    return shape;
  }

  btRigidBody* add_body(btScalar mass, const btVector3& inertia, btCollisionShape* shape,
                        const Isometry3d& pose) {
    states_.push_back(std::make_unique<btDefaultMotionState>(transform_of(pose)));
    bodies_.push_back(std::make_unique<btRigidBody>(
        btRigidBody::btRigidBodyConstructionInfo(mass, states_.back().get(), shape, inertia)));
    bodies_.back()->setFriction(0.5F);
    dynamics_.addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }

  void add_static(const Link& link) {
    auto* compound = keep(std::make_unique<btCompoundShape>());
    for (const Collision& collision : link.collisions)
      compound->addChildShape(transform_of(collision.link_from_collision), shape_of(collision.geometry));
    add_body(0, {0, 0, 0}, compound, root_from_link_[world_.link_index(link.name)]);
  }

  /// The links that are fixed to each other are one body about their common centre of mass.
  void add_moving(const std::vector<std::string>& moving) {
    double mass = 0;
    Vector3d weighted = Vector3d::Zero();
    for (const std::string& name : moving) {
      const std::optional<Inertial>& inertial = world_.find_link(name)->inertial;
      if (!inertial) continue;
      mass += inertial->mass;
      weighted += inertial->mass *
                  (root_from_link_[world_.link_index(name)] * inertial->link_from_inertial).translation();
    }
    ASSERT_GT(mass, 0);
    Isometry3d root_from_body = root_from_link_[world_.link_index(joint_.child)];
    root_from_body.translation() = weighted / mass;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    auto* compound = keep(std::make_unique<btCompoundShape>());
    for (const std::string& name : moving) {
      const Link& link = *world_.find_link(name);
      const Isometry3d body_from_link = root_from_body.inverse() * root_from_link_[world_.link_index(name)];
      for (const Collision& collision : link.collisions)
        compound->addChildShape(transform_of(body_from_link * collision.link_from_collision),
                                shape_of(collision.geometry));
      if (!link.inertial) continue;
      const Isometry3d body_from_inertial = body_from_link * link.inertial->link_from_inertial;
      const Vector3d offset = body_from_inertial.translation();
      inertia +=
          body_from_inertial.linear() * link.inertial->inertia * body_from_inertial.linear().transpose() +
          link.inertial->mass *
              (offset.squaredNorm() * Eigen::Matrix3d::Identity() - offset * offset.transpose());
    }
    const Isometry3d root_from_parent = root_from_link_[world_.link_index(joint_.parent)];
    const Isometry3d body_from_parent = root_from_body.inverse() * root_from_parent;
    body_ = std::make_unique<btMultiBody>(1, btScalar(0), btVector3(0, 0, 0), true, false);
    body_->setBaseWorldTransform(transform_of(root_from_parent));
    const Eigen::Quaterniond turn(body_from_parent.linear());
    const Vector3d parent_to_body = root_from_parent.inverse() * root_from_body.translation();
    const btQuaternion body_from(static_cast<btScalar>(turn.x()), static_cast<btScalar>(turn.y()),
                                 static_cast<btScalar>(turn.z()), static_cast<btScalar>(turn.w()));
    const auto body_mass = static_cast<btScalar>(mass);
    const btVector3 axis = vector_of(joint_.axis.normalized());
    if (joint_.type == JointType::prismatic) {
      body_->setupPrismatic(0, body_mass, vector_of(inertia.diagonal()), -1, body_from, axis,
                            vector_of(parent_to_body), btVector3(0, 0, 0), true);
    } else {
      const Isometry3d root_from_joint = root_from_link_[world_.link_index(joint_.child)];
      body_->setupRevolute(0, body_mass, vector_of(inertia.diagonal()), -1, body_from, axis,
                           vector_of((root_from_parent.inverse() * root_from_joint).translation()),
                           vector_of((root_from_joint.inverse() * root_from_body).translation()), true);
    }
    body_->finalizeMultiDof();
    dynamics_.addMultiBody(body_.get());
    collider_ = std::make_unique<btMultiBodyLinkCollider>(body_.get(), 0);
    collider_->setCollisionShape(compound);
    collider_->setWorldTransform(transform_of(root_from_body));
    collider_->setFriction(0.5F);
    body_->getLink(0).m_collider = collider_.get();
    dynamics_.addCollisionObject(collider_.get(), btBroadphaseProxy::DefaultFilter,
                                 btBroadphaseProxy::AllFilter);
    constraints_.push_back(std::make_unique<btMultiBodyJointLimitConstraint>(
        body_.get(), 0, static_cast<btScalar>(joint_.limits->lower),
        static_cast<btScalar>(joint_.limits->upper)));
    auto motor = std::make_unique<btMultiBodyJointMotor>(
        body_.get(), 0, btScalar(0), static_cast<btScalar>(joint_.limits->effort * kStep));
    motor_ = motor.get();
    constraints_.push_back(std::move(motor));
    for (const auto& constraint : constraints_) dynamics_.addMultiBodyConstraint(constraint.get());
  }

  const World& world_;
  std::vector<Isometry3d> root_from_link_;
  const Joint& joint_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btMultiBodyConstraintSolver solver_;
  btMultiBodyDynamicsWorld dynamics_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btDefaultMotionState>> states_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::unique_ptr<btMultiBody> body_;
  std::unique_ptr<btMultiBodyLinkCollider> collider_;
  std::vector<std::unique_ptr<btMultiBodyConstraint>> constraints_;
  btMultiBodyJointMotor* motor_ = nullptr;
  btRigidBody* box_ = nullptr;
};

/// Opens, drops a box into it, closes; the box must lie on the bottom before and afterwards, and have come
/// along.
void expect_box_stays(const World& world, const std::string& drawer) {
  constexpr double kOpen = 0.35;
  constexpr double kBox = 0.07;
  SimulatedJoint simulated(world, drawer + "_front_joint");
  simulated.drive(kOpen, 0.4, 2);
  ASSERT_NEAR(simulated.position(), kOpen, 0.01);
  const std::string bottom = drawer + "_bottom";
  const Isometry3d map_from_bottom =
      root_from_links(world, {{drawer + "_front_joint", kOpen}})[world.link_index(bottom)];
  simulated.drop_box(map_from_bottom * Vector3d(0.1, 0.05, 0.15), Vector3d::Constant(kBox), 0.25);
  simulated.drive(kOpen, 0.4, 2);
  const Vector3d dropped = simulated.box();
  EXPECT_NEAR(simulated.box_in(bottom).z(), kBox / 2, 0.005);

  simulated.drive(0, 0.4, 3);
  ASSERT_NEAR(simulated.position(), 0, 0.01);
  const Vector3d inside = simulated.box_in(bottom);
  const Vector3d half = std::get<Box>(world.find_link(bottom)->collisions.front().geometry).size / 2;
  EXPECT_NEAR(inside.z(), kBox / 2, 0.005);
  EXPECT_LT(std::abs(inside.x()), half.x());
  EXPECT_LT(std::abs(inside.y()), half.y());
  EXPECT_GT((simulated.box() - dropped).norm(), 0.5 * kOpen);
}

TEST(Simulator, BoxDroppedIntoAnOpenedDrawerStaysThereWhenItCloses) {
  expect_box_stays(parse_urdf(urdf_text(FurnishedMap().world), "map.urdf"), "drawer_1");
}

TEST(Simulator, SoDoesTheSampleKitchensDrawer) {
  expect_box_stays(read_urdf(std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf"),
                   "drawer_2");
}

/// Every joint of a map, pushed through its range by its own motor, all else closed.
void expect_all_open(const World& world, size_t min_joints) {
  size_t joints = 0;
  for (const Joint& joint : world.joints) {
    if (joint.type == JointType::fixed) continue;
    ++joints;
    SimulatedJoint simulated(world, joint.name);
    EXPECT_EQ(simulated.contacts(), 0) << joint.name;
    const double upper = joint.limits->upper;
    simulated.drive(upper, 0.5 * upper, 4);
    EXPECT_GT(simulated.position(), 0.97 * upper) << joint.name;
  }
  EXPECT_GE(joints, min_joints);
}

TEST(Simulator, TightFurnitureStandsFreeWhenClosedAndOpensToItsLimits) {
  expect_all_open(tight_furniture().world, 5);
}

TEST(Simulator, SoDoesAKitchenAsItWasScanned) {
  expect_all_open(scanned_sample_kitchen().world, 8);
}

TEST(Simulator, SoDoesTheKitchenOfALaboratory) {
  const std::optional<InterpretedMap> map = scanned_laboratory_kitchen();
  if (!map) GTEST_SKIP() << "no shared data";
  expect_all_open(map->world, 12);
}

}  // namespace
}  // namespace loci::mapping::test

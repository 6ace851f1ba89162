#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mapping/base/text/text.h"
#include "mapping/exchange/furniture_structure.h"
#include "mapping/world/kinematics.h"

namespace loci::mapping {
namespace {

constexpr double kUpright = 0.3;       // |z| of the normal of an upright face
constexpr double kMinFace = 0.01;      // m²
constexpr double kMinSide = 0.06;      // m; of a front: the edges of panels are thinner
constexpr double kAlongAxis = 0.7;     // cosine
constexpr double kSamePlane = 0.005;   // m
constexpr double kSameNormal = 0.995;  // cosine
constexpr double kFreeBefore = 0.4;    // m
constexpr double kRoundFixture = 1.5;  // longer than this times its thickness it is a bar

/// A planar face: its triangles have one normal and lie within a few millimetres of one plane.
struct Face {
  Vector3d normal;
  double offset = 0, area = 0;
  Vector3d weighted = Vector3d::Zero();
  std::vector<const WorldTriangle*> triangles;

  Vector3d middle() const { return weighted / area; }
};

bool called_fixture(const std::string& name) {
  const std::string text = lower_case(name);
  return text.find("handle") != std::string::npos || text.find("knob") != std::string::npos;
}

/// Lowest and highest coordinate along a direction; returns their distance.
double range_along(const std::vector<const WorldTriangle*>& triangles, const Vector3d& direction, double& low,
                   double& high) {
  low = 1e9;
  high = -1e9;
  for (const WorldTriangle* triangle : triangles)
    for (const Vector3d& corner : triangle->corners) {
      low = std::min(low, direction.dot(corner));
      high = std::max(high, direction.dot(corner));
    }
  return high - low;
}

class FurnitureReader {
 public:
  FurnitureReader(const World& world, const std::vector<WorldTriangle>& triangles)
      : world_(world),
        all_(triangles),
        root_from_link_(root_from_links(world, {})),
        of_link_(world.links.size()) {
    for (const WorldTriangle& triangle : triangles) of_link_[triangle.link].push_back(&triangle);
    for (const Link& link : world.links) mover_.push_back(mover_of(link.name));
  }

  void read(MapStructure& structure) const {
    std::map<std::string, size_t> front_of_link;
    for (const Joint& joint : world_.joints) {
      const bool turns = joint.type == JointType::revolute || joint.type == JointType::continuous;
      if (!turns && joint.type != JointType::prismatic) continue;
      std::vector<std::string> fixtures;
      const std::optional<KnownFront> front = read_front(joint, fixtures);
      if (!front) continue;
      for (const std::string& fixture : fixtures) structure.fixtures.push_back(read_fixture(fixture, *front));
      structure.fronts.push_back(*front);
    }
  }

 private:
  std::optional<KnownFront> read_front(const Joint& joint, std::vector<std::string>& fixtures) const {
    std::vector<const WorldTriangle*> body;
    std::vector<std::string> open = {joint.child};
    for (size_t i = 0; i < open.size(); ++i) {
      const std::vector<const WorldTriangle*>& own = of_link_[world_.link_index(open[i])];
      if (i > 0 && called_fixture(open[i])) {
        if (!own.empty()) fixtures.push_back(open[i]);
      } else {
        body.insert(body.end(), own.begin(), own.end());
      }
      for (const Joint& below : world_.joints)
        if (below.parent == open[i] && below.type == JointType::fixed) open.push_back(below.child);
    }
    std::ranges::stable_sort(body, std::greater{}, &WorldTriangle::area);
    const std::optional<Face> face = outer_face(body, joint, fixtures);
    if (!face) return std::nullopt;
    KnownFront known;
    known.name = known.front.name = joint.child;
    known.front = rectangle_of(*face);
    known.front.name = joint.child;
    known.front.class_name = joint.type == JointType::prismatic ? "drawer" : "door";
    known.front.joint = estimate_of(joint);
    known.main = free_before(known.front.centre, face->normal, joint.child);
    return known;
  }

  /// The face that shows: the largest upright one that looks towards the handle or away from the parent.
  std::optional<Face> outer_face(const std::vector<const WorldTriangle*>& body, const Joint& joint,
                                 const std::vector<std::string>& fixtures) const {
    std::vector<Face> faces = faces_of(body);
    std::erase_if(faces, [](const Face& face) { return face.area < kMinFace; });
    if (faces.empty()) return std::nullopt;
    keep_ends(joint, faces);
    const std::optional<Vector3d> outside = fixtures.empty() ? std::nullopt : centre_of(fixtures.front());
    const std::optional<Vector3d> inside = centre_above(joint);
    const auto looks_out = [&](const Face& face) {
      if (outside) return face.normal.dot(*outside - face.middle()) > 0;
      return !inside || face.normal.dot(face.middle() - *inside) > 0;
    };
    if (std::ranges::any_of(faces, looks_out))
      std::erase_if(faces, [&](const Face& face) { return !looks_out(face); });
    const auto largest = std::ranges::max_element(faces, {}, &Face::area);
    const Vector3d normal = largest->normal;
    const double area = largest->area;
    // A seal or a back board may be larger than what is before it.
    std::erase_if(faces, [&](const Face& face) {
      return face.normal.dot(normal) < kSameNormal || face.area < 0.6 * area;
    });
    return *std::ranges::max_element(faces, {}, &Face::offset);
  }

  /// Of what slides, leaves the faces at its ends where there are any: the side of a deep pull-out is larger
  /// than its front. Those of a panel that slides in its own plane are its edges.
  void keep_ends(const Joint& joint, std::vector<Face>& faces) const {
    if (joint.type != JointType::prismatic) return;
    const Vector3d axis = root_from_link_[world_.link_index(joint.child)].linear() * joint.axis.normalized();
    const auto is_end = [&](const Face& face) {
      const Front front = rectangle_of(face);
      return std::abs(face.normal.dot(axis)) > kAlongAxis && std::min(front.width, front.height) > kMinSide;
    };
    if (std::ranges::any_of(faces, is_end))
      std::erase_if(faces, [&](const Face& face) { return !is_end(face); });
  }

  /// Of triangles, largest first.
  static std::vector<Face> faces_of(const std::vector<const WorldTriangle*>& body) {
    std::vector<Face> faces;
    for (const WorldTriangle* triangle : body) {
      if (std::abs(triangle->normal.z()) > kUpright) continue;
      const Vector3d middle = (triangle->corners[0] + triangle->corners[1] + triangle->corners[2]) / 3;
      auto face = std::ranges::find_if(faces, [&](const Face& f) {
        return f.normal.dot(triangle->normal) > kSameNormal &&
               std::abs(f.normal.dot(middle) - f.offset) < kSamePlane;
      });
      if (face == faces.end()) {
        faces.push_back({triangle->normal, triangle->normal.dot(middle), 0, Vector3d::Zero(), {}});
        face = faces.end() - 1;
      }
      face->area += triangle->area;
      face->weighted += triangle->area * middle;
      face->triangles.push_back(triangle);
    }
    return faces;
  }

  static Front rectangle_of(const Face& face) {
    Front front;
    front.normal = face.normal;
    front.up = (Vector3d::UnitZ() - face.normal.z() * face.normal).normalized();
    double left = 0, right = 0, bottom = 0, top = 0;
    front.width = range_along(face.triangles, front.right(), left, right);
    front.height = range_along(face.triangles, front.up, bottom, top);
    front.centre =
        face.offset * face.normal + (left + right) / 2 * front.right() + (bottom + top) / 2 * front.up;
    return front;
  }

  JointEstimate estimate_of(const Joint& joint) const {
    const Isometry3d& pose = root_from_link_[world_.link_index(joint.child)];
    JointEstimate estimate;
    estimate.type =
        joint.type == JointType::prismatic ? ArticulationType::prismatic : ArticulationType::revolute;
    estimate.axis = pose.linear() * joint.axis.normalized();
    estimate.origin = pose.translation();
    if (joint.limits) {
      estimate.lower = joint.limits->lower;
      estimate.upper = joint.limits->upper;
    }
    return estimate;
  }

  /// Box of a fixture in the front's axes; the bar is its outermost part, as thick as it is across.
  KnownFixture read_fixture(const std::string& name, const KnownFront& front) const {
    const std::vector<const WorldTriangle*>& triangles = of_link_[world_.link_index(name)];
    const Vector3d right = front.front.right();
    const Vector3d& up = front.front.up;
    const Vector3d& out = front.front.normal;
    std::array<double, 3> low{}, high{};
    const double width = range_along(triangles, right, low[0], high[0]);
    const double height = range_along(triangles, up, low[1], high[1]);
    const double depth = range_along(triangles, out, low[2], high[2]);
    const double length = std::max(width, height);
    const double thickness = std::min({width, height, depth});
    KnownFixture known;
    known.name = name;
    known.front = front.name;
    Fixture& fixture = known.fixture;
    fixture.centre =
        (low[0] + high[0]) / 2 * right + (low[1] + high[1]) / 2 * up + (high[2] - thickness / 2) * out;
    const bool round = lower_case(name).find("knob") != std::string::npos ||
                       length < kRoundFixture * std::min(width, height);
    fixture.kind = round ? Fixture::Kind::knob : Fixture::Kind::handle;
    fixture.axis = round ? out : width > height ? right : up;
    fixture.length = length;
    known.main = front.main && free_before(fixture.centre + thickness / 2 * out, out, name);
    return known;
  }

  /// Of the nearest link above a joint that has a shape.
  std::optional<Vector3d> centre_above(const Joint& joint) const {
    std::optional<Vector3d> centre = centre_of(joint.parent);
    for (const Joint* above = world_.parent_joint(joint.parent); !centre && above != nullptr;
         above = world_.parent_joint(above->parent))
      centre = centre_of(above->parent);
    return centre;
  }

  std::optional<Vector3d> centre_of(const std::string& link) const {
    Vector3d weighted = Vector3d::Zero();
    double area = 0;
    for (const WorldTriangle* triangle : of_link_[world_.link_index(link)]) {
      weighted += triangle->area / 3 * (triangle->corners[0] + triangle->corners[1] + triangle->corners[2]);
      area += triangle->area;
    }
    if (area == 0) return std::nullopt;
    return Vector3d(weighted / area);
  }

  /// The link that a link moves with.
  size_t mover_of(std::string link) const {
    const Joint* joint = world_.parent_joint(link);
    for (; joint != nullptr && joint->type == JointType::fixed; joint = world_.parent_joint(link))
      link = joint->parent;
    return world_.link_index(link);
  }

  /// Whether the way out from a point meets nothing but what moves along.
  bool free_before(const Vector3d& from, const Vector3d& direction, const std::string& own) const {
    const size_t mover = mover_of(own);
    return std::ranges::none_of(all_, [&](const WorldTriangle& triangle) {
      if (mover_[triangle.link] == mover) return false;
      const double cosine = triangle.normal.dot(direction);
      if (std::abs(cosine) < 1e-6) return false;
      const double distance = triangle.normal.dot(triangle.corners[0] - from) / cosine;
      if (distance < kSamePlane || distance > kFreeBefore) return false;
      const Vector3d hit = from + distance * direction;
      for (size_t k = 0; k < 3; ++k) {
        const Vector3d edge = triangle.corners[(k + 1) % 3] - triangle.corners[k];
        if (edge.cross(hit - triangle.corners[k]).dot(triangle.normal) < 0) return false;
      }
      return true;
    });
  }

  const World& world_;
  const std::vector<WorldTriangle>& all_;
  std::vector<Isometry3d> root_from_link_;
  std::vector<std::vector<const WorldTriangle*>> of_link_;
  std::vector<size_t> mover_;
};

}  // namespace

void add_geometry_furniture(const World& world, const std::vector<WorldTriangle>& triangles,
                            MapStructure& structure) {
  FurnitureReader(world, triangles).read(structure);
}

}  // namespace loci::mapping

#include "mapping/sensor/pose_text.h"

#include <fmt/format.h>

#include <sstream>

#include "mapping/base/error.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/text.h"

namespace loci::mapping {
namespace {

bool read_number(const std::string& text, double& value) {
  std::istringstream stream(text);
  return (stream >> value) && (stream >> std::ws).eof();
}

}  // namespace

std::vector<PlanarPose> planar_poses_from(const std::string& text, const std::string& what) {
  std::vector<PlanarPose> poses;
  for (const std::string& part : split(text, ';')) {
    if (part.find_first_not_of(" \t\n") == std::string::npos) continue;
    const std::vector<std::string> values = split(part, ',');
    PlanarPose pose;
    double yaw_deg = 0;
    if (values.size() != 3 || !read_number(values[0], pose.x) || !read_number(values[1], pose.y) ||
        !read_number(values[2], yaw_deg))
      throw Error(fmt::format("{}: '{}' is no pose", what, part), {},
                  "a pose is x,y,yaw_deg; poses are separated by ;");
    pose.yaw = yaw_deg * kDegree;
    poses.push_back(pose);
  }
  if (poses.empty()) throw Error(what + " names no pose");
  return poses;
}

}  // namespace loci::mapping

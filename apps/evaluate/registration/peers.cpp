#include "apps/evaluate/registration/peers.h"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>

namespace loci::apps::registration_evaluation {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr double kReach = 1.0;  ///< metres

Cloud::Ptr cloud_of(const mapping::Scan& scan) {
  Cloud::Ptr cloud(new Cloud);
  cloud->reserve(scan.points.size());
  for (const mapping::ScanPoint& point : scan.points)
    if (point.returned) cloud->push_back({point.position.x(), point.position.y(), point.position.z()});
  return cloud;
}

PeerResult run(pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>& method, const mapping::Scan& target,
               const mapping::Scan& source, const Isometry3d& target_from_source) {
  method.setInputTarget(cloud_of(target));
  method.setInputSource(cloud_of(source));
  Cloud moved;
  method.align(moved, target_from_source.matrix().cast<float>());
  PeerResult result;
  const Eigen::Matrix4d pose = method.getFinalTransformation().cast<double>();
  result.target_from_source.translation() = pose.topRightCorner<3, 1>();
  result.target_from_source.linear() =
      Eigen::Quaterniond(Eigen::Matrix3d(pose.topLeftCorner<3, 3>())).normalized().toRotationMatrix();
  result.converged = method.hasConverged();
  return result;
}

}  // namespace

const std::vector<std::string>& peers() {
  static const std::vector<std::string> names = {"PCL ICP", "PCL GICP", "PCL NDT"};
  return names;
}

PeerResult align_with_peer(const std::string& peer, const mapping::Scan& target, const mapping::Scan& source,
                           const Isometry3d& target_from_source) {
  if (peer == "PCL GICP") {
    pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> method;
    method.setMaxCorrespondenceDistance(kReach);
    return run(method, target, source, target_from_source);
  }
  if (peer == "PCL NDT") {
    pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ> method;
    method.setResolution(static_cast<float>(kReach));
    method.setStepSize(0.1);
    method.setTransformationEpsilon(0.001);
    method.setMaximumIterations(50);
    return run(method, target, source, target_from_source);
  }
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> method;
  method.setMaxCorrespondenceDistance(kReach);
  method.setMaximumIterations(100);
  method.setTransformationEpsilon(1e-8);
  return run(method, target, source, target_from_source);
}

}  // namespace loci::apps::registration_evaluation

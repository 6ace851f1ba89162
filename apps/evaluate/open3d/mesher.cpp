#include <open3d/geometry/TriangleMesh.h>
#include <open3d/pipelines/integration/ScalableTSDFVolume.h>

#include "apps/evaluate/mesh/mesher.h"
#include "apps/evaluate/open3d/image.h"

namespace loci::apps::mesh_claim {
namespace {

namespace integration = open3d::pipelines::integration;

class Open3dMesher : public Mesher {
 public:
  explicit Open3dMesher(const MesherOptions& options)
      : range_max_m_(options.range_max_m),
        volume_(options.voxel_m, options.truncation_m, integration::TSDFVolumeColorType::RGB8) {}

  void add(const mapping::RgbdFrame& frame) override {
    volume_.Integrate(*open3d_peer::rgbd_of(frame, range_max_m_, false),
                      open3d_peer::intrinsic_of(frame.camera.depth),
                      frame.map_from_camera->inverse().matrix());
  }

  mapping::ColoredMesh mesh() override {
    const auto found = volume_.ExtractTriangleMesh();
    mapping::ColoredMesh mesh;
    for (const Eigen::Vector3d& vertex : found->vertices_) mesh.positions.push_back(vertex.cast<float>());
    for (const Eigen::Vector3d& color : found->vertex_colors_) {
      const Eigen::Matrix<uint8_t, 3, 1> bytes = (255 * color).cast<uint8_t>();
      mesh.colors.push_back({bytes[0], bytes[1], bytes[2]});
    }
    for (const Eigen::Vector3i& triangle : found->triangles_)
      mesh.triangles.push_back({static_cast<uint32_t>(triangle[0]), static_cast<uint32_t>(triangle[1]),
                                static_cast<uint32_t>(triangle[2])});
    return mesh;
  }

 private:
  double range_max_m_;
  integration::ScalableTSDFVolume volume_;
};

}  // namespace
}  // namespace loci::apps::mesh_claim

extern "C" loci::apps::mesh_claim::Mesher* loci_open3d_mesher(
    const loci::apps::mesh_claim::MesherOptions& options) {
  return new loci::apps::mesh_claim::Open3dMesher(options);
}

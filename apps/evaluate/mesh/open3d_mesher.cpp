#include "apps/evaluate/mesh/mesher.h"
#include "mapping/base/error.h"
#include "mapping/base/load_symbol.h"

namespace loci::apps::mesh_claim {

std::unique_ptr<Mesher> open3d_mesher([[maybe_unused]] const MesherOptions& options) {
#ifdef LOCI_OPEN3D
  using Create = Mesher* (*)(const MesherOptions&);
  static const auto create = reinterpret_cast<Create>(
      load_symbol("loci_open3d.so", "loci_open3d_mesher", "Open3D cannot be compared", "install libopen3d"));
  return std::unique_ptr<Mesher>(create(options));
#else
  throw Error("loci was built without Open3D", {}, "install libopen3d-dev and build loci-evaluate again");
#endif
}

}  // namespace loci::apps::mesh_claim

#include "perception/conversions/camera.h"

namespace loci::perception::types {

CameraInfo Conversion<mapping::PinholeCamera>::to(cas::Cas& cas, const mapping::PinholeCamera& camera) {
  const CameraInfo info = CameraInfo::create(cas);
  info.width.set(camera.width);
  info.height.set(camera.height);
  info.fx.set(camera.fx);
  info.fy.set(camera.fy);
  info.cx.set(camera.cx);
  info.cy.set(camera.cy);
  return info;
}

mapping::PinholeCamera Conversion<mapping::PinholeCamera>::from(const CameraInfo& proxy) {
  return {proxy.width.get(), proxy.height.get(), proxy.fx.get(),
          proxy.fy.get(),    proxy.cx.get(),     proxy.cy.get()};
}

void set_cameras(const SceneCas& cas, const mapping::RgbdCamera& camera) {
  const CameraInfo depth = to(cas.cas(), camera.depth);
  depth.name.set("depth");
  cas.set_camera(depth);
  const CameraInfo color = to(cas.cas(), camera.color);
  color.name.set("color");
  color.depth_from_camera.set(to(cas.cas(), camera.depth_from_color));
  cas.set_camera(color);
}

mapping::RgbdCamera cameras(const SceneCas& cas) {
  const CameraInfo color = cas.camera("color");
  return {from<mapping::PinholeCamera>(cas.camera("depth")), from<mapping::PinholeCamera>(color),
          from<Isometry3d>(color.depth_from_camera.get())};
}

}  // namespace loci::perception::types

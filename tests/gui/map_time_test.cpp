#include "mapping/world/kinematics.h"
#include "mapping/world/urdf.h"
#include "memory/recorder/map_entry.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui::test {
namespace {

/// Where a world has its table.
double table_x(const mapping::World* world) {
  const std::vector<Isometry3d> poses = root_from_links(*world, {});
  for (size_t i = 0; i < world->links.size(); ++i)
    if (world->links[i].name == "table_1") return poses[i].translation().x();
  return 0;
}

class MapInTime : public BrowserWindow {};

TEST_F(MapInTime, FurnitureThatMovedStandsWhereItStoodThen) {
  const std::filesystem::path memory = folder_.path / "moved.loci", map = folder_.path / "moved.urdf";
  const SampleMemory sample = write_sample_memory(memory);
  const std::filesystem::path kitchen = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf";
  mapping::World moved = mapping::parse_urdf(read_file(kitchen), "kitchen.urdf");
  for (mapping::Joint& joint : moved.joints)
    if (joint.child == "table_1") joint.parent_from_joint.translation().x() += 0.4;
  write_file_atomically(map, urdf_text(moved));
  const TimeNs evening = sample.third + 3600 * kSecond;
  {
    memory::Store store = memory::Store::open_write(memory);
    enter_map(store, map, evening, "test");
  }
  window.show_data(OpenMemory::open(memory));
  go_to(evening);
  const OpenMemory* data = window.browser().data();
  EXPECT_NEAR(table_x(data->world(evening)) - table_x(data->world(sample.third)), 0.4, 1e-6);
  EXPECT_EQ(data->world(), data->world(evening));
  // The same for the eye, with nothing but the map drawn.
  for (const MapLayer layer : {MapLayer::objects, MapLayer::labels, MapLayer::cloud, MapLayer::camera})
    window.maps().set_layer(layer, false);
  window.map().look_from(MapViewpoint::top);
  const auto image_at = [&](TimeNs time) {
    go_to(time);
    return window.map().image();
  };
  const auto morning = image_at(sample.first), moved_table = image_at(evening);
  EXPECT_NE(moved_table, morning);
  EXPECT_EQ(image_at(sample.first), morning);
}

}  // namespace
}  // namespace loci::gui::test

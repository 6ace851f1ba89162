#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/files.h"
#include "mapping/base/math/pose.h"

namespace loci::nbv::test {

/// A room of 3.6 m × 3 m, its floor at z = 0 around the origin, with furniture along its north wall; written
/// as URDF.
class SmallWorld {
 public:
  SmallWorld() {
    for (const double side : {-1.0, 1.0}) {
      box(side < 0 ? "west" : "east", {1.85 * side, 0, 1.25}, {0.1, 3.2, 2.5});
      box(side < 0 ? "south" : "north", {0, 1.55 * side, 1.25}, {3.6, 0.1, 2.5});
    }
  }

  /// Stands firm.
  void box(const std::string& name, const Vector3d& centre, const Vector3d& size) {
    text_ += fmt::format("<link name='{}'>{}</link>", name, visual(Vector3d::Zero(), size));
    joint(name, "fixed", centre, "");
  }
  /// A drawer's front that looks south from y = `face`, with a bar across it. `more` goes into its joint.
  void drawer(const std::string& name, double x, double face, double z, double width, double height,
              const std::string& more = "") {
    front(name, width, height, 0, {0}, 0.2);
    joint(name, "prismatic", {x, face, z},
          "<axis xyz='0 -1 0'/><limit lower='0' upper='0.4' effort='1' velocity='1'/>" + more);
  }
  /// What looks like a drawer, but does not open.
  void fixed_front(const std::string& name, double x, double face, double z, double width, double height) {
    front(name, width, height, 0, {0}, 0.2);
    joint(name, "fixed", {x, face, z}, "");
  }
  /// A drawer with two bars in line, each over a part of its width.
  void two_bar_drawer(const std::string& name, double x, double face, double z, double width, double height) {
    front(name, width, height, 0, {-0.25 * width, 0.25 * width}, 0.3 * width);
    joint(name, "prismatic", {x, face, z},
          "<axis xyz='0 -1 0'/><limit lower='0' upper='0.4' effort='1' velocity='1'/>");
  }
  /// What looks like a drawer, but is hinged at its lower edge.
  void flap(const std::string& name, double x, double face, double z, double width, double height) {
    front(name, width, height, height / 2, {0}, 0.2);
    joint(name, "revolute", {x, face, z - height / 2},
          "<axis xyz='1 0 0'/><limit lower='0' upper='1.5' effort='1' velocity='1'/>");
  }

  std::filesystem::path write(const std::filesystem::path& folder) const {
    make_folder(folder);
    write_file_atomically(folder / "world.urdf",
                          "<robot name='small'><link name='map'/>" + text_ + "</robot>");
    return folder / "world.urdf";
  }

 private:
  /// The link of a front around a middle `up` above its origin, with level bars of a length around places
  /// across it.
  void front(const std::string& name, double width, double height, double up,
             const std::vector<double>& places, double bar) {
    const double at = up + 0.2 * height;
    text_ +=
        fmt::format("<link name='{}'>{}", name, visual({0, 0.01, up}, {width - 0.008, 0.02, height - 0.008}));
    for (const double place : places)
      text_ += visual({place, -0.03, at}, {bar, 0.012, 0.012}) +
               visual({place - 0.4 * bar, -0.012, at}, {0.008, 0.024, 0.008}) +
               visual({place + 0.4 * bar, -0.012, at}, {0.008, 0.024, 0.008});
    text_ += "</link>";
  }
  static std::string visual(const Vector3d& at, const Vector3d& size) {
    return fmt::format("<visual><origin xyz='{} {} {}'/><geometry><box size='{} {} {}'/></geometry></visual>",
                       at.x(), at.y(), at.z(), size.x(), size.y(), size.z());
  }
  void joint(const std::string& child, const std::string& type, const Vector3d& at, const std::string& more) {
    text_ += fmt::format(
        "<joint name='{0}_joint' type='{1}'><parent link='map'/><child link='{0}'/>"
        "<origin xyz='{2} {3} {4}'/>{5}</joint>",
        child, type, at.x(), at.y(), at.z(), more);
  }

  std::string text_;
};

}  // namespace loci::nbv::test

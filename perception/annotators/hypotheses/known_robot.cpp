#include "perception/annotators/hypotheses/known_robot.h"

#include <algorithm>
#include <map>

#include "mapping/base/csv.h"

namespace loci::perception {

JointState KnownRobot::joints_at(TimeNs time) const {
  if (rows.empty()) return {};
  const auto after = std::ranges::upper_bound(rows, time, {}, &Row::time_ns);
  return after == rows.begin() ? rows.front().joints : std::prev(after)->joints;
}

std::vector<KnownRobot::Row> KnownRobot::read_joints(const std::filesystem::path& path,
                                                     const mapping::World& world) {
  const CsvTable table = CsvTable::read(path);
  const size_t joint = table.require_column("joint"), position = table.require_column("position");
  const int time = table.column("time_ns");
  std::map<TimeNs, JointState> changes;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::string& name = table.cell(row, joint);
    if (!world.find_joint(name))
      throw Error("the robot has no joint '" + name + "'", table.location(row),
                  "names are those of its URDF");
    changes[time < 0 ? 0 : table.integer(row, static_cast<size_t>(time))][name] = table.number(row, position);
  }
  std::vector<Row> rows;
  JointState joints;
  for (const auto& [at, changed] : changes) {
    for (const auto& [name, value] : changed) joints[name] = value;
    rows.push_back({at, joints});
  }
  return rows;
}

}  // namespace loci::perception

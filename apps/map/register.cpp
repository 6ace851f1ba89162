#include <fmt/format.h>

#include <array>
#include <cmath>
#include <sstream>

#include "apps/map/commands.h"
#include "mapping/base/json.h"
#include "mapping/base/math.h"
#include "mapping/registration/registration.h"

namespace loci::apps {
namespace {

struct RegisterArguments {
  std::vector<std::string> scans;
  std::string out, guess;
  bool dof_given = false;
  mapping::RegistrationOptions options;
};

/// "x,y,z,yaw_deg": the pose of each scan as seen from the one before it.
Isometry3d pose_of(const std::string& guess) {
  const Error malformed(fmt::format("'{}' is no guess", guess), {"", 0, "--guess"},
                        "four numbers with commas between: x,y,z (metres) and yaw (degrees)");
  std::array<double, 4> values{};
  std::istringstream stream(guess);
  for (size_t i = 0; i < values.size(); ++i) {
    char comma = ',';
    if (i > 0 && (!(stream >> comma) || comma != ',')) throw malformed;
    if (!(stream >> values[i])) throw malformed;
  }
  if (!(stream >> std::ws).eof()) throw malformed;
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(values[0], values[1], values[2]);
  pose.linear() = rotation_from_rpy({0, 0, values[3] * kPi / 180});
  return pose;
}

/// A scan set, or several bare clouds as one, each at the guess from the one before it.
mapping::ScanSet read_scans(const RegisterArguments& arguments) {
  mapping::ScanSet set = mapping::read_scan_set(arguments.scans.front());
  for (size_t i = 1; i < arguments.scans.size(); ++i) {
    mapping::ScanSet more = mapping::read_scan_set(arguments.scans[i]);
    if (set.free_space || more.free_space)
      throw Error("only bare PCD files can be given one by one", {arguments.scans[i], 0, {}},
                  "a scan set is registered by itself");
    set.scans.push_back(std::move(more.scans.front()));
    // Files of one name in different folders are different scans.
    set.scans.back().name += arguments.scans.size() > 1 ? fmt::format("_{}", i) : "";
  }
  if (arguments.guess.empty()) return set;
  if (arguments.scans.size() < 2)
    throw Error("a guess is for bare PCD files", {arguments.scans.front(), 0, "--guess"},
                "the poses of a scan set stand in its scans.yaml");
  const Isometry3d guess = pose_of(arguments.guess);
  for (size_t i = 1; i < set.scans.size(); ++i)
    set.scans[i].map_from_scan = set.scans[i - 1].map_from_scan * guess;
  return set;
}

std::string answer_text(const mapping::RegistrationResult& result) {
  std::string text = result.summary() + "\n";
  for (const mapping::PairAlignment& pair : result.pairs)
    text += fmt::format("  {} <- {}: {}: {}\n", result.names[pair.target], result.names[pair.source],
                        pair.trusted ? "trusted" : "refused", pair.reason);
  for (size_t i = 0; i < result.names.size(); ++i) {
    const Vector3d position = result.map_from_scan[i].translation();
    const Vector3d rpy = rpy_from_rotation(result.map_from_scan[i].linear()) * 180 / kPi;
    text += fmt::format("  {}: x {:.3f} y {:.3f} z {:.3f} m, roll {:.2f} pitch {:.2f} yaw {:.2f} deg{}\n",
                        result.names[i], position.x(), position.y(), position.z(), rpy.x(), rpy.y(), rpy.z(),
                        result.connected[i] ? "" : " (by odometry only)");
  }
  return text;
}

/// The connected scans at their new poses: one that stands nobody knows where would spoil a map.
void write_connected(mapping::ScanSet scans, const mapping::RegistrationResult& result,
                     const std::string& folder) {
  std::vector<mapping::Scan> connected;
  for (size_t i = 0; i < scans.scans.size(); ++i) {
    if (!result.connected[i]) continue;
    connected.push_back(std::move(scans.scans[i]));
    connected.back().map_from_scan = result.map_from_scan[i];
    connected.back().covariance.setZero();  // It was that of the pose given.
  }
  scans.scans = std::move(connected);
  write_scan_set(scans, folder);
}

void run(RegisterArguments arguments, bool dof_given, Session& session) {
  arguments.options.threads = session.flags().threads;
  const mapping::ScanSet scans = read_scans(arguments);
  if (!dof_given && !scans.levelled) arguments.options.dof = 6;
  const mapping::RegistrationResult result = register_scans(scans, arguments.options, session.progress());
  session.timing("register", result.seconds);
  std::string text = answer_text(result);
  Json json = result.report();
  json["dof"] = arguments.options.dof;
  if (result.usable() && !arguments.out.empty()) {
    write_connected(scans, result, arguments.out);
    text += fmt::format("{} scans in {}\n", result.connected_count(), arguments.out);
    json["out"] = arguments.out;
  }
  session.answer(text, json);
  if (!result.usable())
    throw Error("no two of the scans could be brought together", {arguments.scans.front(), 0, {}},
                "they show different places, share too little surface, or start too far off "
                "(--position-error-m, --yaw-error-deg)");
}

}  // namespace

Command register_command() {
  return {"register",
          "Scans to poses",
          {"loci-map register demo-output/scans --dof 6 -o demo-output/registered",
           "loci-map register demo-output/scans --dof 6 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<RegisterArguments>();
            table.positional("SCANS...", &arguments->scans,
                             "Folder of a scan set, or several bare PCD files");
            table.option("-o,--output", &arguments->out, "Folder for the scans at their new poses");
            table.option("--guess", &arguments->guess,
                         "Of bare PCD files: x,y,z,yaw_deg of each as seen from the one before it");
            table.options(table_of(arguments->options));
            table.at("--dof").given = &arguments->dof_given;
            return [arguments](Session& session) { run(*arguments, arguments->dof_given, session); };
          }};
}

}  // namespace loci::apps

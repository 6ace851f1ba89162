#include <fmt/format.h>

#include "apps/perceive/commands.h"
#include "mapping/base/json.h"
#include "mapping/recording/recording.h"

namespace loci::apps {
namespace {

std::string camera_text(const mapping::PinholeCamera& camera) {
  return fmt::format("{} x {} pixels, f {} {}, centre {} {}", camera.width, camera.height, camera.fx,
                     camera.fy, camera.cx, camera.cy);
}

std::string info_text(const mapping::RecordingInfo& info) {
  const Vector3d offset = info.camera.depth_from_color.translation();
  std::string text = fmt::format("{}: {} frames, layout {}\n", info.path, info.frames, info.format) +
                     fmt::format("time    {} to {}{}\n", format_time(info.first_time),
                                 format_time(info.last_time), info.time_assumed ? " (made up)" : "") +
                     fmt::format("poses   {} of {}{}\n", info.frames_with_pose, info.frames,
                                 info.map_frame.empty() ? "" : ", in frame '" + info.map_frame + "'") +
                     fmt::format("depth   {}\n", camera_text(info.camera.depth)) +
                     fmt::format("colour  {}, at {:.3f} {:.3f} {:.3f} m from depth\n",
                                 camera_text(info.camera.color), offset.x(), offset.y(), offset.z());
  for (const std::string& guess : info.guesses) text += fmt::format("guessed {}\n", guess);
  for (const std::string& problem : info.problems) text += fmt::format("problem {}\n", problem);
  return text;
}

}  // namespace

Command info_command() {
  return {"info",
          "What a recording holds and what was guessed",
          {"loci-perceive info demo-output/day", "loci-perceive info demo-output/tour --json"},
          [](ArgumentTable& table) {
            auto path = std::make_shared<std::string>();
            table.positional("RECORDING", &*path, "Folder of the recording");
            return [path](Session& session) {
              const auto recording = mapping::open_recording(*path);
              session.answer(info_text(recording->info()), to_json(recording->info()));
            };
          }};
}

}  // namespace loci::apps

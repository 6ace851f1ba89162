#include "apps/evaluate/commands.h"
#include "apps/evaluate/tracking/trajectories.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

struct Arguments {
  std::vector<std::string> recordings;
  int first = 0, last = 1 << 30, every = 1;
  bool peers = true;
  bool open3d = false;

  void declare(OptionTable& table) {
    table.integer("first", first, "", "First frame that is taken.", 0, 1 << 30);
    table.integer("last", last, "", "Frame before which to stop.", 1, 1 << 30);
    table.integer("every", every, "frames", "Takes every n-th frame, as if the camera moved faster.", 1,
                  1000);
    table.flag("peers", peers, "Runs OpenCV's RGB-D odometry beside ours.");
    table.flag("open3d", open3d,
               "Runs Open3D's RGB-D odometry, too, where it is installed: a second per frame.");
  }
};

void run(Arguments& arguments, Session& session) {
  table_of(arguments).validate();
  const tracking_evaluation::FrameRange range = {static_cast<size_t>(arguments.first),
                                                 static_cast<size_t>(arguments.last),
                                                 static_cast<size_t>(arguments.every)};
  std::vector<tracking_evaluation::Row> rows;
  for (const std::string& recording : arguments.recordings) {
    auto more = compare_trackers(recording, range, {arguments.peers, arguments.open3d},
                                 session.flags().threads, session.progress());
    std::move(more.begin(), more.end(), std::back_inserter(rows));
  }
  session.answer(to_text(rows), to_json(rows));
}

}  // namespace

Command tracking_command() {
  return {
      "tracking",
      "Camera tracking against reference poses and other methods",
      {"loci-simulate record apps/samples/walk.yaml -o demo-output/walk",
       "loci-evaluate tracking demo-output/walk", "loci-evaluate tracking demo-output/walk --every 4 --json"},
      [](ArgumentTable& table) {
        auto arguments = std::make_shared<Arguments>();
        table.positional("RECORDING...", &arguments->recordings, "Recordings whose poses are the reference");
        table.options(table_of(*arguments));
        return [arguments](Session& session) { run(*arguments, session); };
      }};
}

}  // namespace loci::apps

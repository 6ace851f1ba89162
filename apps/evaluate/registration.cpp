#include "apps/evaluate/commands.h"
#include "apps/evaluate/registration/comparison.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

using namespace registration_evaluation;

struct Arguments {
  std::vector<std::string> worlds;
  std::vector<std::filesystem::path> package_paths;
  std::string recording, pairs, clouds;
  int scans = 8, compared = 20, verdicts = 180, different = 20, frames = 12, ahead = 4, seed = 1;
  double voxel_m = 0.05;
  bool peers = true;

  void declare(OptionTable& table) {
    table.integer("scans", scans, "", "Scans that are simulated in each world.", 2, 100);
    table.integer("compared", compared, "", "Simulated pairs in the comparison with the peers.", 0, 10000);
    table.integer("verdicts", verdicts, "", "Pairs of one place in the test of verdicts.", 0, 100000);
    table.integer("different", different, "", "Pairs of different places in it.", 0, 100000);
    table.integer("frames", frames, "", "Pairs of frames of the recording.", 0, 10000);
    table.integer("ahead", ahead, "", "The second frame of a pair is so many frames later.", 1, 10000);
    table.number("voxel_m", voxel_m, "m", "What the compared clouds are thinned to.", 0.01, 0.5);
    table.flag("peers", peers, "Runs PCL's methods beside ours.");
    table.integer("seed", seed, "", "Seed of places, noise and starts.", 0, 1 << 30);
  }
};

constexpr double kFarShift = 0.5, kFarTurn = 30;

/// Pairs of scans of different worlds; they start as if the robot had not moved.
registration_evaluation::PairSet different_places(const std::vector<std::vector<mapping::Scan>>& worlds,
                                                  size_t count, Random random) {
  registration_evaluation::PairSet set;
  set.name = "different places";
  while (worlds.size() > 1 && set.pairs.size() < count) {
    const size_t a = random.index(worlds.size()), b = random.index(worlds.size());
    if (a == b) continue;
    const mapping::Scan& target = worlds[a][random.index(worlds[a].size())];
    const mapping::Scan& source = worlds[b][random.index(worlds[b].size())];
    set.pairs.push_back(
        {target.name + " <- " + source.name, &target, &source, Isometry3d::Identity(), false, 0});
  }
  return set;
}

void append(registration_evaluation::Evaluation& evaluation,
            std::vector<registration_evaluation::MethodRow> rows) {
  std::move(rows.begin(), rows.end(), std::back_inserter(evaluation.methods));
}

void append(registration_evaluation::Evaluation& evaluation,
            std::vector<registration_evaluation::VerdictRow> rows) {
  std::move(rows.begin(), rows.end(), std::back_inserter(evaluation.verdicts));
}

/// Scans of the worlds: comparison with peers, verdicts, tours.
void evaluate_worlds(const Arguments& arguments,
                     const std::vector<registration_evaluation::Disturbance>& disturbances,
                     registration_evaluation::Evaluation& evaluation, Session& session) {
  const Random random(static_cast<uint64_t>(arguments.seed));
  const size_t count = arguments.worlds.size();
  mapping::RegistrationOptions options;
  options.threads = session.flags().threads;
  std::vector<std::vector<mapping::Scan>> scans;
  for (size_t w = 0; w < count; ++w) {
    session.progress().check(0, "scanning " + arguments.worlds[w]);
    scans.push_back(simulated_scans({arguments.worlds[w], arguments.package_paths},
                                    static_cast<size_t>(arguments.scans), random.fork(w), options.threads,
                                    session.warnings()));
  }
  for (size_t w = 0; w < count; ++w) {
    const std::string name = std::filesystem::path(arguments.worlds[w]).stem().string();
    const auto share = [&](int all) { return (static_cast<size_t>(all) + w) / count; };
    const Random draw = random.fork(1000 + w);
    registration_evaluation::PairSet set =
        registration_evaluation::pairs_among(name, scans[w], 0.5, share(arguments.compared), draw.fork(0));
    append(evaluation, compare_methods(set, disturbances, arguments.voxel_m, arguments.peers, draw.fork(1),
                                       session.progress()));
    set = registration_evaluation::pairs_among(name, scans[w], 0.3, SIZE_MAX, draw.fork(2));
    const size_t wanted = share(arguments.verdicts), there = set.pairs.size();
    // A pair is taken again from another start when there are fewer than wanted.
    for (size_t i = 0; there > 0 && set.pairs.size() < wanted; ++i) set.pairs.push_back(set.pairs[i % there]);
    if (set.pairs.size() > wanted) set.pairs.resize(wanted);
    append(evaluation, test_verdicts(set, kFarShift, kFarTurn, options, draw.fork(3), session.progress()));
    evaluation.tours.push_back(registration_evaluation::test_tour(name, scans[w], 0.2, 10, options,
                                                                  draw.fork(4), session.progress()));
  }
  append(evaluation,
         test_verdicts(different_places(scans, static_cast<size_t>(arguments.different), random.fork(2000)),
                       kFarShift, kFarTurn, options, random.fork(2001), session.progress()));
}

void run(Arguments& arguments, Session& session) {
  table_of(arguments).validate();
  const Random random(static_cast<uint64_t>(arguments.seed));
  const std::vector<registration_evaluation::Disturbance> disturbances = {
      {"10 cm, 5°", 0.1, 5}, {"50 cm, 30°", kFarShift, kFarTurn}};
  registration_evaluation::Evaluation evaluation;
  evaluate_worlds(arguments, disturbances, evaluation, session);
  std::vector<registration_evaluation::PairSet> recorded;
  if (!arguments.pairs.empty())
    recorded.push_back(registration_evaluation::listed_pairs(
        arguments.pairs, arguments.clouds.empty() ? std::filesystem::path(arguments.pairs).parent_path()
                                                  : std::filesystem::path(arguments.clouds)));
  if (!arguments.recording.empty())
    recorded.push_back(registration_evaluation::recording_pairs(
        arguments.recording, static_cast<size_t>(arguments.frames), static_cast<size_t>(arguments.ahead)));
  for (const registration_evaluation::PairSet& set : recorded)
    append(evaluation, compare_methods(set, disturbances, arguments.voxel_m, arguments.peers,
                                       random.fork(3000), session.progress()));
  session.answer(evaluation.text(session.flags().verbose), evaluation.to_json());
}

}  // namespace

Command registration_command() {
  return {"registration",
          "Registration against other methods, and correctness of its verdicts",
          {"loci-evaluate registration apps/samples/kitchen.urdf --scans 3 --compared 1 --verdicts 2",
           "loci-evaluate registration apps/samples/kitchen.urdf --scans 3 --compared 1 --verdicts 2 --json"},
          [](ArgumentTable& table) {
            auto arguments = std::make_shared<Arguments>();
            table.positional("[WORLD...]", &arguments->worlds, "Worlds (URDF) that are scanned");
            table.package_path(&arguments->package_paths);
            table.option("--recording RECORDING", &arguments->recording, "Depth frames with poses");
            table.option("--pairs CSV", &arguments->pairs,
                         "CSV of pairs of clouds: target, source, x_m, y_m, z_m, rx_deg, ry_deg, rz_deg");
            table.option("--clouds FOLDER", &arguments->clouds, "Folder of the clouds");
            table.options(table_of(*arguments));
            return [arguments](Session& session) { run(*arguments, session); };
          }};
}

}  // namespace loci::apps

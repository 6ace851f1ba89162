#include "apps/evaluate/update/perceived.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "apps/evaluate/changes/comparison.h"
#include "apps/evaluate/changes/remember.h"
#include "apps/evaluate/update/moves.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"
#include "mapping/simulation/record.h"
#include "mapping/world/urdf.h"
#include "memory/store/feature_structures.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/structure/known_structure.h"
#include "perception/types/geometry.h"

namespace loci::apps::update_claim {
namespace {

namespace fs = std::filesystem;

constexpr MoveLimits kLimits{0.1, 2, 90 * kDegree};
constexpr size_t kMinObjects = 3, kMaxObjects = 6;  ///< on a surface of furniture that may move
constexpr double kMinSide = 0.3;                    ///< metres: of a surface that objects stand on
constexpr const char* kModels[] = {"mug",
                                   "box, size: [0.16, 0.07, 0.22]",
                                   "bottle, accent: [0.2, 0.2, 0.3]",
                                   "bowl, accent: [0.9, 0.9, 0.9]",
                                   "can",
                                   "jar, accent: [0.9, 0.86, 0.7]",
                                   "pot",
                                   "apple"};
constexpr const char* kColors[] = {"[0.8, 0.14, 0.12]",  "[0.93, 0.66, 0.12]", "[0.16, 0.45, 0.24]",
                                   "[0.2, 0.45, 0.8]",   "[0.15, 0.15, 0.16]", "[0.45, 0.08, 0.22]",
                                   "[0.86, 0.86, 0.84]", "[0.55, 0.75, 0.2]",  "[0.7, 0.5, 0.35]"};

/// A surface with objects.
struct Table {
  std::string link;
  std::optional<size_t> group;  ///< of the furniture that it belongs to; unset = it does not move
  Vector3d middle = Vector3d::Zero();
};

/// A world with objects on its furniture, before and after some of it was moved.
class Room {
 public:
  Room(const MovableWorld& movable, const perception::KnownMap& map, Random& random) : movable_(movable) {
    perception::KnownStructureOptions options;
    size_t fixed = 0;
    for (const perception::SupportSurface& surface : map.support_surfaces(options.regions)) {
      Eigen::AlignedBox2d box;
      for (const Vector2d& corner : surface.outline) box.extend(corner);
      const Isometry3d map_from_top = map.scene.map_from_link(surface.link_id) * surface.link_from_top;
      if (box.sizes().minCoeff() < kMinSide || map_from_top.translation().z() > 1.1 ||
          surface.link.ends_with("_bottom"))
        continue;
      Table table{surface.link, {}, map_from_top.translation()};
      for (size_t g = 0; g < movable.groups().size(); ++g)
        if (std::ranges::find(movable.groups()[g].links, surface.link) != movable.groups()[g].links.end())
          table.group = g;
      if (!table.group && ++fixed > 2) continue;
      add_objects(table, box.sizes() / 2, random);
      tables_.push_back(table);
    }
  }

  /// Links by object.
  const std::map<std::string, Table>& table_of() const { return table_of_; }

  /// A walk that looks at all surfaces and at the places that furniture has left. Furniture is where `world`
  /// has it.
  std::string scenario(const fs::path& world, const char* date, const MovableWorld& now,
                       const std::vector<Move>& moves, Random& random) const {
    std::vector<Vector3d> targets;
    for (const Table& table : tables_) {
      const auto move = std::ranges::find_if(
          moves, [&](const Move& one) { return table.group && one.group == *table.group; });
      const Vector3d at = move == moves.end() ? table.middle : move->now_from_before * table.middle;
      targets.insert(targets.end(), 2, at);
    }
    for (size_t g = 0; g < movable_.groups().size(); ++g) {
      targets.push_back(movable_.groups()[g].centre);
      for (const Move& move : moves)
        if (move.group == g) targets.push_back(move.now_from_before * movable_.groups()[g].centre);
    }
    for (size_t i = targets.size(); i > 1; --i) std::swap(targets[i - 1], targets[random.index(i)]);
    std::string text = fmt::format("world: {}\ncamera: kinect\nfloor: 0\nobjects:\n", world.string());
    for (const auto& [name, model] : models_) text += fmt::format("  {}: {}\n", name, model);
    text += "scenes:\n";
    int minute = 0;
    for (const Vector3d& target : targets) {
      const std::optional<Vector3d> from = view_of(now, target, random);
      if (!from) continue;
      text +=
          fmt::format("  - time: \"{}T{:02}:{:02}:00Z\"\n    view: {{from: [{:.3f}], at: [{:.3f}]}}\n", date,
                      8 + minute / 60, minute % 60, fmt::join(*from, ", "), fmt::join(target, ", "));
      if (minute++ == 0 && !actions_.empty())
        text += fmt::format("    do:\n      - {}\n", fmt::join(actions_, "\n      - "));
    }
    return text;
  }

 private:
  void add_objects(const Table& table, const Vector2d& half, Random& random) {
    const size_t wanted = kMinObjects + random.index(kMaxObjects - kMinObjects + 1);
    std::vector<Vector2d> taken;
    for (int draw = 0; draw < 200 && taken.size() < wanted; ++draw) {
      const Vector2d at(random.uniform(-1, 1) * (half.x() - 0.12), random.uniform(-1, 1) * (half.y() - 0.12));
      if (std::ranges::any_of(taken, [&](const Vector2d& other) { return (other - at).norm() < 0.24; }))
        continue;
      taken.push_back(at);
      const std::string name = fmt::format("object_{}", models_.size() + 1);
      // No two alike: that equal objects are confused is measured elsewhere.
      models_[name] = fmt::format("{{model: {}, color: {}}}", kModels[models_.size() % std::size(kModels)],
                                  kColors[models_.size() % std::size(kColors)]);
      table_of_[name] = table;
      actions_.push_back(fmt::format("{{place: {}, on: {}, at: [{:.3f}, {:.3f}], yaw_deg: {}}}", name,
                                     table.link, at.x(), at.y(), static_cast<int>(random.index(360)) - 180));
    }
  }

  static std::optional<Vector3d> view_of(const MovableWorld& now, const Vector3d& target, Random& random) {
    for (int draw = 0; draw < 300; ++draw) {
      const double azimuth = random.uniform(0, 2 * kPi), distance = random.uniform(1.1, 2.0);
      const Vector3d from(target.x() + distance * std::cos(azimuth),
                          target.y() + distance * std::sin(azimuth), random.uniform(1.35, 1.65));
      if (now.sight().sees(from, target)) return from;
    }
    return std::nullopt;
  }

  const MovableWorld& movable_;
  std::vector<Table> tables_;
  std::map<std::string, std::string> models_;
  std::map<std::string, Table> table_of_;
  std::vector<std::string> actions_;
};

/// Records a scenario.
std::shared_ptr<mapping::Recording> recorded(const fs::path& folder, const std::string& scenario,
                                             const Settings& settings, Random& random, Progress& progress,
                                             Warnings& warnings) {
  const fs::path file = folder.string() + ".yaml";
  write_file_atomically(file, scenario);
  mapping::RecordOptions options;
  options.seed = static_cast<int>(random.index(1000000));
  options.threads = settings.threads;
  options.package_paths = settings.package_paths;
  record(mapping::read_scenario(file), folder, options, progress, warnings);
  return mapping::open_recording(folder);
}

/// Which object each true one of a recording was last taken for, and what else was said.
struct Said {
  std::map<std::string, memory::Id> object_of;
  std::set<std::string> visible;
  std::set<memory::Id> objects, true_objects;
  size_t on_moved = 0, on_their_place = 0, false_events = 0;
};

Said said_of(const fs::path& folder, const mapping::Recording& recording, const memory::Store& store,
             const std::map<std::string, Table>& table_of, const std::set<std::string>& moved_links) {
  const changes::Truth truth = changes::read_truth(folder, recording);
  memory::Id number = 0;
  for (const memory::RecordingRow& row : store.recordings())
    if (row.name == folder.filename()) number = row.id;
  const changes::Moments moments = changes::read_moments(store, number);
  const changes::Story story = changes::memory_story(store, moments);
  std::map<memory::Id, std::string> place_name;
  for (const memory::PlaceRow& place : store.places()) place_name[place.id] = place.name;
  Said said;
  for (const auto& [frame, moment] : moments) {
    const auto told = story.find(frame);
    if (told == story.end()) continue;
    std::vector<changes::TrueObject> true_objects;
    if (const auto visible = truth.visible.find(frame); visible != truth.visible.end())
      true_objects = visible->second;
    for (const changes::TrueObject& one : true_objects) said.visible.insert(one.name);
    if (const auto barely = truth.barely.find(frame); barely != truth.barely.end())
      true_objects.insert(true_objects.end(), barely->second.begin(), barely->second.end());
    const std::map<size_t, size_t> pairs = changes::find_true_objects(true_objects, moment);
    std::map<memory::Id, std::optional<memory::Id>> place_of;
    for (const memory::ObservationRow& row : store.observations(moment.scene)) place_of[row.id] = row.place;
    for (size_t k = 0; k < moment.sights.size(); ++k) {
      const auto object = told->second.object_of.find(moment.sights[k].observation);
      if (object == told->second.object_of.end()) continue;
      said.objects.insert(object->second);
      const auto pair = pairs.find(k);
      if (pair == pairs.end()) continue;
      const std::string& name = true_objects[pair->second].name;
      said.true_objects.insert(object->second);
      said.object_of[name] = object->second;
      const std::string& link = table_of.at(name).link;
      if (!moved_links.contains(link)) continue;
      ++said.on_moved;
      const auto place = place_of[moment.sights[k].observation];
      said.on_their_place += place && place_name[*place] == link ? 1 : 0;
    }
    for (const auto& [object, events] : told->second.events)
      said.false_events += events.contains("moved") || events.contains("gone") ? 1 : 0;
  }
  return said;
}

/// The furniture as the last frame with the memory's latest recording had it.
std::vector<perception::types::FurnitureAnnotation> said_of_furniture(const memory::Store& store,
                                                                      perception::cas::Cas& cas) {
  std::vector<perception::types::FurnitureAnnotation> pieces;
  const std::optional<memory::SceneRow> last = store.last_scene();
  const std::string type(perception::types::FurnitureAnnotation::kTypeName);
  for (const memory::FeatureStructureRow& row : store.feature_structures(last->id, type))
    pieces.push_back(perception::types::as<perception::types::FurnitureAnnotation>(
        memory::read_feature_structure(store, row.id, cas)));
  return pieces;
}

void judge_furniture(const memory::Store& store, const MovableWorld& movable, const std::vector<Move>& moves,
                     PerceivedTrial& trial) {
  perception::cas::Cas cas(perception::types::type_system());
  const auto pieces = said_of_furniture(store, cas);
  for (size_t g = 0; g < movable.groups().size(); ++g) {
    const Group& group = movable.groups()[g];
    const auto move = std::ranges::find(moves, g, &Move::group);
    const auto said = std::ranges::find_if(pieces, [&](const auto& piece) {
      const std::vector<std::string> links = piece.links.to_vector();
      return piece.moved.get() && std::ranges::find(links, group.branches.front()) != links.end();
    });
    if (move == moves.end()) {
      ++trial.unmoved;
      if (said != pieces.end()) trial.called_moved.push_back(group.name);
      continue;
    }
    PerceivedPiece piece;
    piece.piece = group.name;
    piece.distance = (move->now_from_before * group.centre - group.centre).norm();
    piece.turn_deg = std::abs(rpy_from_rotation(move->now_from_before.linear()).z()) / kDegree;
    piece.noticed = said != pieces.end();
    piece.found = piece.noticed && said->found.get();
    if (piece.found) {
      const Isometry3d motion = perception::types::from<Isometry3d>(said->motion.get());
      piece.position_error = (motion * group.centre - move->now_from_before * group.centre).norm();
      const Isometry3d error = move->now_from_before.inverse() * motion;
      piece.turn_error_deg = group.turn_error_deg(error);
    }
    trial.moved.push_back(piece);
  }
}

PerceivedTrial run_trial(int number, const fs::path& world, const MovableWorld& movable,
                         const mapping::MeshSearch& search, const perception::KnownMap& map,
                         const Settings& settings, Progress& progress, Warnings& warnings) {
  PerceivedTrial trial;
  trial.world = world.parent_path().filename().string() + "/" + world.stem().string();
  trial.trial = number;
  Random random = Random(static_cast<uint64_t>(settings.seed)).fork(static_cast<uint64_t>(number));
  const Room room(movable, map, random);
  const size_t count = number % 3 == 2 ? 0 : 1 + static_cast<size_t>(number / 3) % 2;
  const std::vector<Move> moves = movable.draw(count, random, kLimits);
  const fs::path folder = settings.folder / fmt::format("{}_perceived_{}", world.stem().string(), number);
  fs::remove_all(folder);
  make_folder(folder);
  const fs::path moved_urdf = folder / "moved.urdf";
  write_urdf(movable.moved(moves), moved_urdf);
  const MovableWorld now(mapping::read_urdf(moved_urdf), search, settings.families, warnings);
  const auto before =
      recorded(folder / "before", room.scenario(fs::absolute(world), "2026-05-01", movable, {}, random),
               settings, random, progress, warnings);
  const auto after = recorded(folder / "after", room.scenario(moved_urdf, "2026-05-02", now, moves, random),
                              settings, random, progress, warnings);
  std::set<std::string> moved_links;
  for (const Move& move : moves)
    moved_links.insert(movable.groups()[move.group].links.begin(), movable.groups()[move.group].links.end());
  for (const bool search_furniture : {true, false}) {
    changes::RememberOptions options;
    options.memory = folder / (search_furniture ? "with.loci" : "without.loci");
    options.map = world;
    options.program = "loci-evaluate update";
    options.threads = settings.threads;
    if (!search_furniture) {
      std::string text = perception::default_pipeline();
      const std::string filter = "KnownStructureFilter";
      text.insert(text.find(filter) + filter.size(), ": {find_furniture: false}");
      options.pipeline = folder / "without.yaml";
      write_file_atomically(options.pipeline, text);
    }
    for (const auto& recording : {before, after}) remember(recording, options, progress, warnings);
    const memory::Store store = memory::Store::open_read(options.memory);
    const Said first = said_of(folder / "before", *before, store, room.table_of(), {});
    const Said second = said_of(folder / "after", *after, store, room.table_of(), moved_links);
    RememberedObjects& objects = search_furniture ? trial.with : trial.without;
    for (const auto& [name, object] : first.object_of) {
      if (!second.visible.contains(name)) continue;
      ++objects.known;
      const auto found = second.object_of.find(name);
      objects.kept += found != second.object_of.end() && found->second == object ? 1 : 0;
    }
    for (const memory::Id object : second.objects)
      objects.phantoms += second.true_objects.contains(object) || first.true_objects.contains(object) ? 0 : 1;
    objects.on_moved = second.on_moved;
    objects.on_their_place = second.on_their_place;
    objects.false_events = second.false_events;
    if (search_furniture) judge_furniture(store, movable, moves, trial);
  }
  if (!settings.keep) fs::remove_all(folder);
  return trial;
}

/// Of trials in which furniture was moved, or of those in which nothing was.
struct PerceivedSums {
  size_t trials = 0, moved = 0, noticed = 0, found = 0, within = 0, unmoved = 0, called_moved = 0;
  std::vector<double> position, turn;
  RememberedObjects with, without;

  PerceivedSums(const std::vector<PerceivedTrial>& all, bool control) {
    for (const PerceivedTrial& trial : all) {
      if (trial.moved.empty() != control) continue;
      ++trials;
      unmoved += trial.unmoved;
      called_moved += trial.called_moved.size();
      with.add(trial.with);
      without.add(trial.without);
      for (const PerceivedPiece& piece : trial.moved) {
        ++moved;
        noticed += piece.noticed ? 1 : 0;
        if (!piece.found) continue;
        ++found;
        position.push_back(piece.position_error);
        if (piece.turn_error_deg) turn.push_back(*piece.turn_error_deg);
        within += piece.position_error <= 0.05 ? 1 : 0;
      }
    }
  }

  std::string text() const {
    const auto worst = [](const std::vector<double>& values, double scale) {
      return values.empty() ? std::string("-")
                            : fmt::format("{:.1f} median, {:.1f} worst", scale * quantile(values, 0.5),
                                          scale * quantile(values, 1.0));
    };
    std::string text;
    if (moved > 0)
      text += fmt::format(
          "moved pieces noticed      {} of {}\n  found                   {}\n  within 5 cm             {}\n"
          "position error, cm        {}\nturn error, deg           {}\n",
          noticed, moved, found, within, worst(position, 100), worst(turn, 1));
    text += fmt::format("unmoved called moved      {} of {}\n", called_moved, unmoved);
    text += "                          with, without the search\n";
    text += fmt::format("phantom objects           {}, {}\n", with.phantoms, without.phantoms);
    text += fmt::format("false moved or gone       {}, {}\n", with.false_events, without.false_events);
    text += fmt::format("objects kept              {} of {}, {} of {}\n", with.kept, with.known, without.kept,
                        without.known);
    if (with.on_moved + without.on_moved > 0)
      text += fmt::format("on their moved place      {} of {}, {} of {}\n", with.on_their_place,
                          with.on_moved, without.on_their_place, without.on_moved);
    return text;
  }

  Json json() const {
    const auto objects = [](const RememberedObjects& o) {
      return Json{{"known", o.known},       {"kept", o.kept},
                  {"on_moved", o.on_moved}, {"on_their_place", o.on_their_place},
                  {"phantoms", o.phantoms}, {"false_events", o.false_events}};
    };
    return {{"trials", trials},
            {"moved", moved},
            {"noticed", noticed},
            {"found", found},
            {"within", within},
            {"unmoved", unmoved},
            {"called_moved", called_moved},
            {"with", objects(with)},
            {"without", objects(without)}};
  }
};

}  // namespace

void RememberedObjects::add(const RememberedObjects& other) {
  known += other.known;
  kept += other.kept;
  on_moved += other.on_moved;
  on_their_place += other.on_their_place;
  phantoms += other.phantoms;
  false_events += other.false_events;
}

std::vector<PerceivedTrial> perceive_world(const fs::path& world, const Settings& settings,
                                           Progress& progress, Warnings& warnings) {
  const mapping::MeshSearch search{settings.package_paths, world.parent_path()};
  const MovableWorld movable(mapping::read_urdf(world), search, settings.families, warnings);
  if (movable.groups().empty())
    throw Error("the world has nothing to move", {world.string(), 0, ""},
                "name its furniture with --movable");
  const auto map = perception::KnownMap::load(world, settings.package_paths, warnings);
  std::vector<PerceivedTrial> trials;
  NoProgress quiet;
  for (int number = 0; number < settings.trials; ++number) {
    progress.check(double(number) / settings.trials, world.stem().string());
    trials.push_back(run_trial(number, world, movable, search, *map, settings, quiet, warnings));
  }
  return trials;
}

std::string perceived_text(const std::vector<PerceivedTrial>& trials, bool verbose) {
  std::string text;
  for (const PerceivedTrial& trial : trials) {
    if (!verbose) break;
    for (const PerceivedPiece& piece : trial.moved)
      text += fmt::format("{} {}: {} by {:.2f} m, {:.0f}°: {}\n", trial.world, trial.trial, piece.piece,
                          piece.distance, piece.turn_deg,
                          piece.found ? fmt::format("off by {:.1f} cm, {:.1f}°", 100 * piece.position_error,
                                                    piece.turn_error_deg.value_or(0))
                          : piece.noticed ? "not found"
                                          : "not noticed");
    if (!trial.called_moved.empty())
      text += fmt::format("{} {}: wrongly moved: {}\n", trial.world, trial.trial,
                          fmt::join(trial.called_moved, ", "));
    text += fmt::format("{} {}: phantoms {}, {}; false events {}, {}; kept {}, {} of {}\n", trial.world,
                        trial.trial, trial.with.phantoms, trial.without.phantoms, trial.with.false_events,
                        trial.without.false_events, trial.with.kept, trial.without.kept, trial.with.known);
  }
  const PerceivedSums moved(trials, false), control(trials, true);
  return text + fmt::format("furniture moved, {} runs\n{}\nnothing moved, {} runs\n{}", moved.trials,
                            moved.text(), control.trials, control.text());
}

Json perceived_json(const std::vector<PerceivedTrial>& trials) {
  return {{"moved", PerceivedSums(trials, false).json()},
          {"nothing_moved", PerceivedSums(trials, true).json()}};
}

}  // namespace loci::apps::update_claim

#include "apps/evaluate/changes/answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/text/json.h"
#include "memory/questions/contents.h"
#include "memory/questions/location.h"
#include "memory/questions/presence.h"

namespace loci::apps::changes {
namespace {

using memory::Id;

/// Where each object of the simulation stands from the frame's time on; missing = away.
struct TrueFrame {
  TimeNs time = 0;
  std::map<std::string, std::string> support;
  std::map<std::string, Vector3d> visible;  ///< middle of those that can be seen
};

std::vector<TrueFrame> read_frames(const std::filesystem::path& folder) {
  std::vector<TrueFrame> frames;
  std::istringstream lines(read_file(folder / "truth.jsonl"));
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    const Json json = parse_json(line, "truth.jsonl");
    TrueFrame& frame = frames.emplace_back();
    frame.time = json.at("time_ns").get<TimeNs>();
    for (const Json& entry : json.at("objects")) {
      const std::string name = entry.at("id").get<std::string>();
      frame.support[name] = entry.at("support").get<std::string>();
      if (entry.at("pixels").get<double>() <= 0) continue;
      const auto pose = entry.at("pose").get<std::vector<double>>();
      frame.visible[name] =
          Vector3d(pose.at(0), pose.at(1), pose.at(2) + entry.at("size").at(2).get<double>() / 2);
    }
  }
  return frames;
}

/// Whether a place of the memory is the support of the simulation: drawer_1_bottom is in drawer_1.
bool is_on(const std::string& support, const std::string& place) {
  return support == place || place.starts_with(support + "_") || support.starts_with(place + "_");
}

/// Which true object an object is: for each true object the object with most observations near it.
std::map<Id, std::string> true_names(const memory::Store& store, const std::vector<TrueFrame>& frames) {
  std::map<TimeNs, const TrueFrame*> by_time;
  for (const TrueFrame& frame : frames) by_time[frame.time] = &frame;
  std::map<std::string, std::pair<size_t, Id>> most;
  for (const memory::ObjectRow& object : store.objects()) {
    std::map<std::string, size_t> votes;
    for (const memory::ObjectObservation& seen : store.observations_of(object.id)) {
      const auto frame = by_time.find(seen.time);
      if (frame == by_time.end() || !seen.observation.position) continue;
      std::pair<double, std::string> nearest{0.12, ""};
      for (const auto& [name, at] : frame->second->visible)
        nearest = std::min(nearest, {(at - *seen.observation.position).norm(), name});
      if (!nearest.second.empty()) ++votes[nearest.second];
    }
    for (const auto& [name, count] : votes)
      if (count > most[name].first) most[name] = {count, object.id};
  }
  std::map<Id, std::string> names;
  for (const auto& [name, best] : most)
    if (best.second != 0) names.emplace(best.second, name);
  return names;
}

class Scorer {
 public:
  Scorer(const std::filesystem::path& folder, const memory::Store& store)
      : store_(store), frames_(read_frames(folder)), scenes_(store.scenes()), places_(store.places()) {}

  AnswerScore run() {
    for (const auto& [object, name] : true_names(store_, frames_)) {
      const TimeNs known_from = store_.observations_of(object).front().time;
      for (const memory::PlaceRow& place : places_)
        for (const size_t length : {1UL, 3UL, 6UL, 13UL})
          for (size_t first = 0; first + length <= scenes_.size(); first += (length + 1) / 2)
            ask_was(object, name, place, scenes_[first].time, scenes_[first + length - 1].time);
      for (const memory::SceneRow& scene : scenes_)
        if (scene.time >= known_from) ask_where(object, name, scene);
    }
    return std::move(score_);
  }

 private:
  const TrueFrame& frame_at(TimeNs time) const {
    const auto next = std::ranges::upper_bound(frames_, time, {}, &TrueFrame::time);
    return next == frames_.begin() ? frames_.front() : *std::prev(next);
  }
  bool truly_on(const std::string& name, const std::string& place, TimeNs time) const {
    const auto& supports = frame_at(time).support;
    const auto found = supports.find(name);
    return found != supports.end() && is_on(found->second, place);
  }

  void ask_was(Id object, const std::string& name, const memory::PlaceRow& place, TimeNs from, TimeNs to) {
    const bool there = std::ranges::any_of(scenes_, [&](const memory::SceneRow& scene) {
      return scene.time >= from && scene.time <= to && truly_on(name, place.name, scene.time);
    });
    const memory::WasObject answer = was(object, place, from, to, {});
    AnswerScore::Windows& count = score_.was;
    ++(there ? count.there : count.away);
    if (answer.verdict == memory::Verdict::yes)
      ++(there ? count.yes : count.false_yes);
    else if (answer.verdict == memory::Verdict::no)
      ++(there ? count.false_no : count.no);
    else
      ++count.not_observed;
    if (answer.verdict != memory::Verdict::not_observed)
      score_.was_stated.emplace_back(answer.probability, there);
  }

  memory::WasObject was(Id object, const memory::PlaceRow& place, TimeNs from, TimeNs to,
                        const memory::AsOf& as_of) const {
    return ask(store_, memory::WasQuestion{memory::object_name(object), place.name, from, to, as_of})
        .objects.at(0);
  }

  void ask_where(Id object, const std::string& name, const memory::SceneRow& scene) {
    const memory::AsOf now{scene.time, {}};
    const memory::ObjectBelief where =
        ask(store_, memory::WhereQuestion{memory::object_name(object), now}).objects.at(0);
    const bool gone = where.status == memory::ObjectStatus::gone;
    if (where.status != memory::ObjectStatus::seen && where.place) {
      if (!gone)
        score_.place_stated.emplace_back(where.probability, truly_on(name, where.place->name, scene.time));
      score_.existence_stated.emplace_back(where.in_home, frame_at(scene.time).support.contains(name));
    }
    for (const memory::PlaceRow& place : places_) {
      const bool there = !gone && where.place && where.place->id == place.id && where.probability >= 0.5;
      const memory::Verdict verdict = was(object, place, scene.time, scene.time, now).verdict;
      ++score_.asked;
      if (verdict == memory::Verdict::no ? there : verdict == memory::Verdict::yes && !there)
        ++score_.disagreements;
      const memory::ContentsAnswer on = ask(store_, memory::ContentsQuestion{place.name, now, {}});
      const bool listed = std::ranges::any_of(on.places.at(0).there, [&](const memory::ObjectBelief& one) {
        return one.object.id == object && one.probability >= 0.5;
      });
      if (listed != there) ++score_.unlisted;
    }
  }

  const memory::Store& store_;
  std::vector<TrueFrame> frames_;
  std::vector<memory::SceneRow> scenes_;
  std::vector<memory::PlaceRow> places_;
  AnswerScore score_;
};

/// Sums over statements.
struct Statements {
  double stated = 0, right = 0;
};

template <class Iterator>
Statements sum_of(Iterator begin, Iterator end) {
  Statements sum;
  for (; begin != end; ++begin) {
    sum.stated += begin->first;
    sum.right += begin->second ? 1 : 0;
  }
  return sum;
}

std::string calibration_text(const Stated& stated) {
  const Statements sum = sum_of(stated.begin(), stated.end());
  const double count = std::max<double>(1, static_cast<double>(stated.size()));
  return fmt::format("{:.2f} stated, {:.2f} right, expected calibration error {:.3f} (of {})",
                     sum.stated / count, sum.right / count, calibration_error(stated), stated.size());
}

}  // namespace

void AnswerScore::add(const AnswerScore& other) {
  for (const auto field : {&Windows::there, &Windows::away, &Windows::yes, &Windows::no, &Windows::false_yes,
                           &Windows::false_no, &Windows::not_observed})
    was.*field += other.was.*field;
  asked += other.asked;
  disagreements += other.disagreements;
  unlisted += other.unlisted;
  for (const auto field :
       {&AnswerScore::was_stated, &AnswerScore::place_stated, &AnswerScore::existence_stated})
    (this->*field).insert((this->*field).end(), (other.*field).begin(), (other.*field).end());
}

AnswerScore score_answers(const std::filesystem::path& folder, const memory::Store& store) {
  const memory::Store::ReadTransaction reading(store);
  return Scorer(folder, store).run();
}

std::string text(const AnswerScore& score) {
  const AnswerScore::Windows& was = score.was;
  return fmt::format(
      "was X on P: there in {} windows: {} yes, {} false no; not there in {}: {} no, {} false yes; "
      "{} not observed\n"
      "was and where disagree at {} of {} moments, on and where at {}\n"
      "verdicts of was:           {}\n"
      "place of unseen objects:   {}\n"
      "unseen objects at home:    {}\n",
      was.there, was.yes, was.false_no, was.away, was.no, was.false_yes, was.not_observed,
      score.disagreements, score.asked, score.unlisted, calibration_text(score.was_stated),
      calibration_text(score.place_stated), calibration_text(score.existence_stated));
}

Json to_json(const AnswerScore& score) {
  const AnswerScore::Windows& was = score.was;
  return {{"was",
           {{"there", was.there},
            {"away", was.away},
            {"yes", was.yes},
            {"no", was.no},
            {"false_yes", was.false_yes},
            {"false_no", was.false_no},
            {"not_observed", was.not_observed},
            {"calibration_error", calibration_error(score.was_stated)}}},
          {"moments", score.asked},
          {"disagreements", score.disagreements},
          {"unlisted", score.unlisted},
          {"place_calibration_error", calibration_error(score.place_stated)},
          {"existence_calibration_error", calibration_error(score.existence_stated)}};
}

}  // namespace loci::apps::changes

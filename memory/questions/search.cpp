#include "memory/questions/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/text/text.h"
#include "mapping/image/image_io.h"
#include "memory/questions/names/embeddings.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

constexpr double kSpeed_mps = 0.5;  // of a robot among people
constexpr double kViewSeconds = 3;
constexpr double kOpenSeconds = 8;  // a drawer or door
constexpr double kUnknownDistance_m = 2;
constexpr double kUnknownVisibility = 0.5;
/// Pseudo-count of sightings at every place but the current one: the object may be anywhere.
constexpr double kPriorSightings = 0.25;
/// Probability that a view of all of a place misses the object.
constexpr double kMissRate = 0.1;
constexpr size_t kMaxPlaces = 10;
constexpr size_t kMaxCrops = 12;  // the latest of an object

/// The views of a place: how much they show, and what they showed since a scene.
struct PlaceViews {
  double visibility = kUnknownVisibility;
  double missed_since = 1;  ///< probability that an object there would not have been seen since
  std::optional<SceneRef> last = {};
};

PlaceViews views_of(const Snapshot& snapshot, const PlaceRow& place, TimeNs since) {
  PlaceViews views;
  double sum = 0, count = 0;
  for (const VisibilityRow& row : snapshot.store().visibility_of_place(place.id)) {
    const SceneRow* scene = snapshot.scene(row.scene);
    const double fraction = row.fraction.value_or(0);
    if (scene == nullptr || fraction <= 0) continue;
    sum += fraction;
    ++count;
    if (scene->time > since)
      views.missed_since = std::min(views.missed_since, 1 - (1 - kMissRate) * fraction);
    if (!views.last || views.last->time <= scene->time) views.last = snapshot.scene_ref(*scene);
  }
  if (count > 0) views.visibility = sum / count;
  return views;
}

class SearchPlanner {
 public:
  SearchPlanner(const Snapshot& snapshot, const std::optional<Vector2d>& start)
      : snapshot_(snapshot), start_(start) {}

  ObjectSearch plan(Id object) const {
    const BeliefRow& belief = *snapshot_.belief(object);
    ObjectSearch search{.now = snapshot_.object_belief(belief)};
    const double there = belief.status == ObjectStatus::gone ? 0 : belief.probability;
    const TimeNs seen = search.now.last_seen ? search.now.last_seen->time : 0;
    std::map<Id, double> counts;
    for (const ObjectObservation& sighting : snapshot_.store().observations_of(object, snapshot_.as_of()))
      if (sighting.observation.place) ++counts[*sighting.observation.place];
    double elsewhere = 0, sightings = 0;
    for (const PlaceRow& place : snapshot_.places()) {
      const PlaceViews views = views_of(snapshot_, place, seen);
      SearchPlace one = search_place(place, views);
      const bool current = belief.place == place.id;
      const double count = counts.contains(place.id) ? counts[place.id] : 0;
      // The belief about the current place includes the views since; elsewhere they are accounted for here.
      one.probability = current ? there : (count + kPriorSightings) * views.missed_since;
      if (!current) {
        elsewhere += one.probability;
        sightings += count + kPriorSightings;
      }
      one.reason = current && there > 0 ? "it is believed to be there"
                   : count > 0
                       ? fmt::format("it was seen there in {}", counted(static_cast<size_t>(count), "scene"))
                       : "it was never seen there";
      search.places.push_back(std::move(one));
    }
    // If it is not at its current place, it may have left the home: the more so, the less is unseen of it.
    const double home = belief.elsewhere.value_or(1);
    const double rest = sightings > 0 ? home * elsewhere / sightings + 1 - home : 0;
    for (SearchPlace& one : search.places) {
      if (belief.place != one.place.id && rest > 0) one.probability *= (1 - there) * home / sightings / rest;
      one.chance_per_minute = one.probability * one.visibility / one.seconds * 60;
    }
    std::ranges::stable_sort(search.places, std::ranges::greater(), &SearchPlace::chance_per_minute);
    if (search.places.size() > kMaxPlaces) search.places.resize(kMaxPlaces);
    return search;
  }

 private:
  SearchPlace search_place(const PlaceRow& row, const PlaceViews& views) const {
    SearchPlace place{.place = {row.id, row.name, row.container}};
    place.visibility = views.visibility;
    place.last_view = views.last;
    const auto centre = centre_of(row);
    if (start_ && centre) place.distance_m = (centre->head<2>() - *start_).norm();
    place.seconds = place.distance_m.value_or(kUnknownDistance_m) / kSpeed_mps + kViewSeconds +
                    (row.container ? kOpenSeconds : 0);
    return place;
  }

  const Snapshot& snapshot_;
  std::optional<Vector2d> start_;
};

/// Hue by saturation where there is colour, and grey levels where there is none; sums to 1. Weighted towards
/// the centre: the corners of a crop show the background.
cv::Mat histogram_of(const cv::Mat& image) {
  constexpr int kHues = 12, kSaturations = 3, kGreys = 6;
  cv::Mat small, hsv;
  cv::resize(image, small, {32, 32}, 0, 0, cv::INTER_AREA);
  cv::cvtColor(small, hsv, cv::COLOR_BGR2HSV);
  cv::Mat histogram = cv::Mat::zeros(1, kHues * kSaturations + kGreys, CV_32F);
  for (int v = 0; v < hsv.rows; ++v)
    for (int u = 0; u < hsv.cols; ++u) {
      const auto& pixel = hsv.at<cv::Vec3b>(v, u);
      const float off = static_cast<float>(std::hypot(u - 15.5, v - 15.5)) / 16;
      const float weight = std::exp(-2 * off * off);
      if (pixel[1] < 50 || pixel[2] < 30) {
        histogram.at<float>(kHues * kSaturations + pixel[2] * kGreys / 256) += weight;
        continue;
      }
      // Interpolated between two hues, as red is at both ends of the scale.
      const float hue = static_cast<float>(pixel[0]) / 180 * kHues;
      const float part = hue - std::floor(hue);
      const int saturation = (pixel[1] - 50) * kSaturations / 206;
      const int lower = static_cast<int>(hue) % kHues;
      histogram.at<float>(lower * kSaturations + saturation) += weight * (1 - part);
      histogram.at<float>((lower + 1) % kHues * kSaturations + saturation) += weight * part;
    }
  return histogram / cv::sum(histogram)[0];
}

double intersection(const cv::Mat& a, const cv::Mat& b) {
  return static_cast<double>(static_cast<float>(cv::sum(cv::min(a, b))[0]));
}

struct Crop {
  cv::Mat histogram = {};
  Id scene = 0;
};

std::vector<Crop> crops_of(const Snapshot& snapshot, Id object) {
  std::vector<Crop> crops;
  const std::vector<ObjectObservation> sightings = snapshot.store().observations_of(object, snapshot.as_of());
  for (auto sighting = sightings.rbegin(); sighting != sightings.rend(); ++sighting) {
    if (!sighting->observation.crop) continue;
    const std::string bytes = snapshot.store().blob(*sighting->observation.crop).bytes;
    crops.push_back({histogram_of(mapping::decode_image({bytes.begin(), bytes.end()}, object_name(object))),
                     sighting->association.scene});
    if (crops.size() == kMaxCrops) break;
  }
  return crops;
}

}  // namespace

SearchAnswer ask(const Store& store, const SearchQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  std::optional<Vector2d> start = question.start;
  for (auto scene = snapshot.scenes().rbegin(); !start && scene != snapshot.scenes().rend(); ++scene)
    if (scene->map_from_camera) start = scene->map_from_camera->translation().head<2>();
  SearchAnswer answer{.asked = question.subject};
  const SearchPlanner planner(snapshot, start);
  for (const Id object : snapshot.find_objects(question.subject))
    answer.objects.push_back(planner.plan(object));
  return answer;
}

std::string to_text(const SearchAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const ObjectSearch& search : answer.objects) {
    lines.push_back(belief_text(search.now, times));
    size_t number = 0;
    for (const SearchPlace& place : search.places)
      lines.push_back(fmt::format(
          "  {}. {}: {} ({}); a view shows {} of it, {:.0f} s{}{}", ++number, place_text(place.place),
          percent(place.probability), place.reason, percent(place.visibility), place.seconds,
          place.distance_m ? fmt::format(" with a path of {:.1f} m", *place.distance_m) : "",
          place.last_view ? fmt::format(", last looked at {}", times.text(place.last_view->time))
                          : ", never looked at"));
  }
  return lines_text(lines);
}

namespace {

const Record<SearchPlace>& search_place_record() {
  static const auto record = Record<SearchPlace>("SearchPlace")
                                 .value("place", &SearchPlace::place)
                                 .value("probability", &SearchPlace::probability)
                                 .value("visibility", &SearchPlace::visibility)
                                 .value("seconds", &SearchPlace::seconds)
                                 .value("reason", &SearchPlace::reason)
                                 .value("chance_per_minute", &SearchPlace::chance_per_minute)
                                 .value("distance", &SearchPlace::distance_m)
                                 .record("last_view", &SearchPlace::last_view, scene_record());
  return record;
}

const Record<ObjectSearch>& object_search_record() {
  static const auto record = Record<ObjectSearch>("ObjectSearch")
                                 .with(&ObjectSearch::now, belief_record())
                                 .record("places", &ObjectSearch::places, search_place_record());
  return record;
}

const Record<SearchAnswer>& search_record() {
  static const auto record = Record<SearchAnswer>("SearchAnswer")
                                 .value("asked", &SearchAnswer::asked)
                                 .record("objects", &SearchAnswer::objects, object_search_record());
  return record;
}

}  // namespace

Json to_json(const SearchAnswer& answer) {
  return search_record().json(answer);
}

namespace {

/// Adds an object as similar as its most similar view: similarities(view) of `views`, whose scenes are known.
template <class View, class Measure>
void add_similar(const Snapshot& snapshot, const BeliefRow& belief, const std::vector<View>& views,
                 const Measure& measure, SimilarAnswer& answer) {
  if (views.empty()) return;
  SimilarObject object{.object = snapshot.object_belief(belief)};
  for (const View& view : views)
    if (const double similarity = measure(view); !object.scene || similarity > object.similarity) {
      object.similarity = similarity;
      object.scene = snapshot.scene_ref(view.scene);
    }
  answer.objects.push_back(std::move(object));
}

/// By the vectors of networks; nothing when there is none of the wanted.
void compare_embeddings(const Snapshot& snapshot, const std::vector<Embedding>& wanted,
                        std::optional<Id> self, SimilarAnswer& answer) {
  if (wanted.empty()) return;
  for (const BeliefRow& belief : snapshot.beliefs()) {
    if (belief.object == self) continue;
    std::vector<Embedding> views = embeddings_of(snapshot, belief.object);
    const auto best = [&](const Embedding& view) {
      double most = 0;
      for (const Embedding& one : wanted)
        if (one.name.empty() || one.name == view.name)
          most = std::max(most, embedding_similarity(one.values, view.values));
      return most;
    };
    add_similar(snapshot, belief, views, best, answer);
  }
}

void compare_crops(const Snapshot& snapshot, const std::vector<Crop>& wanted, std::optional<Id> self,
                   SimilarAnswer& answer) {
  for (const BeliefRow& belief : snapshot.beliefs()) {
    if (belief.object == self) continue;
    const auto best = [&](const Crop& crop) {
      double most = 0;
      for (const Crop& one : wanted) most = std::max(most, intersection(crop.histogram, one.histogram));
      return most;
    };
    add_similar(snapshot, belief, crops_of(snapshot, belief.object), best, answer);
  }
}

}  // namespace

SimilarAnswer ask(const Store& store, const SimilarQuestion& question) {
  if (question.subject.empty() && question.image.empty() && question.text.empty())
    throw Error("there is no object to compare with", {}, "give an object, an image or a text");
  const Snapshot snapshot(store, question.as_of);
  SimilarAnswer answer;
  if (!question.text.empty()) {
    if (question.vectors.empty())
      throw Error("there are no vectors of words", {},
                  "give the vectors that were exported from the encoder of texts");
    answer.asked = question.text;
    compare_embeddings(snapshot, {{.values = WordVectors::read(question.vectors).of(question.text)}},
                       std::nullopt, answer);
    if (answer.objects.empty())
      throw Error("no object has a vector of a network", {}, "run the annotator NetworkEmbedding");
  } else if (!question.image.empty()) {
    answer.asked = question.image.filename().string();
    compare_crops(snapshot, {{histogram_of(mapping::read_color(question.image)), 0}}, std::nullopt, answer);
  } else {
    const Id self = snapshot.find_objects(question.subject).at(0);
    answer.asked = object_name(self);
    compare_embeddings(snapshot, embeddings_of(snapshot, self), self, answer);
    if (answer.objects.empty()) {
      const std::vector<Crop> wanted = crops_of(snapshot, self);
      if (wanted.empty())
        throw Error(fmt::format("no crop of {} is stored", answer.asked), {}, "give an image");
      compare_crops(snapshot, wanted, self, answer);
    }
  }
  std::ranges::stable_sort(answer.objects, std::ranges::greater(), &SimilarObject::similarity);
  return answer;
}

std::string to_text(const SimilarAnswer& answer, const TimeWriter& times) {
  if (answer.objects.empty()) return "No crop of another object is stored.\n";
  std::vector<std::string> lines = {fmt::format("Most similar to {}:", answer.asked)};
  for (const SimilarObject& similar : answer.objects)
    lines.push_back(fmt::format("  {}: {}", percent(similar.similarity), belief_text(similar.object, times)));
  return lines_text(lines);
}

namespace {

const Record<SimilarObject>& similar_object_record() {
  static const auto record = Record<SimilarObject>("SimilarObject")
                                 .with(&SimilarObject::object, belief_record())
                                 .value("similarity", &SimilarObject::similarity)
                                 .record("image", &SimilarObject::scene, scene_record());
  return record;
}

const Record<SimilarAnswer>& similar_record() {
  static const auto record = Record<SimilarAnswer>("SimilarAnswer")
                                 .value("asked", &SimilarAnswer::asked)
                                 .record("objects", &SimilarAnswer::objects, similar_object_record());
  return record;
}

}  // namespace

Json to_json(const SimilarAnswer& answer) {
  return similar_record().json(answer);
}

std::vector<Question> search_questions() {
  Parameter object = object_parameter();
  object.required = false;
  return {
      {.name = "search-next",
       .description = "Where to search next for an object",
       .parameters = {object_parameter(),
                      {.name = "start",
                       .type = ParameterType::point,
                       .help = "Where the search starts: x,y in the map",
                       .default_text = "the last camera"}},
       .examples = {"red", "red --start 1.0,0.5 --json"},
       .answer = format::schema_by<search_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), SearchQuestion{given.text("object"), given.point("start"), given.as_of()});
       },
       .sentences = {{"where: next|first find <object>", Asks::place,
                      "Where should I look next for the cereal?"},
                     {"where: next|first look for<object>", Asks::place},
                     {"where: should find <object>", Asks::place, "Where should I look for the bowl?"},
                     {"where: else <object> [find|look|stand|keep]", Asks::place,
                      "If the cereal is not on the table, where else may it be?"}}},
      {.name = "like",
       .description = "Which objects look like an object, an image or a text",
       .parameters = {object,
                      {.name = "image",
                       .type = ParameterType::file,
                       .help = "A PNG or JPEG that the object fills",
                       .excludes = {"object"}},
                      {.name = "text",
                       .type = ParameterType::text,
                       .help =
                           "Words for what is looked for; needs --vectors and the annotator NetworkEmbedding",
                       .excludes = {"object", "image"}},
                      {.name = "vectors",
                       .type = ParameterType::file,
                       .help = "Vectors of words: a word and its values on each line"}},
       .examples = {"red", "red --json"},
       .answer = format::schema_by<similar_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), SimilarQuestion{given.text("object"), given.text("image"),
                                                   given.text("text"), given.text("vectors"), given.as_of()});
       },
       .sentences = {{"what: like<object> [look|thing|see]", Asks::objects, "What looks like the red cup?"},
                     {"yes: thing like<object> [look]", Asks::objects},
                     {"yes: <any> like<object> [look]", Asks::objects},
                     {"order: show|list|find|name like<object> [thing|everything|look]", Asks::objects},
                     {"order: show|list|find|name <any> like<object> [everything|look]", Asks::objects}}},
  };
}

}  // namespace loci::memory

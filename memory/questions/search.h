#pragma once

#include <filesystem>

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// Finding objects: search-next by place, like by appearance.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> search_questions();

// ---- search-next: probability × visibility of the place ÷ time that the search takes

struct SearchQuestion {
  std::string subject = {};
  std::optional<Vector2d> start = {};  ///< map frame; unset = the camera of the last scene
  AsOf as_of = {};
};
struct SearchPlace {
  PlaceRef place = {};
  double probability = 0;                 ///< that it is there
  double visibility = 0;                  ///< mean fraction of the place that its views showed
  std::optional<double> distance_m = {};  ///< horizontal
  double seconds = 0;                     ///< travel, view, and opening a container
  double chance_per_minute = 0;           ///< by which the places are ordered
  std::optional<SceneRef> last_view = {};
  std::string reason = {};
};
struct ObjectSearch {
  ObjectBelief now = {};
  std::vector<SearchPlace> places = {};  ///< best first
};
struct SearchAnswer {
  std::string asked = {};
  std::vector<ObjectSearch> objects = {};
};
SearchAnswer ask(const Store& store, const SearchQuestion& question);
std::string to_text(const SearchAnswer& answer, const TimeWriter& times);
void write_reply(const SearchAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const SearchAnswer& answer);

// ---- like: objects of similar appearance

struct SimilarQuestion {
  std::string subject = {};            ///< empty when an image or a text is given
  std::filesystem::path image = {};    ///< the object fills most of it
  std::string text = {};               ///< looked up in `vectors`
  std::filesystem::path vectors = {};  ///< of words, for the vectors of a network
  AsOf as_of = {};
};
struct SimilarObject {
  ObjectBelief object = {};
  double similarity = 0;  ///< 0 to 1: cosine of the vectors of a network where the memory has them, else
                          ///< intersection of the colour histograms of their crops
  std::optional<SceneRef> scene = {};  ///< of its most similar crop
};
struct SimilarAnswer {
  std::string asked = {};                   ///< the object's or the image's name
  std::vector<SimilarObject> objects = {};  ///< most similar first
};
/// Error when the image cannot be read, no crop of the object is stored, or, for a text, no vector of a
/// network.
SimilarAnswer ask(const Store& store, const SimilarQuestion& question);
std::string to_text(const SimilarAnswer& answer, const TimeWriter& times);
void write_reply(const SimilarAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const SimilarAnswer& answer);

}  // namespace loci::memory

#include "memory/belief/state.h"

#include <nlohmann/json.hpp>

#include "mapping/base/json.h"
#include "memory/belief/archive.h"
#include "memory/belief/earlier_state.h"

namespace loci::belief {
namespace {

/// Cannot begin a CBOR map, as which the first version wrote beliefs.
constexpr std::string_view kMagic = "belief 4\n";
constexpr std::string_view kMagic3 = "belief 3\n";  ///< without leftovers; returns not by age
constexpr std::string_view kMagic2 = "belief 2\n";  ///< nor what was learned about view points

struct EarlierObject {
  ProtoObject object;

  template <class Archive>
  void archive(Archive& fields) {
    object.archive_before_4(fields);
  }
};

BeliefState state_before_4(ArchiveReader& reader, int version) {
  BeliefState state;
  std::vector<EarlierObject> objects;
  reader(objects);
  for (EarlierObject& earlier : objects) state.objects.push_back(std::move(earlier.object));
  state.archive_rest_before_4(reader, version);
  return state;
}

}  // namespace

double ProtoObject::probability_itself() const {
  double rest = 1;
  for (const Alternative& alternative : alternatives) rest -= alternative.probability;
  return std::max(0.0, rest);
}

const ProtoObject* BeliefState::find(int64_t id) const {
  for (const ProtoObject& object : objects)
    if (object.id == id && id != 0) return &object;
  return nullptr;
}

double view_noise(const BeliefState& state) {
  return std::max(0.1, state.view_noise.value());
}

Handled handled(const ProtoObject& object) {
  return {object.kind, object.place, object.handling};
}

double handled_until(const ProtoObject& object, double attention_s, const BeliefState& state,
                     const BeliefOptions& options) {
  return state.habits.handled(handled(object), object.attention_s - object.seen_attention_s,
                              attention_s - object.seen_attention_s, options);
}

double probability_here(const ProtoObject& object, const BeliefState& state, const BeliefOptions& options) {
  return object.probability_here * (1 - handled_until(object, state.attention_s, state, options));
}

std::string to_bytes(const BeliefState& state) {
  ArchiveWriter writer;
  writer(state);
  return std::string(kMagic) + writer.take();
}

BeliefState belief_state_from_bytes(const std::string& bytes) {
  try {
    const int version = bytes.starts_with(kMagic)    ? 4
                        : bytes.starts_with(kMagic3) ? 3
                        : bytes.starts_with(kMagic2) ? 2
                                                     : 1;
    if (version == 1) return belief_state_of_version_1(bytes);
    BeliefState state;
    ArchiveReader reader(std::string_view(bytes).substr(kMagic.size()));
    if (version == 4)
      reader(state);
    else
      state = state_before_4(reader, version);
    if (!reader.at_end()) throw Error("there are bytes after the end");
    return state;
  } catch (const nlohmann::json::exception& e) {
    throw Error(std::string("the stored belief cannot be read: ") + e.what());
  } catch (const Error& e) {
    throw Error("the stored belief cannot be read: " + e.message());
  }
}

}  // namespace loci::belief

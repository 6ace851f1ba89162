#include "memory/belief/state.h"

#include <nlohmann/json.hpp>

#include "mapping/base/json.h"
#include "memory/belief/archive.h"
#include "memory/belief/earlier_state.h"

namespace loci::memory::belief {
namespace {

/// Cannot begin a CBOR map, as which the first version wrote beliefs. The digit is the version: 2 had nothing
/// about view points, 3 no leftovers and returns not by age, 4 no calibration.
constexpr std::string_view kMagic = "belief 5\n";
constexpr int kVersion = 5;

/// 1 where no version is told.
int version_of(const std::string& bytes) {
  const size_t digit = kMagic.size() - 2;
  if (bytes.size() < kMagic.size() || bytes.compare(0, digit, kMagic, 0, digit) != 0) return 1;
  return bytes[digit] - '0';
}

struct ObjectBefore4 {
  ProtoObject object;

  template <class Archive>
  void archive(Archive& fields) {
    object.archive_before_4(fields);
  }
};

BeliefState state_before_5(ArchiveReader& reader, int version) {
  BeliefState state;
  if (version < 4) {
    std::vector<ObjectBefore4> objects;
    reader(objects);
    for (ObjectBefore4& earlier : objects) state.objects.push_back(std::move(earlier.object));
  } else {
    reader(state.objects);
  }
  state.archive_rest_before_5(reader, version);
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
    const int version = version_of(bytes);
    if (version == 1) return belief_state_of_version_1(bytes);
    if (version < 1 || version > kVersion) throw Error("another version of loci wrote it");
    BeliefState state;
    ArchiveReader reader(std::string_view(bytes).substr(kMagic.size()));
    if (version == kVersion)
      reader(state);
    else
      state = state_before_5(reader, version);
    if (!reader.at_end()) throw Error("there are bytes after the end");
    return state;
  } catch (const nlohmann::json::exception& e) {
    throw Error(std::string("the stored belief cannot be read: ") + e.what());
  } catch (const Error& e) {
    throw Error("the stored belief cannot be read: " + e.message());
  }
}

}  // namespace loci::memory::belief

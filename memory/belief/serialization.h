#pragma once

#include <string>
#include <string_view>

#include "memory/belief/association/decisions.h"
#include "memory/belief/state.h"

namespace loci::memory::belief {

// Stored forms of the belief, as messages of belief_state.proto. Numbers come back bit by bit, and equal
// values have equal bytes. Readers check all sizes, indices and enumerators: Error for bytes that are no such
// message.

/// All of an object but the key points of its textures, which are stored once: they do not change.
std::string to_bytes(const ProtoObject& object);
ProtoObject object_from_bytes(std::string_view bytes);

std::string to_bytes(const Texture& texture);
Texture texture_from_bytes(std::string_view bytes);

/// All of the state but its objects.
std::string to_bytes(const BeliefState& state);
BeliefState state_from_bytes(std::string_view bytes);
/// What stands for a state that another version of loci wrote when its content is removed.
std::string emptied_state_of_another_version();

std::string to_bytes(const SceneReasoning& reasoning);
SceneReasoning reasoning_from_bytes(std::string_view bytes);

}  // namespace loci::memory::belief

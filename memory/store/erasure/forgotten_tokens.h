#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// Tokens as JSON, for a file outside the memory: {"version", "texts", "hashes", "numbers", "images":
/// [{"size", "region", "means"}]}. The file holds what was forgotten and is deleted after use.
Json to_json(const ForgottenTokens& tokens);
/// Error unless the JSON is of this form; `name` is for the message.
ForgottenTokens tokens_from_json(const Json& json, const std::string& name);

/// What of the tokens is left in a memory, one line each: texts and numbers in the bytes of the file, free
/// pages included, and in all that is stored compressed; hashes of stored bytes; regions of images that look
/// the same. Also a line when the file has a log beside it, whose bytes are not part of the proof.
std::vector<std::string> find_forgotten(const std::filesystem::path& memory, const ForgottenTokens& tokens,
                                        Progress& progress);

}  // namespace loci::memory

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/time.h"

namespace loci::memory {
class Store;
}  // namespace loci::memory

namespace loci::gui {

/// A question as a person types it.
struct TypedQuestion {
  std::string text = {};              ///< a sentence, or a command of loci-memory without the program's name
  std::optional<int64_t> about = {};  ///< the object that "it" means; unset = the one seen last
  std::optional<TimeNs> at = {};      ///< time of a question without one; unset = the end
};

/// What is shown of an answer.
struct TypedAnswer {
  std::string question = {};
  std::string command = {};  ///< its query, as it is typed after "loci-memory"; empty = not understood
  std::string text = {};     ///< for people, line by line
  std::vector<std::string> nearest = {};  ///< questions that are understood, when this one is not
};

/// The answer of loci-memory. What is not understood is an answer; Error when the file cannot be read.
TypedAnswer answer_question(const memory::Store& store, const TypedQuestion& question);

}  // namespace loci::gui

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/sentences/natural_language.h"
#include "memory/sentences/references.h"

namespace loci::memory {

/// Asks the memory what one reading of a sentence means.
class QueryAnswerer {
 public:
  /// All outlive this; `as_of` holds for queries without a time.
  QueryAnswerer(const Store& store, const AsOf& as_of, const Snapshot& snapshot, const TimeReader& times,
                const TimeWriter& writer, ReferenceResolver& references)
      : store_(store),
        as_of_(as_of),
        snapshot_(snapshot),
        times_(times),
        writer_(writer),
        references_(references) {}

  /// Whether the names of a reading mean something. The first reading is kept where none does.
  bool try_reading(Query query, NaturalLanguageAnswer& answer) const;

 private:
  /// What is in a part of the map that no scene has shown from inside; unset for other places.
  std::optional<Reply> not_looked_into(const Query& query) const;
  /// "Anything blue?" names nothing that is unknown where nothing is blue; unset for other questions.
  std::optional<Reply> none_coloured(const Query& query) const;
  /// "Is there a fridge?" asks for a piece of furniture where no object is called so.
  std::optional<Query> of_part(const Query& query) const;
  /// Of a time after the last look or before the first one nothing is known.
  std::optional<Reply> out_of_time(const Query& query) const;
  void set_answer(const Query& query, NaturalLanguageAnswer& answer) const;

  const Store& store_;
  const AsOf& as_of_;
  const Snapshot& snapshot_;
  const TimeReader& times_;
  const TimeWriter& writer_;
  ReferenceResolver& references_;
};

}  // namespace loci::memory

#pragma once

#include "memory/questions/facts.h"

namespace loci {

// What is known about a thing: what annotators say it is, what people say, where it is.

/// What annotators of one type say about an object.
struct ObjectEvidence {
  std::string type, value;
  size_t sightings = 0;  ///< that say so
  double agreement = 0;  ///< part of the sightings of which this type says anything
};
/// By type, most often first; where it is and how it lies is left out.
std::vector<ObjectEvidence> evidence_of(const Store& store, const std::vector<Sighting>& sightings);

struct AboutQuestion {
  std::string subject = {};
  AsOf as_of = {};
  size_t most_sightings = 500;  ///< the last ones are asked for evidence
};
struct AboutObject {
  ObjectState now = {};
  std::vector<Fact> facts = {};
  std::vector<ObjectEvidence> evidence = {};
  size_t sightings = 0;  ///< that the evidence is of
};
struct AboutAnswer {
  std::string asked = {};
  std::vector<AboutObject> objects = {};
};
AboutAnswer ask(const Store& store, const AboutQuestion& question);

}  // namespace loci

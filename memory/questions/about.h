#pragma once

#include "memory/questions/facts.h"
#include "memory/store/store.h"

namespace loci::memory {

// What is known about a thing: what annotators say it is, what people say, where it is.

struct AboutQuestion {
  std::string subject = {};
  AsOf as_of = {};
  size_t max_sightings = 500;  ///< the last ones are asked for evidence
};
struct AboutObject {
  ObjectState now = {};
  std::vector<Fact> facts = {};
  std::vector<AnnotationSupport> evidence = {};
  size_t sightings = 0;  ///< that the evidence is of
};
struct AboutAnswer {
  std::string asked = {};
  std::vector<AboutObject> objects = {};
};
AboutAnswer ask(const Store& store, const AboutQuestion& question);

}  // namespace loci::memory

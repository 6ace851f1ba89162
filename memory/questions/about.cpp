#include "memory/questions/about.h"

#include "memory/questions/snapshot.h"

namespace loci::memory {

AboutAnswer ask(const Store& store, const AboutQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  AboutAnswer answer{.asked = question.subject};
  for (const Id id : snapshot.find_objects(question.subject)) {
    AboutObject object{.now = snapshot.state(*snapshot.belief(id))};
    object.facts =
        ask(store, FactsQuestion{.about = object_name(id), .key = {}, .as_of = question.as_of}).facts;
    std::vector<ObjectObservation> sightings = store.observations_of(id, question.as_of);
    if (sightings.size() > question.max_sightings)
      sightings.erase(sightings.begin(),
                      sightings.end() - static_cast<std::ptrdiff_t>(question.max_sightings));
    object.evidence = annotation_support(store, sightings);
    object.sightings = sightings.size();
    answer.objects.push_back(std::move(object));
  }
  return answer;
}

}  // namespace loci::memory

#pragma once

#include <map>
#include <string>
#include <vector>

#include "memory/recorder/scene_reasoning.h"
#include "memory/store/store.h"

namespace loci::memory {

/// The class of an object and its source: "label" (a person, of one image), "fact" (a person, of the object),
/// "catalogue", "annotators", or "" for none.
struct ObjectClass {
  std::string name, by;
};
/// The class that facts state, else the one with most confidence of the annotators.
ObjectClass class_of(const Store& store, Id object);

/// What annotators report about an object in words: by kind ("text", "product", "barcode", "label") the
/// values, each with its share of the observations with any value of this kind.
using ObjectTerms = std::map<std::string, std::map<std::string, double>>;
/// Of the last hundred observations. A class stated by people replaces the labels of annotators; facts from
/// catalogues are left out.
ObjectTerms terms_of(const Store& store, Id object);
/// The log likelihood ratio of being the same object by their terms: the sum over the kinds that both have.
/// Texts are compared word by word; upper and lower case are equal.
double terms_log_ratio(const ObjectTerms& a, const ObjectTerms& b);

/// The descriptors of some views of an object.
using ObjectViews = std::vector<std::vector<belief::Descriptor>>;
/// Removes classes and texts, which are compared as terms.
void remove_terms(ObjectViews& views);

/// The views of objects from the evidence that is stored with each scene.
class ViewReader {
 public:
  explicit ViewReader(const Store& store) : store_(store) {}

  /// At most six, spread over its observations; complete views where there are any.
  ObjectViews views_of(Id object);

 private:
  const belief::Observation* evidence(const ObservationRow& row);

  const Store& store_;
  std::map<Id, std::optional<SceneReasoning>> scenes_;
};

}  // namespace loci::memory

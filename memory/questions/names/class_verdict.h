#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "memory/store/store.h"

namespace loci::memory {

inline constexpr const char* kClassType = "loci.annotation.ClassificationAnnotation";
inline constexpr const char* kProductType = "loci.annotation.ProductAnnotation";

/// What the experts (annotators with their models) together make of the class of an object.
struct ClassVerdict {
  /// What one expert says: the same may say several things of the views of an object.
  struct Vote {
    std::string expert;     ///< "HouseholdClassifier household"; "" where nobody is named
    std::string name;       ///< the class
    double share = 0;       ///< of the views that it looked at, weighted with its confidence
    double competence = 0;  ///< probability that it is right, by what people have confirmed and corrected
  };

  std::string name;         ///< empty where it would be wrong too often
  double probability = 0;   ///< against the other classes that were voted for, and none of them
  std::vector<Vote> votes;  ///< of the best class first; contradictions stay

  /// Whether it is called so, or hardly less often than by its name.
  bool calls_it(const std::string& class_name) const;
};

/// Names an object by all its views together. What an expert states of the classes is averaged over views,
/// and multiplies (a product of experts, Hinton 2002) over the sides that they show: views from one side
/// repeat what the first of them shows. A view of which an expert says nothing speaks for none of its
/// classes. An expert counts by how often the classes that people state confirm it (a Beta distribution that
/// begins at 4 of 5): the log odds of its competence, one coin for all classes (Dawid and Skene 1979).
class ClassExperts {
 public:
  ClassExperts(const Store& store, const std::vector<FactRow>& facts, const AsOf& as_of);

  /// What the latest observations of an object are annotated with.
  struct Judgement {
    std::optional<std::string> product = {};   ///< of most of them
    std::optional<ClassVerdict> verdict = {};  ///< unset when no expert says anything
  };
  const Judgement& judgement(Id object) const;

 private:
  /// What one expert says of the views that it looked at.
  struct Opinion {
    std::map<std::string, double> names;  ///< sum of its confidences by class
    std::set<Id> runs;
    double named = 0, looked = 0;  ///< views
    double sides = 1;              ///< that the named views show
  };
  using Votes = std::map<std::string, Opinion>;  ///< by expert
  Votes votes_of(const Store::LatestObservations& latest) const;
  std::optional<ClassVerdict> verdict_of(const Votes& votes) const;
  double competence(const std::string& expert) const;

  struct Record {
    double right = 0, wrong = 0;
  };

  const Store& store_;
  AsOf as_of_;
  std::map<std::string, Record> records_;
  mutable std::unordered_map<Id, Judgement> judgements_;  ///< that were asked for
};

}  // namespace loci::memory

#include "memory/exchange/owl_individuals.h"

#include <fmt/format.h>

#include "mapping/exchange/formats/owl_document.h"

namespace loci::memory {
namespace {

using tinyxml2::XMLElement;

class Writer {
 public:
  Writer(const Store& store, const std::string& name, const AsOf& as_of)
      : store_(store), as_of_(as_of), map_(mapping::owl_identifier(name)), document_(name) {}

  std::string text() {
    document_.individual(map_, "SemanticEnvironmentMap");
    for (const PlaceRow& place : store_.places()) {
      XMLElement& node = document_.individual(place.name, "SpaceRegion");
      document_.relate(node, "describedInMap", map_);
      document_.state_own(node, "class", "string", place.class_name);
    }
    for (const BeliefRow& belief : store_.beliefs(as_of_))
      for (const ObjectHistory& history :
           ask(store_, HistoryQuestion{.subject = object_name(belief.object), .as_of = as_of_}).objects)
        add_object(history);
    return document_.text();
  }

 private:
  void add_object(const ObjectHistory& history) {
    const ObjectRef& object = history.now.object;
    XMLElement& node = document_.individual(object.name, "HumanScaleObject");
    document_.relate(node, "describedInMap", map_);
    if (object.size) {
      document_.state(node, "depthOfObject", object.size->x());
      document_.state(node, "widthOfObject", object.size->y());
      document_.state(node, "heightOfObject", object.size->z());
    }
    if (object.color) document_.state(node, "mainColorOfObject", "string", *object.color);
    document_.state_own(node, "status", "string", to_text(history.now.status));
    document_.state_own(node, "probability", "double", mapping::OwlDocument::number(history.now.probability));
    for (const std::string& alias : object.aliases) document_.label(node, alias);
    for (size_t i = 0; i < history.stays.size(); ++i)
      add_stay(object.name, fmt::format("{}_stay_{}", object.name, i + 1), history.stays[i]);
  }

  void add_stay(const std::string& object, const std::string& name, const Stay& stay) {
    if (!stay.position || stay.scenes.empty()) return;
    const std::string from = document_.timepoint(stay.scenes.front().time),
                      to = document_.timepoint(stay.scenes.back().time);
    XMLElement& perception = document_.individual(name, "SemanticMapPerception");
    document_.relate(perception, "objectActedOn", object);
    document_.relate(perception, "eventOccursAt", "pose_" + name);
    document_.relate(perception, "startTime", from);
    document_.relate(perception, "endTime", to);
    if (stay.place) document_.relate(perception, "inRegion", stay.place->name);
    document_.state_own(perception, "probability", "double", mapping::OwlDocument::number(stay.probability));
    document_.state_own(perception, "sightings", "integer", std::to_string(stay.scenes.size()));
    Isometry3d pose = Isometry3d::Identity();
    pose.translation() = *stay.position;
    document_.add_matrix("pose_" + name, pose);
  }

  const Store& store_;
  AsOf as_of_;
  std::string map_;
  mapping::OwlDocument document_;
};

}  // namespace

std::string owl_individuals(const Store& store, const std::string& name, const AsOf& as_of) {
  const Store::ReadTransaction moment(store);
  return Writer(store, name, as_of).text();
}

}  // namespace loci::memory

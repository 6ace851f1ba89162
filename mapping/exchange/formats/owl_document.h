#pragma once

#include <tinyxml2.h>

#include <set>
#include <string>

#include "mapping/base/math/pose.h"

namespace loci::mapping {

/// An ontology of individuals in RDF/XML with the names of KnowRob. Classes and properties that are used are
/// declared, so that the file can be read without KnowRob. `name` becomes part of the namespace.
class OwlDocument {
 public:
  explicit OwlDocument(const std::string& name);

  tinyxml2::XMLElement& individual(const std::string& name, const std::string& class_name);
  /// A property whose value is another individual.
  void relate(tinyxml2::XMLElement& node, const std::string& property, const std::string& name);
  void state(tinyxml2::XMLElement& node, const std::string& property, const char* type,
             const std::string& value);
  void state(tinyxml2::XMLElement& node, const std::string& property, double value);
  /// A property that KnowRob does not have, in the document's own namespace.
  void state_own(tinyxml2::XMLElement& node, const std::string& property, const char* type,
                 const std::string& value);
  void label(tinyxml2::XMLElement& node, const std::string& text);
  /// A pose as KnowRob keeps them.
  void add_matrix(const std::string& name, const Isometry3d& pose);
  /// A moment, named once: "timepoint_SECONDS".
  std::string timepoint(int64_t time_ns);

  /// With the declarations; nothing can be added afterwards.
  std::string text();

  static std::string number(double value);

 private:
  tinyxml2::XMLElement& top(const char* element, const std::string& about);
  std::string own(const std::string& name) const;

  std::string base_;
  tinyxml2::XMLDocument document_;
  tinyxml2::XMLElement* rdf_ = nullptr;
  std::set<std::string> classes_, object_properties_, data_properties_, own_properties_, times_;
};

/// What is within reach of a name in OWL: letters, digits, underscore, hyphen.
std::string owl_identifier(std::string name);

}  // namespace loci::mapping

#include "mapping/exchange/formats/owl_document.h"

#include <fmt/format.h>

#include <algorithm>

namespace loci::mapping {
namespace {

using tinyxml2::XMLElement;

constexpr const char* kKnowRob = "http://knowrob.org/kb/knowrob.owl#";
constexpr const char* kXsd = "http://www.w3.org/2001/XMLSchema#";

void resource(XMLElement& parent, const char* property, const std::string& uri) {
  parent.InsertNewChildElement(property)->SetAttribute("rdf:resource", uri.c_str());
}

}  // namespace

std::string owl_identifier(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return !std::isalnum(c) && c != '_' && c != '-'; }, '_');
  return name;
}

OwlDocument::OwlDocument(const std::string& name)
    : base_("http://knowrob.org/kb/" + owl_identifier(name) + ".owl") {
  document_.InsertEndChild(document_.NewDeclaration());
  rdf_ = document_.NewElement("rdf:RDF");
  document_.InsertEndChild(rdf_);
  const auto space = [&](const char* attribute, const std::string& uri) {
    rdf_->SetAttribute(attribute, uri.c_str());
  };
  space("xmlns", base_ + "#");
  space("xml:base", base_);
  space("xmlns:rdf", "http://www.w3.org/1999/02/22-rdf-syntax-ns#");
  space("xmlns:rdfs", "http://www.w3.org/2000/01/rdf-schema#");
  space("xmlns:owl", "http://www.w3.org/2002/07/owl#");
  space("xmlns:xsd", kXsd);
  space("xmlns:knowrob", kKnowRob);
  XMLElement& ontology = top("owl:Ontology", base_);
  resource(ontology, "owl:imports", "package://knowrob_common/owl/knowrob.owl");
}

XMLElement& OwlDocument::top(const char* element, const std::string& about) {
  XMLElement& node = *rdf_->InsertNewChildElement(element);
  node.SetAttribute("rdf:about", about.c_str());
  return node;
}

XMLElement& OwlDocument::individual(const std::string& name, const std::string& class_name) {
  XMLElement& node = top("owl:NamedIndividual", own(name));
  resource(node, "rdf:type", kKnowRob + class_name);
  classes_.insert(class_name);
  return node;
}

std::string OwlDocument::own(const std::string& name) const {
  return base_ + "#" + owl_identifier(name);
}

void OwlDocument::relate(XMLElement& node, const std::string& property, const std::string& name) {
  object_properties_.insert(property);
  resource(node, ("knowrob:" + property).c_str(), own(name));
}

void OwlDocument::state(XMLElement& node, const std::string& property, const char* type,
                        const std::string& value) {
  data_properties_.insert(property);
  XMLElement* element = node.InsertNewChildElement(("knowrob:" + property).c_str());
  element->SetAttribute("rdf:datatype", (kXsd + std::string(type)).c_str());
  element->SetText(value.c_str());
}

void OwlDocument::state(XMLElement& node, const std::string& property, double value) {
  state(node, property, "double", number(value));
}

void OwlDocument::state_own(XMLElement& node, const std::string& property, const char* type,
                            const std::string& value) {
  own_properties_.insert(property);
  XMLElement* element = node.InsertNewChildElement(property.c_str());
  element->SetAttribute("rdf:datatype", (kXsd + std::string(type)).c_str());
  element->SetText(value.c_str());
}

void OwlDocument::label(XMLElement& node, const std::string& text) {
  node.InsertNewChildElement("rdfs:label")->SetText(text.c_str());
}

void OwlDocument::add_matrix(const std::string& name, const Isometry3d& pose) {
  XMLElement& matrix = individual(name, "RotationMatrix3D");
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      state(matrix, fmt::format("m{}{}", row, column), pose.matrix()(row, column));
}

std::string OwlDocument::timepoint(int64_t time_ns) {
  std::string name = "timepoint_" + std::to_string(time_ns / 1'000'000'000);
  if (times_.insert(name).second) individual(name, "TimePoint");
  return name;
}

std::string OwlDocument::text() {
  for (const std::string& name : classes_) top("owl:Class", kKnowRob + name);
  for (const std::string& name : object_properties_) top("owl:ObjectProperty", kKnowRob + name);
  for (const std::string& name : data_properties_) top("owl:DatatypeProperty", kKnowRob + name);
  for (const std::string& name : own_properties_) top("owl:DatatypeProperty", own(name));
  tinyxml2::XMLPrinter printer;
  document_.Print(&printer);
  return printer.CStr();
}

std::string OwlDocument::number(double value) {
  return fmt::format("{}", value == 0 ? 0.0 : value);
}

}  // namespace loci::mapping

// Reads UIMA's typeSystemDescription into the declarations of TypeSystemBuilder.

#include <tinyxml2.h>

#include <algorithm>

#include "mapping/base/files.h"
#include "perception/cas/type_system_builder.h"

namespace loci::perception::cas {

using tinyxml2::XMLElement;

namespace {

std::string trimmed(const char* text) {
  std::string result = text == nullptr ? "" : text;
  const char* spaces = " \t\r\n";
  result.erase(0, std::min(result.find_first_not_of(spaces), result.size()));
  result.erase(result.find_last_not_of(spaces) + 1);
  return result;
}

FileLocation place_of(const XMLElement& element, const std::string& file) {
  return {file, element.GetLineNum(), {}};
}

std::string child_text(const XMLElement& element, const char* name) {
  const XMLElement* child = element.FirstChildElement(name);
  return child == nullptr ? "" : trimmed(child->GetText());
}

std::string required_text(const XMLElement& element, const char* name, const std::string& file) {
  const std::string text = child_text(element, name);
  if (text.empty())
    throw Error(std::string("<") + element.Name() + "> without <" + name + ">", place_of(element, file),
                "add it");
  return text;
}

/// Refuses elements that the format does not have: a misspelt one would be lost without a word.
void check_children(const XMLElement& element, const std::vector<std::string>& known,
                    const std::string& file) {
  for (auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    if (std::find(known.begin(), known.end(), child->Name()) == known.end())
      throw Error(std::string("unexpected <") + child->Name() + "> in <" + element.Name() + ">",
                  place_of(*child, file), did_you_mean(child->Name(), known));
}

template <typename Visit>
void for_each_child(const XMLElement& parent, const char* list, const char* item, const std::string& file,
                    Visit visit) {
  for (auto* group = parent.FirstChildElement(list); group != nullptr;
       group = group->NextSiblingElement(list)) {
    check_children(*group, {item}, file);
    for (auto* child = group->FirstChildElement(item); child != nullptr;
         child = child->NextSiblingElement(item))
      visit(*child);
  }
}

}  // namespace

TypeSystemBuilder::TypeSystemBuilder(const std::vector<TypeSource>& sources,
                                     std::vector<std::filesystem::path> path_dirs)
    : path_dirs_(std::move(path_dirs)) {
  for (const TypeSource& source : sources) sources_.emplace(source.name, source.text);
  add_builtin_types();
}

void TypeSystemBuilder::add_source(const TypeSource& source) {
  if (!read_.insert("text:" + source.name).second) return;
  add_text(source.text, source.name, std::filesystem::path(source.name).parent_path());
}

void TypeSystemBuilder::add_file(const std::filesystem::path& path, const FileLocation& from) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    throw Error(from.file.empty() ? "no such type system: " + path.string()
                                  : "imports " + path.string() + ", which does not exist",
                from,
                from.file.empty() ? "check the path" : "check the location, or give its folder with --path");
  const auto canonical = std::filesystem::weakly_canonical(path, error);
  if (!read_.insert((error ? path : canonical).string()).second) return;
  add_text(read_file(path), path.string(), path.parent_path());
}

void TypeSystemBuilder::add_text(const std::string& text, const std::string& file,
                                 const std::filesystem::path& folder) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    throw Error("not well-formed XML", {file, document.ErrorLineNum(), {}},
                "check the tags around this line");
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "typeSystemDescription")
    throw Error("not a type system: the root element is not <typeSystemDescription>",
                {file, root == nullptr ? 0 : root->GetLineNum(), {}});
  check_children(*root, {"name", "description", "version", "vendor", "imports", "types"}, file);
  for_each_child(*root, "imports", "import", file,
                 [&](const XMLElement& each) { add_import(each, file, folder); });
  for_each_child(*root, "types", "typeDescription", file,
                 [&](const XMLElement& each) { declare(read_type(each, file)); });
}

void TypeSystemBuilder::add_import(const XMLElement& element, const std::string& file,
                                   const std::filesystem::path& folder) {
  const FileLocation place = place_of(element, file);
  if (const char* location = element.Attribute("location")) {
    if (const auto source = sources_.find((folder / location).lexically_normal().string());
        source != sources_.end())
      return add_source({source->first, source->second});
    return add_file(folder / location, place);
  }
  const char* name = element.Attribute("name");
  if (name == nullptr) throw Error("<import> without location or name", place, "add one of them");
  std::string relative = name;
  std::replace(relative.begin(), relative.end(), '.', '/');
  relative += ".xml";
  if (const auto source = sources_.find(relative); source != sources_.end())
    return add_source({source->first, source->second});
  for (const auto& directory : path_dirs_)
    if (std::filesystem::exists(directory / relative)) return add_file(directory / relative, place);
  throw Error("imports '" + std::string(name) + "', but " + relative + " is in none of the given folders",
              place, "give the folder with --path");
}

TypeSystemBuilder::TypeDeclaration TypeSystemBuilder::read_type(const XMLElement& element,
                                                                const std::string& file) const {
  check_children(element, {"name", "description", "supertypeName", "features", "allowedValues"}, file);
  TypeDeclaration type;
  type.place = place_of(element, file);
  type.name = required_text(element, "name", file);
  type.description = child_text(element, "description");
  type.supertype = child_text(element, "supertypeName");
  if (type.supertype.empty() && type.name != "uima.cas.TOP") type.supertype = "uima.cas.TOP";
  for_each_child(element, "features", "featureDescription", file, [&](const XMLElement& each) {
    FeatureDeclaration feature = read_feature(each, file);
    const auto same = std::find_if(type.features.begin(), type.features.end(),
                                   [&](const auto& other) { return other.name == feature.name; });
    if (same == type.features.end())
      type.features.push_back(std::move(feature));
    else
      merge_feature(type.name, *same, feature);
  });
  type.has_allowed_values = element.FirstChildElement("allowedValues") != nullptr;
  for_each_child(element, "allowedValues", "value", file, [&](const XMLElement& each) {
    check_children(each, {"string", "description"}, file);
    type.allowed_values.push_back(required_text(each, "string", file));
  });
  return type;
}

TypeSystemBuilder::FeatureDeclaration TypeSystemBuilder::read_feature(const XMLElement& element,
                                                                      const std::string& file) const {
  check_children(element,
                 {"name", "description", "rangeTypeName", "elementType", "multipleReferencesAllowed"}, file);
  FeatureDeclaration feature;
  feature.place = place_of(element, file);
  feature.name = required_text(element, "name", file);
  feature.description = child_text(element, "description");
  feature.range = required_text(element, "rangeTypeName", file);
  feature.element = child_text(element, "elementType");
  const std::string multiple = child_text(element, "multipleReferencesAllowed");
  if (multiple == "true" || multiple == "false")
    feature.multiple_references = multiple == "true";
  else if (!multiple.empty())
    throw Error("multipleReferencesAllowed is '" + multiple + "'", feature.place, "use true or false");
  return feature;
}

}  // namespace loci::perception::cas
